"""Force plates as contact sees them: wrenches about the world's origin, surfaces, centres of pressure, areas."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.io.resample import average_over_frames
from mbkf.io.wrench import centre_of_pressure


def plate_wrenches(plates: tuple[PlateReadings, ...], times_s: Array, rate_hz: float) -> Array:
    """(T, P, 6) mean force N and moment N m about the world's origin of every plate over each frame.

    NaN where a plate was not recorded.

    Args:
        plates: The plates.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
    """
    wrench = np.full((len(times_s), len(plates), 6), np.nan)
    for p, plate in enumerate(plates):
        found, recorded = about_world_origin(plate, times_s, rate_hz)
        wrench[recorded, p] = found[recorded]
    return wrench


def surface_height(plate: PlateReadings) -> float:
    """Height of a plate's surface in the world, m."""
    return float(plate.origin_m[2] if plate.corners_m is None else plate.corners_m[:, 2].mean())


def pressure_and_free_moment(wrench: Array, surface_m: float, threshold_n: float) -> tuple[Array, Array]:
    """(T, 2, 3) centre of pressure at a height and (T, 2) free moment of feet's wrenches (T, 2, 6); NaN unloaded."""
    pressure = np.stack([pressure_on(wrench[:, foot], surface_m, threshold_n) for foot in range(2)], axis=1)
    free = wrench[..., 5] - (pressure[..., 0] * wrench[..., 1] - pressure[..., 1] * wrench[..., 0])
    return pressure, free


def about_world_origin(plate: PlateReadings, times_s: Array, rate_hz: float) -> tuple[Array, BoolArray]:
    """(T, 6) mean wrench about the world's origin over each frame, zero where not recorded, and where it is (T,)."""
    loads = average_over_frames(plate, times_s, rate_hz)
    recorded = np.asarray(~np.isnan(loads.force_n).any(axis=1))
    force = np.nan_to_num(loads.force_n)
    moment = np.nan_to_num(loads.moment_nm) + np.cross(plate.origin_m, force)
    return np.concatenate([force, moment], axis=1), recorded


def pressure_on(wrench: Array, surface_m: float, threshold_n: float) -> Array:
    """(T, 3) centre of pressure on a horizontal surface from wrenches about the world's origin (eq. 4.9)."""
    below = np.array([0.0, 0.0, surface_m])
    moment = wrench[:, 3:] - np.cross(below, wrench[:, :3])
    return centre_of_pressure(wrench[:, :3], moment, below, np.array([0.0, 0.0, 1.0]), threshold_n)


class PlateAreas:
    """Convex plates seen from above, all at once.

    Attributes:
        known: (K,) plates whose corners are.
    """

    def __init__(self, plates: Sequence[PlateReadings]) -> None:
        self.known = np.array([plate.corners_m is not None for plate in plates], dtype=bool)
        corners = np.zeros((len(plates), 4, 2))
        for own, plate in zip(corners, plates, strict=True):
            if plate.corners_m is not None:
                own[:] = plate.corners_m[:, :2]
        self._from, self._along = corners, np.roll(corners, -1, axis=1) - corners

    def contain(self, points_m: Array) -> BoolArray:
        """(n, K) whether points (n, 2) lie over each; never over one that is not known."""
        away = points_m[:, None, None] - self._from
        left = self._along[:, :, 0] * away[..., 1] - self._along[:, :, 1] * away[..., 0] >= 0.0
        return np.asarray((left.all(axis=-1) | ~left.any(axis=-1)) & self.known)
