"""Errors of one reconstructed motion against its truth, each beside the standard deviations that were stated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.foreign.centres import true_centres
from benchmarks.foreign.truth import Truth
from mbkf.conventions import SIDES, Array
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel

GROUPS: dict[str, tuple[str, ...]] = {
    "legs": tuple(
        f"{name}_{side}"
        for name in ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
        for side in SIDES
    ),
    "lumbar": ("lumbar_extension", "lumbar_bending", "lumbar_rotation"),
    "shoulder": tuple(f"{name}_{side}" for name in ("arm_flex", "arm_add", "arm_rot") for side in SIDES),
    "elbow": tuple(f"elbow_flex_{side}" for side in SIDES),
}
"""Coordinates that both bodies define alike; not the forearm's turn, whose zero differs by 90°, and not the toes."""

SEGMENTS = {"hip": "thigh", "knee": "shank", "ankle": "foot"}
"""The segments that begin at our joints."""


@dataclass(frozen=True)
class Series:
    """One quantity over a motion.

    Attributes:
        person, motion: Whose, and which.
        group: Group of quantities.
        name: Its name.
        error: (T,) estimate minus truth; degrees, or N m/kg.
        sd: (T,) total standard deviation that was stated.
        varying_sd: (T,) its part that varies within the motion.
    """

    person: str
    motion: str
    group: str
    name: str
    error: Array
    sd: Array
    varying_sd: Array

    @property
    def offset(self) -> float:
        """Mean error of the motion."""
        return float(np.nanmean(self.error))

    @property
    def varying(self) -> Array:
        """(T,) error without its mean."""
        return self.error - self.offset


@dataclass(frozen=True)
class Judged:
    """One reconstructed motion.

    Attributes:
        person, motion: Whose, and which.
        angles: Errors of joint angles, degrees.
        moments: Errors of the legs' joint moments, N m/kg.
        centres_m: (T,) distances of our joint centres from the true ones by joint and side, m.
    """

    person: str
    motion: str
    angles: tuple[Series, ...]
    moments: tuple[Series, ...]
    centres_m: dict[tuple[str, str], Array]


def judged(person: str, motion: str, found: Reconstruction, truth: Truth, hips: dict[str, Array]) -> Judged:
    """Errors of a reconstruction.

    Args:
        person: Name of the person.
        motion: Name of the motion.
        found: The reconstruction.
        truth: The truth of the motion.
        hips: True hip centres in the pelvis by side.
    """
    tracked, mass = found.tracked, truth.mass_kg

    def at(values: Array) -> Array:
        """(T,) or (T, 3) true values at our frames; NaN where we track nothing."""
        columns = values.reshape(len(values), -1).T
        there = np.column_stack([np.interp(found.times_s, truth.times_s, column) for column in columns])
        return np.where(tracked[:, None], there, np.nan).reshape(-1, *values.shape[1:])

    angles, moments = [], []
    for group, names in GROUPS.items():
        for name in names:
            if not truth.has(name):
                continue
            away = found.angle(name) - at(truth.coordinate(name))
            error = np.degrees(np.arctan2(np.sin(away), np.cos(away)))
            sds = (np.degrees(found.angle_sd(name, part)) for part in ("total", "varying"))
            angles.append(Series(person, motion, group, name, error, *sds))
            if group == "legs":
                error = (found.moment(name) - at(truth.moment(name))) / mass
                sds = (found.moment_sd(name, part) / mass for part in ("total", "varying"))
                moments.append(Series(person, motion, group, name, error, *sds))
    model = HumanModel.of(found.subject)
    origins = np.array([model.placements(q)[1] for q in found.q])
    centres = {
        (joint, side): np.linalg.norm(origins[:, _joint_id(model, joint, side)] - at(true), axis=1)
        for (joint, side), true in true_centres(truth, hips).items()
    }
    return Judged(person, motion, tuple(angles), tuple(moments), centres)


def _joint_id(model: HumanModel, joint: str, side: str) -> int:
    return model.joint(f"{'right' if side == 'r' else 'left'}_{SEGMENTS[joint]}").joint_id
