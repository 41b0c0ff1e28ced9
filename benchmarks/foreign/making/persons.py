"""Eight persons made from one model of OpenSim: sizes, masses, postures, and marker sets."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.foreign.making.osim_body import OsimBody, Size
from mbkf.conventions import SIDES

MODEL = Path("rajagopal_walk_run") / "reference_walk" / "subject_walk_scaled.osim"
"""Below the folder of reference captures: the scaled full-body model of Rajagopal et al. (2016), 85.3 kg."""

PLACES = Path(__file__).with_name("places.toml")

RAJAGOPAL, OPENCAP = "rajagopal_walk", "opencap_lab"
"""The two marker sets."""

HIDDEN = {
    RAJAGOPAL: tuple(f"{s}.M{name}" for s in "RL" for name in ("Elbow", "Knee", "Ankle")),
    OPENCAP: ("r_mknee", "r_mankle", "L_mknee", "L_mankle"),
}
"""Medial markers, which only the standing trial has."""

BESIDE = ("Head", "R_HJC", "L_HJC", "MidPSIS", "MidASIS", "MidClavicle")
"""Markers of the model's file that are computed, or not in the set."""

PARTS = {
    "thighs": ("femur",), "shanks": ("tibia",), "feet": ("talus", "calcn", "toes"),
    "upper_arms": ("humerus",), "forearms": ("ulna", "radius", "hand"),
}  # fmt: skip

Factors = tuple[float, float, float]


@dataclass(frozen=True)
class Person:
    """A person to make.

    Attributes:
        name: Name of the person.
        marker_set: :data:`RAJAGOPAL` or :data:`OPENCAP`.
        mass_kg: Mass after scaling, before ``masses``.
        size: Factors on depth, length and width of "pelvis", "torso" and of the parts of :data:`PARTS`.
        masses: Factors on masses of bodies.
        moved_as: "adult" or "child", whose measured movements the person makes.
        tilt_deg: Forward tilt of the pelvis besides; thighs and trunk keep their attitude.
        stiff: Coordinates that are held at the standing value, by the share of their movement that stays.
        skin: Factor on the amplitude of skin movement.
    """

    name: str
    marker_set: str
    mass_kg: float
    size: Mapping[str, Factors] = field(default_factory=dict)
    masses: Mapping[str, float] = field(default_factory=dict)
    moved_as: str = "adult"
    tilt_deg: float = 0.0
    stiff: Mapping[str, float] = field(default_factory=dict)
    skin: float = 1.0

    def build(self, data: Path) -> OsimBody:
        """The person's body, with the markers of the person's set where the protocol puts them.

        Args:
            data: Folder of the reference captures.
        """
        places = _places() if self.marker_set == OPENCAP else None
        return OsimBody(data / MODEL, Size(self._factors(), self.mass_kg, self.masses), places)

    def _factors(self) -> dict[str, Sequence[float]]:
        found: dict[str, Sequence[float]] = {
            part: self.size[part] for part in ("pelvis", "torso") if part in self.size
        }
        for part, bodies in PARTS.items():
            if part in self.size:
                found |= {f"{body}_{side}": self.size[part] for body in bodies for side in SIDES}
        if "thighs" in self.size:
            found |= {f"patella_{side}": self.size["thighs"] for side in SIDES}
        return found

    def markers(self, body: OsimBody) -> tuple[str, ...]:
        """All markers of the person's set.

        Args:
            body: The person's body.
        """
        held = body.model.getMarkerSet()
        names = [str(held.get(k).getName()) for k in range(held.getSize())]
        return tuple(name for name in names if name not in BESIDE and not name.endswith(("Joint", "Ground")))


def _places() -> dict[str, tuple[str, Sequence[float]]]:
    table = tomllib.loads(PLACES.read_text(encoding="utf-8"))
    return {name: (str(one["body"]), tuple(one["place"])) for name, one in table.items()}


def same(depth: float, length: float | None = None, width: float | None = None) -> Factors:
    """Factors on depth, length and width.

    Args:
        depth: Factor on the depth.
        length: Factor on the length; the depth's when None.
        width: Factor on the width; the depth's when None.
    """
    return depth, depth if length is None else length, depth if width is None else width


