"""Titles of coordinates for people, with units, factors from SI and the positive sense."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mbkf.model.clinical_table import ClinicalJoint

SIDE_NAMES = {"r": "right", "l": "left"}

TRUNK_POSITIVE = {
    "extension": "extends the trunk",
    "bending": "bends it to the right",
    "rotation": "turns it to the left",
}
"""Meaning of a positive moment of the trunk by its axis."""


@dataclass(frozen=True)
class Wording:
    """Texts and units of a clinical coordinate.

    Attributes:
        title: E.g. "Knee flexion".
        side: "r", "l", or "" on the midline.
        joint: Name of its joint without the side, e.g. "knee".
        positive: Meaning of a positive value.
        turns: True for angles, False for the root's translations.
        root: True for the root, whose load is a residual and no torque.
    """

    title: str
    side: str
    joint: str
    positive: str
    turns: bool
    root: bool

    @property
    def full_title(self) -> str:
        """The title with its side."""
        return f"{self.title}, {SIDE_NAMES[self.side]}" if self.side else self.title

    @property
    def unit(self) -> str:
        """Unit shown."""
        return "°" if self.turns else "m"

    @property
    def factor(self) -> float:
        """Factor from rad or m to that unit."""
        return float(np.rad2deg(1.0)) if self.turns else 1.0

    @property
    def load_unit(self) -> str:
        """Unit of the conjugate moment or force."""
        return "N m" if self.turns else "N"


@dataclass(frozen=True)
class PartWording:
    """Title (e.g. "Hand") and side ("r", "l", or "" on the midline) of a part of the body that bears load."""

    title: str
    side: str

    @property
    def full_title(self) -> str:
        """The title with its side before it, e.g. "Right hand"."""
        return f"{SIDE_NAMES[self.side]} {self.title}".capitalize() if self.side else self.title


def part_wording(name: str) -> PartWording:
    """The wording of a part by its name, e.g. "right_hand" or "pelvis"."""
    for side, word in SIDE_NAMES.items():
        if name.startswith(f"{word}_"):
            return PartWording(_plain(name.removeprefix(f"{word}_")), side)
    return PartWording(_plain(name), "")


def _plain(name: str) -> str:
    return name.replace("_", " ").capitalize()


def wordings(joints: Iterable[ClinicalJoint]) -> dict[str, Wording]:
    """The wording of every clinical coordinate of a body's joints, by its name."""
    found = {}
    for joint in joints:
        translations = {angle.name for angle in joint.translations}
        base, side = _sided(joint.name)
        for angle in joint.coordinates:
            plain = angle.name.removesuffix(f"_{side}") if side else angle.name
            title = angle.title or plain.replace("_", " ").capitalize()
            turns = angle.name not in translations
            found[angle.name] = Wording(title, side, base, angle.positive, turns, joint.proximal == "world")
    return found


def _sided(name: str) -> tuple[str, str]:
    base, _, last = name.rpartition("_")
    return (base, last) if base and last in SIDE_NAMES else (name, "")
