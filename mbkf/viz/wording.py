"""Titles of coordinates for people, with units, factors from SI and the positive sense."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.model.clinical_table import load_clinical_joints

SIDE_NAMES = {"r": "right", "l": "left"}

_TITLES = {
    "pelvis_tilt": "Pelvic tilt", "pelvis_list": "Pelvic obliquity", "pelvis_rotation": "Pelvic rotation",
    "pelvis_tx": "Pelvis forward", "pelvis_ty": "Pelvis height", "pelvis_tz": "Pelvis sideways",
    "lumbar_extension": "Trunk extension", "lumbar_bending": "Trunk bending",
    "lumbar_rotation": "Trunk rotation", "arm_flex": "Shoulder flexion", "arm_add": "Shoulder adduction",
    "arm_rot": "Shoulder rotation", "elbow_flex": "Elbow flexion", "pro_sup": "Forearm pronation",
    "wrist_flex": "Wrist flexion", "wrist_dev": "Wrist deviation", "knee_angle": "Knee flexion",
    "ankle_angle": "Ankle dorsiflexion", "subtalar_angle": "Ankle inversion", "mtp_angle": "Toe extension",
}  # fmt: skip
"""Titles of coordinates whose names do not read well by themselves, without their side."""


@dataclass(frozen=True)
class Wording:
    """How one clinical coordinate is shown.

    Attributes:
        title: E.g. "Knee flexion".
        side: "r", "l", or "" on the midline.
        joint: Name of its joint without the side, e.g. "knee".
        positive: What a positive value means.
        turns: True for angles, False for the pelvis's translations.
    """

    title: str
    side: str
    joint: str
    positive: str
    turns: bool

    @property
    def full_title(self) -> str:
        """The title with its side."""
        return f"{self.title}, {SIDE_NAMES[self.side]}" if self.side else self.title

    @property
    def unit(self) -> str:
        """Unit of the coordinate as shown."""
        return "°" if self.turns else "m"

    @property
    def factor(self) -> float:
        """From rad or m to that unit."""
        return float(np.rad2deg(1.0)) if self.turns else 1.0

    @property
    def load_unit(self) -> str:
        """Unit of the conjugate moment or force."""
        return "N m" if self.turns else "N"


def wordings() -> dict[str, Wording]:
    """The wording of every clinical coordinate, by its name."""
    found = {}
    for joint in load_clinical_joints():
        translations = {angle.name for angle in joint.translations}
        base, side = _sided(joint.name)
        for angle in joint.coordinates:
            plain = angle.name.removesuffix(f"_{side}") if side else angle.name
            title = _TITLES.get(plain, plain.replace("_", " ").capitalize())
            turns = angle.name not in translations
            found[angle.name] = Wording(title, side, base, angle.positive, turns)
    return found


def _sided(name: str) -> tuple[str, str]:
    base, _, last = name.rpartition("_")
    return (base, last) if base and last in SIDE_NAMES else (name, "")
