"""Right results of a trial, and the errors of others: sagittal angles of the legs and their torques."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.io.verdict import LOAD_PARTS
from mbkf.trial.verdict.parts import LEGS

JOINTS = ("hip_flexion", "knee_angle", "ankle_angle")
ANGLES = tuple(f"{joint}_{side}" for joint in JOINTS for side in "rl")
"""Sagittal angles of the legs, and their torques."""


@dataclass(frozen=True)
class Right:
    """The right results, frame by frame.

    Attributes:
        angles: Sagittal angles by name, rad.
        torques: Their torques over the body's mass, N m/kg.
    """

    angles: Mapping[str, Array]
    torques: Mapping[str, Array]


def right_of(found: Reconstruction) -> Right:
    """The results of a reconstruction as right ones; torques of frames that do not count are not known.

    Args:
        found: The reconstruction.
    """
    counts = found.valid if found.valid.any() else found.tracked
    return Right(
        {name: np.where(found.tracked, found.angle(name), np.nan) for name in ANGLES},
        {name: np.where(counts, found.moment(name), np.nan) / found.subject.mass_kg for name in ANGLES},
    )


def errors(found: Reconstruction, right: Right) -> tuple[dict[str, float], dict[str, float]]:
    """Largest errors of each leg's sagittal angles, degrees, and torques, N m/kg, by parts of the verdict.

    Args:
        found: The result.
        right: The right results in the same frames.
    """
    counts = found.valid if found.valid.any() else found.tracked
    angles, torques = dict.fromkeys(LEGS, 0.0), dict.fromkeys(LOAD_PARTS[:2], 0.0)
    for name in ANGLES:
        side = 0 if name.endswith("_r") else 1
        away = found.angle(name) - right.angles[name]
        away = np.rad2deg(np.arctan2(np.sin(away), np.cos(away)))
        angles[LEGS[side]] = max(angles[LEGS[side]], _rms(away, found.tracked))
        per_kg = found.moment(name) / found.subject.mass_kg - right.torques[name]
        torques[LOAD_PARTS[side]] = max(torques[LOAD_PARTS[side]], _rms(per_kg, counts))
    return angles, torques


def _rms(error: Array, counts: BoolArray) -> float:
    known = error[counts & np.isfinite(error)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else 0.0