CHILD: Mapping[str, Factors] = {
    "pelvis": same(0.68, 0.72, 0.78),
    "torso": same(0.74, 0.72, 0.76),
    "thighs": same(0.64, 0.68),
    "shanks": same(0.64, 0.60),
    "feet": same(0.66),
    "upper_arms": same(0.66, 0.67),
    "forearms": same(0.66),
}
OBESE_TRUNK = {"pelvis": 1.35, "torso": 1.45} | {f"femur_{side}": 1.35 for side in SIDES}

PERSONS = (
    Person("adult", OPENCAP, 74.0, {"pelvis": same(0.97), "torso": same(0.96), "shanks": same(0.96, 0.93)}),
    Person("child", RAJAGOPAL, 23.5, CHILD, moved_as="child"),
    Person(
        "obese",
        RAJAGOPAL,
        82.0,
        {"pelvis": same(1.06, 1.0, 1.06), "torso": same(1.15, 1.0, 1.08), "thighs": same(1.15, 0.98, 1.15)},
        OBESE_TRUNK,
        skin=1.5,
    ),
    Person(
        "amputee",
        OPENCAP,
        80.0,
        {"thighs": same(1.0, 1.03), "shanks": same(0.98, 0.94)},
        {"tibia_l": 0.5, "talus_l": 0.6, "calcn_l": 0.6, "toes_l": 0.6},
        stiff={"ankle_angle_l": 0.3},
    ),
    Person("long_legs", RAJAGOPAL, 78.0, {"thighs": same(1.0, 1.12), "shanks": same(1.0, 1.06)}),
    Person(
        "short_legs",
        OPENCAP,
        70.0,
        {"thighs": same(0.97, 0.88), "shanks": same(0.95, 0.82), "feet": same(0.92)},
    ),
    Person(
        "tilted_pelvis", RAJAGOPAL, 68.0, {"thighs": same(0.96, 1.02), "torso": same(0.95)}, tilt_deg=14.0
    ),
    Person(
        "broad_shoulders",
        OPENCAP,
        92.0,
        {"torso": same(1.06, 1.02, 1.18), "upper_arms": same(1.05), "forearms": same(1.03)},
    ),
)

CHOSEN_ON = ("adult", "obese", "short_legs", "tilted_pelvis")
"""Persons on whom settings of scaling and filters may be chosen."""

SHOWN_ON = ("child", "amputee", "long_legs", "broad_shoulders")
"""Persons on whom nothing is chosen, who show what is reached."""

STANDING_DEG: Mapping[str, float] = {
    "pelvis_tilt": -2.0, "hip_flexion_r": 4.0, "hip_flexion_l": 3.0, "hip_adduction_r": -4.0, "hip_adduction_l": -4.0,
    "hip_rotation_r": -5.0, "hip_rotation_l": -4.0, "knee_angle_r": 5.0, "knee_angle_l": 4.0, "ankle_angle_r": 3.0,
    "ankle_angle_l": 3.0, "lumbar_extension": -3.0, "arm_add_r": -25.0, "arm_add_l": -25.0,
    "elbow_flex_r": 12.0, "elbow_flex_l": 12.0, "pro_sup_r": 60.0, "pro_sup_l": 60.0,
}  # fmt: skip
"""Posture of a person in the static trial."""


def person_named(name: str) -> Person:
    """A person of :data:`PERSONS`."""
    return next(one for one in PERSONS if one.name == name)


def tilted(person: Person, coordinates: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Coordinates with the person's tilt of the pelvis; thighs and trunk keep their attitude.

    Args:
        person: The person.
        coordinates: Values by coordinate, rad.
    """
    turn = np.deg2rad(person.tilt_deg)
    found = dict(coordinates)
    found["pelvis_tilt"] = found["pelvis_tilt"] - turn
    for name in ("hip_flexion_r", "hip_flexion_l", "lumbar_extension"):
        found[name] = found[name] + turn
    return found
