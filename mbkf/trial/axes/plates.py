"""Evidence of force plates on axes: the side their surfaces face, and direction and place of their forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.axes import nearest_axis
from mbkf.io.plate_corners import plate_normal
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.turning import turned_plate
from mbkf.trial.axes.evidence import MarkerPlaces

PUSHING_N, LEAST_SAMPLES = 50.0, 20
"""Least force of a loaded plate, and least number of loaded samples, that count as evidence."""

OUTLYING = 10.0
"""A sample counts at most as much as one of this many times the median force."""

UPWARD_COSINE = np.cos(np.deg2rad(30.0))
"""The summed force of the ground points upwards within this angle: friction averages out."""

UNDER_FOOT_M = 0.35
"""Largest distance from the nearest marker of a foot to a centre of pressure under it."""

_SAMPLES = 200
_UP = np.array([0.0, 0.0, 1.0])


def contradiction(capture: Capture, turn: Array, places: MarkerPlaces) -> str:
    """Contradiction between a capture's plates and a correction of its axes, in words; "" for agreement or no evidence.

    Args:
        capture: The capture as it was read.
        turn: (3, 3) signed permutation.
        places: Places of its markers on the body.
    """
    before = [plate_normal(plate.corners_m) for plate in capture.plates if plate.corners_m is not None]
    plates = [turned_plate(plate, turn) for plate in capture.plates]
    if before and all(normal @ before[0] > UPWARD_COSINE for normal in before):
        after = plate_normal(next(plate.corners_m for plate in plates if plate.corners_m is not None))
        if after @ _UP < UPWARD_COSINE:
            if before[0] @ _UP > UPWARD_COSINE and turn[2, 2] == 1.0:
                return "the plates are not mirrored; are right and left exchanged in the markers' names?"
            return f"the plates' surfaces face {nearest_axis(turn.T @ after)}"
    return pushed_away(plates) or _beside_feet(capture, plates, turn, places)


def pushed_away(plates: Sequence[PlateReadings]) -> str:
    """Direction of plates' forces that do not point upwards, in words; "" for upward forces or too few of them."""
    pushes = [_pushes(plate) for plate in plates]
    if sum(map(len, pushes)) < LEAST_SAMPLES or _signs_differ(pushes):
        return ""
    whole = sum((push.sum(axis=0) for push in pushes), np.zeros(3))
    if whole[2] > UPWARD_COSINE * np.linalg.norm(whole):
        return ""
    return f"the plates push along {nearest_axis(whole)} of the world (z is up)"


def _pushes(plate: PlateReadings) -> Array:
    """(n, 3) forces of a plate's loaded samples, N, limited to ten times their median against wrong ones."""
    size = np.linalg.norm(plate.force_n, axis=1)
    loaded = np.isfinite(size) & (size > PUSHING_N)
    if not loaded.any():
        return np.zeros((0, 3))
    most = OUTLYING * float(np.median(size[loaded]))
    return np.asarray(plate.force_n[loaded] * np.minimum(1.0, most / size[loaded])[:, None])


def _signs_differ(pushes: Sequence[Array]) -> bool:
    """True if some plates push upwards and the others pull: the vertical is right, and a sign wrong."""
    wholes = [push.sum(axis=0) for push in pushes if len(push)]
    cosines = np.array([whole[2] / np.linalg.norm(whole) for whole in wholes if whole.any()])
    upright = np.abs(cosines) > UPWARD_COSINE
    return bool(upright.all() and (cosines > 0.0).any() and (cosines < 0.0).any())


def _beside_feet(capture: Capture, plates: Sequence[PlateReadings], turn: Array, places: MarkerPlaces) -> str:
    """Message on centres of pressure that are not under the feet; "" otherwise."""
    on_feet = [segment in places.feet[0] | places.feet[1] for segment in places.segments]
    if not any(on_feet):
        return ""
    markers = capture.markers
    feet = markers.positions_m[:, places.columns[on_feet], :] @ turn.T
    distances = []
    for plate in plates:
        loaded = np.flatnonzero(~np.isnan(plate.centre_of_pressure_m).any(axis=1))
        for sample in loaded[:: max(1, len(loaded) // _SAMPLES)]:
            frame = round((plate.times_s[sample] - markers.start_time_s) * markers.rate_hz)
            if 0 <= frame < markers.frames:
                away = feet[frame] - plate.centre_of_pressure_m[sample]
                distances.append(np.nanmin(np.hypot(away[:, 0], away[:, 1]), initial=np.inf))
    seen = np.array([one for one in distances if np.isfinite(one)])
    if len(seen) < LEAST_SAMPLES or np.median(seen) < UNDER_FOOT_M:
        return ""
    return f"the centres of pressure lie {np.median(seen):.2f} m beside the feet"
