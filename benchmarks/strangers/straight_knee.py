"""The straight knee by the length of the leg, an outside yardstick of the zero of knee flexion.

Hip and ankle are furthest apart where the knee is straight, wherever the markers of the knee sit. With thigh and
shank of equal length their distance at the flexion θ is

    d(θ) = L cos((θ − θ₀) / 2),

and the fit of L and θ₀ gives the angle θ₀ that we state for a straight knee. Hip centres are those that Harrington 2007
expects from the markers on the pelvis; the lateral malleolus stands for the ankle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.checks import Check, information
from mbkf.conventions import SIDES, Array
from mbkf.io.results import Reconstruction
from mbkf.marker_sets.names import read_names

LARGEST_DEG = 60.0
"""Greatest flexion of the frames that count: skin moves the more the deeper knee and hip bend."""

STEP_DEG, FURTHEST_DEG = 0.25, 25.0
"""Steps and range of θ₀."""

FIT_SD_DEG = 5.0
"""Standard deviation of the fit: on persons made from bodies of OpenSim (adult, child; walk, squat, run) θ₀ of the true
knee angle has an RMS of 4.9°."""

MOST_SD = 2.0
"""Standard deviations, of the fit and of our zero together, by which the two may differ."""

WORDS = {"r": "right", "l": "left"}


@dataclass(frozen=True)
class StraightKnee:
    """The fit of a leg's length.

    Attributes:
        angle_deg: The angle stated for a straight knee, θ₀; 0 where the zero of the stated angle is right.
        rms_mm: RMS of the length about the fit.
    """

    angle_deg: float
    rms_mm: float


def straight_knee_rows(name: str, found: Reconstruction | None) -> Iterator[Check]:
    """Rows of both knees: the angle stated for a straight one, and that over its standard deviation.

    Args:
        name: The capture, for the rows.
        found: Its reconstruction; None gives no rows.
    """
    if found is None:
        return
    at = landmarks(found.marker_names, found.measured_m)
    hips = hip_centres_m(at)
    for side in SIDES:
        ankle = at.get(f"{WORDS[side]}_ankle_lateral")
        if ankle is None or side not in hips:
            continue
        length = np.linalg.norm(hips[side] - ankle, axis=1)
        knee = straight_knee(length, np.rad2deg(found.angle(f"knee_angle_{side}")))
        sd = float(np.rad2deg(np.nanmedian(found.angle_sd(f"knee_angle_{side}"))))
        row = f"{name}: {WORDS[side]} knee, straight by the leg's length"
        yield information(f"{row}, stated as", knee.angle_deg, "°")
        yield Check(f"{row}, over sd", abs(knee.angle_deg) / float(np.hypot(sd, FIT_SD_DEG)), MOST_SD, "<=")


def straight_knee(length_m: Array, knee_deg: Array) -> StraightKnee:
    """The fit of d(θ).

    Args:
        length_m: (T,) distance of hip and ankle, NaN where it is not known.
        knee_deg: (T,) flexion of the knee as stated.
    """
    kept = np.isfinite(length_m) & (knee_deg < LARGEST_DEG)
    zeros = np.arange(-FURTHEST_DEG, FURTHEST_DEG + STEP_DEG, STEP_DEG)
    shapes = np.cos(0.5 * np.deg2rad(knee_deg[kept] - zeros[:, None]))
    longest = (shapes @ length_m[kept]) / (shapes**2).sum(axis=1)
    errors = ((length_m[kept] - longest[:, None] * shapes) ** 2).mean(axis=1)
    best = int(np.argmin(errors))
    return StraightKnee(float(zeros[best]), 1e3 * float(np.sqrt(errors[best])))


def landmarks(names: Sequence[str], positions_m: Array) -> dict[str, Array]:
    """(T, 3) places of the markers by the landmark that each name means first.

    Args:
        names: (M,) names of the markers.
        positions_m: (T, M, 3) their places.
    """
    readings = read_names(names)
    places: dict[str, Array] = {}
    for m, name in enumerate(names):
        for place in readings[name].places[:1]:
            places.setdefault(place.landmark, positions_m[:, m])
    return places


def hip_centres_m(at: Mapping[str, Array]) -> dict[str, Array]:
    """(T, 3) hip centres by side, z up; empty without markers on both ASIS and PSIS (or the sacrum).

    Args:
        at: (T, 3) places by landmark.
    """
    behind = [name if name in at else "sacrum" for name in ("right_psis", "left_psis")]
    if not {"right_asis", "left_asis", *behind} <= set(at):
        return {}
    right, left = at["right_asis"], at["left_asis"]
    middle, back = 0.5 * (right + left), 0.5 * (at[behind[0]] + at[behind[1]])
    width, depth = (np.nanmean(np.linalg.norm(one, axis=1)) for one in (left - right, middle - back))
    across = _unit(left - right)
    forward = middle - back
    forward = _unit(forward - (forward * across).sum(axis=1, keepdims=True) * across)
    centre = middle - (0.24 * depth + 9.9e-3) * forward - (0.30 * width + 10.9e-3) * np.cross(forward, across)
    half = (0.33 * width + 7.3e-3) * across
    return {"r": centre - half, "l": centre + half}


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
