"""Eleven captures of strangers as they come: scale and reconstruct by default settings, against right answers.

Some of these persons extend a knee further than the bound on it. The length of the leg, which no marker of the knee
enters, shows whether that is an error of our zero (:mod:`benchmarks.strangers.straight_knee`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.any_capture.out_of_box import KNEE_DEG, Stranger, stranger_rows
from benchmarks.checks import Check, within
from benchmarks.strangers.right_answers import ANSWERS
from benchmarks.strangers.straight_knee import straight_knee_rows
from benchmarks.strangers.trial import Trial
from mbkf.io.subject import read_subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel

MOST_MM = 8.0
ANKLE_DEG = (-15.0, 15.0)
"""A standing person's ankle."""

BENT_KNEE_DEG = (-10.0, 140.0)
"""A knee in running, squats, landings and games."""

LEAST_MOVED_DEG = 5.0
"""Range of knees that are followed at all; those of a leg that nothing shows stay as they are."""


@dataclass(frozen=True)
class Shared:
    """A capture and how far its knee may bend.

    Masses are the readme's, or what the plates carry in ``mbkf info``; without either they are assumed. A wrong mass
    moves markers: the landing, by 38 kg, fits to 6.8 mm, and to 8.2 mm when 70 kg are assumed.
    """

    capture: Stranger
    knee_deg: tuple[float, float] = KNEE_DEG


def _shared(folder: str, trial: str, kg: float, static: str | None = None, **others: str) -> Stranger:
    return Stranger(
        folder, folder, trial, kg, MOST_MM, static, others.get("forces"), False, others.get("person")
    )


CAPTURES = (
    Shared(_shared("ric_run", "20140515T133244_run.c3d", 70.0, "20140515T133244_static.c3d"), BENT_KNEE_DEG),
    Shared(_shared("functional_walk", "FunctionalWalk.c3d", 60.0, "FunctionalStatic.c3d")),
    Shared(_shared("fukuchi_run", "RBDS001runT35.c3d", 60.3, "RBDS001static.c3d"), BENT_KNEE_DEG),
    Shared(_shared("start_off_treadmill", "markers.trc", 63.3, forces="grf.mot")),
    Shared(_shared("landings", "doubleLegLanding.c3d", 37.9), BENT_KNEE_DEG),
    Shared(_shared("french_walk_no_pelvis", "marche281.c3d", 69.0)),
    Shared(_shared("unipd_walk", "Walking1.c3d", 82.9, "Static1.c3d")),
    Shared(_shared("flywheel_squat", "S1_FlywheelSquat.c3d", 81.3, "S1_StandingRef.c3d"), BENT_KNEE_DEG),
    Shared(_shared("cmu_basketball", "cmu_dribble_shoot_basketball.c3d", 75.0), BENT_KNEE_DEG),
    Shared(_shared("jam_walk", "overground_17.trc", 73.6, "static1.trc", forces="overground_17.forces")),
    Shared(
        _shared("two_persons_art", "ART-Human_2persons_integer.c3d", 70.0, person="Human1"), BENT_KNEE_DEG
    ),
)


def shared_capture_rows(data: Path, out: Path) -> Iterator[Check]:
    """Rows of all captures: steps that fail, marker RMS, standing ankles, knees, and each one's right answers.

    Args:
        data: Folder of the reference captures.
        out: Folder for the results.
    """
    for one in CAPTURES:
        yield from capture_rows(one, data, out / one.capture.folder)


def capture_rows(one: Shared, data: Path, out: Path) -> Iterator[Check]:
    """Rows of one capture.

    Args:
        one: The capture.
        data: Folder of the reference captures.
        out: Folder for its results.
    """
    name = one.capture.name
    yield from stranger_rows(one.capture, data, out)
    if one.capture.static is not None:
        for side, angle in zip(("right", "left"), standing_ankles_deg(out / "subject.toml"), strict=True):
            yield from within(f"{name}: {side} ankle, standing", angle, *ANKLE_DEG, "°")
    trial = Trial(data / one.capture.folder, out)
    low, high = trial.range_deg("knee_angle")
    yield Check(f"{name}: knees move by", high - low, LEAST_MOVED_DEG, ">=", "°")
    yield Check(f"{name}: least knee flexion", low, one.knee_deg[0], ">=", "°")
    yield Check(f"{name}: greatest knee flexion", high, one.knee_deg[1], "<=", "°")
    yield from straight_knee_rows(name, trial.result)
    for row in ANSWERS[one.capture.folder](trial):
        yield Check(f"{name}: {row.name}", row.value, row.bound, row.relation, row.unit)


def standing_ankles_deg(subject: Path) -> tuple[float, float]:
    """Right and left ankle in the static trial that a person was scaled from, degrees; NaN without one."""
    person = read_subject(subject) if subject.is_file() else None
    if person is None or person.standing_q is None:
        return np.nan, np.nan
    angles = ClinicalAngles(HumanModel.of(person))
    right, left = (float(np.rad2deg(angles.value(f"ankle_angle_{side}", person.standing_q))) for side in "rl")
    return right, left
