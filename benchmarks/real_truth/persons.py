"""Persons whose captures carry an outside reference: their files, and the origin of the reference."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from mbkf.io.capture import read_capture
from mbkf.io.records import Capture

OPENSIM, IN_C3D, RBDL = "OpenSim", "Plug-in Gait", "RBDL"

STANDING = "standing"


@dataclass(frozen=True)
class Reference:
    """Curves that another program computed from the same trial.

    Attributes:
        kind: :data:`OPENSIM`, :data:`IN_C3D` (points in the trial's own file) or :data:`RBDL`.
        angles, moments: Files in the person's folder; "" without.
        knee: Sign of its knee angle: −1 where extension counts positive.
        suffix: After the points' names in the C3D.
    """

    kind: str
    angles: str = ""
    moments: str = ""
    knee: float = 1.0
    suffix: str = ""


@dataclass(frozen=True)
class RealTrial:
    """A trial with a reference.

    Attributes:
        name: The movement.
        file: In the person's folder.
        reference: The reference.
        forces: Ground reactions in a file beside it; "" where they are in the trial or were not recorded.
        loads: Whether plates are followed; otherwise markers alone.
    """

    name: str
    file: str
    reference: Reference
    forces: str = ""
    loads: bool = True


@dataclass(frozen=True)
class RealPerson:
    """A person.

    Attributes:
        name: For the rows.
        folder: Below the data folder.
        static: Standing trial in the folder; "" without.
        mass_kg: Body mass.
        trials: Trials with a reference.
    """

    name: str
    folder: str
    static: str
    mass_kg: float
    trials: tuple[RealTrial, ...]

    @property
    def kind(self) -> str:
        """Program of the references."""
        return self.trials[0].reference.kind

    @property
    def reading(self) -> str:
        """Axes in which our angles are comparable with the reference's."""
        return "pig" if self.kind == IN_C3D else "model"

    def standing(self, data: Path) -> Capture | None:
        """The standing trial, if there is one.

        Args:
            data: Folder of the reference captures.
        """
        return read_capture(data / self.folder / self.static) if self.static else None

    def trial(self, data: Path, one: RealTrial) -> Capture:
        """A trial, without plates where they are not followed.

        Args:
            data: Folder of the reference captures.
            one: The trial.
        """
        folder = data / self.folder
        read = read_capture(folder / one.file, forces=folder / one.forces if one.forces else None)
        return read if one.loads else replace(read, plates=())


_PIG = Reference(IN_C3D)


def _child(name: str, number: str, mass_kg: float) -> RealPerson:
    static, walk = f"{name}_Static_{name}01.c3d", f"{name}_Straight_{name}{number}.c3d"
    trials = (RealTrial(STANDING, static, _PIG, loads=False), RealTrial("walk", walk, _PIG))
    return RealPerson(name, "biomechzoo_walk_turn", static, mass_kg, trials)


def _challenge(number: int) -> RealTrial:
    name = f"ss{number}"
    return RealTrial(name, f"{name}.trc", Reference(OPENSIM, f"{name}_ik.mot"), f"{name}_grf.mot")


def _lift(number: int, frames: str) -> RealTrial:
    angles = f"reference_ik/qIK_stoop{number}.csv"
    file = f"stoop{number}_t169_{frames}.c3d"
    return RealTrial(f"lift {number}", file, Reference(RBDL, angles), loads=False)


_RAJAGOPAL_WALK = Reference(OPENSIM, "reference_walk/coordinates_rra.sto", "reference_walk/id_walk.sto")
_GAIT2354_WALK = Reference(
    OPENSIM, "reference/subject01_walk1_ik.mot", "reference/inverse_dynamics.sto", knee=-1.0
)

PERSONS: tuple[RealPerson, ...] = (
    RealPerson(
        "rajagopal",
        "rajagopal_walk_run",
        "static_walk_1.trc",
        85.07,
        (RealTrial("walk", "motion_capture_walk.trc", _RAJAGOPAL_WALK, "grf_walk.mot"),),
    ),
    RealPerson(
        "gait2354",
        "gait2354_walk",
        "subject01_static.trc",
        72.6,
        (RealTrial("walk", "subject01_walk1.trc", _GAIT2354_WALK, "subject01_walk1_grf.mot"),),
    ),
    RealPerson(
        "OpenCap 6",
        "opencap_s6_walk",
        "s6_static1.trc",
        59.0,
        (
            RealTrial(
                "walk",
                "s6_walking1.trc",
                Reference(OPENSIM, "s6_walking1_expert_ik.mot"),
                "s6_walking1_forces.mot",
            ),
        ),
    ),
    RealPerson("knee challenge", "grand_challenge_knee", "static.trc", 82.7, (_challenge(1), _challenge(3))),
    _child("HC032A", "03", 60.3),
    _child("HC044A", "15", 39.4),
    RealPerson(
        "clinic",
        "functional_walk",
        "FunctionalStatic.c3d",
        60.0,
        (
            RealTrial(STANDING, "FunctionalStatic.c3d", _PIG, loads=False),
            RealTrial("walk", "FunctionalWalk.c3d", _PIG, loads=False),
        ),
    ),
    RealPerson(
        "gaitalytics",
        "gaitalytics_walk",
        "",
        63.6,
        (RealTrial("walk", "overground_fullbody_4plates.c3d", _PIG),),
    ),
    RealPerson("cgm24", "cgm24_lowerlimb_walk", "", 77.6, (RealTrial("walk", "CGM24_Walking01.c3d", _PIG),)),
    RealPerson(
        "stoop lift",
        "stoop_lift_box",
        "neu_t169_f250f350.c3d",
        81.7,
        (_lift(1, "f620f800"), _lift(2, "f1395f1590"), _lift(3, "f2101f2300")),
    ),
)
"""``clinic`` is followed by its markers: its plates are read wrongly (hip moments of thousands of N m)."""
