"""Force plates as contact needs them: wrenches about the world's origin, centres of pressure, surfaces and areas.

Wrenches are force N and moment N m about the world's origin; plates are taken to be horizontal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.io.resample import average_over_frames
from mbkf.kernel.loading import library
from mbkf.sensors.contact.rules import least_load

Number = TypeVar("Number", float, Array)


def plate_wrenches(plates: tuple[PlateReadings, ...], times_s: Array, rate_hz: float) -> Array:
    """(T, P, 6) mean wrench of every plate over each frame, NaN where a plate was not recorded.

    Args:
        plates: The plates.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
    """
    wrench = np.full((len(times_s), len(plates), 6), np.nan)
    for p, plate in enumerate(plates):
        loads = average_over_frames(plate, times_s, rate_hz)
        recorded = ~np.isnan(loads.force_n).any(axis=1)
        force = loads.force_n[recorded]
        moment = np.nan_to_num(loads.moment_nm[recorded]) + np.cross(plate.origin_m, force)
        wrench[recorded, p] = np.concatenate([force, moment], axis=1)
    return wrench


def surface_height(plate: PlateReadings) -> float:
    """Height of a plate's surface in the world, m."""
    return float(plate.origin_m[2] if plate.corners_m is None else plate.corners_m[:, 2].mean())


def pressed_at(wrench: Sequence[Number], surface_m: float) -> tuple[Number, Number]:
    """World x and y of the centre of pressure: the point of a surface about which the horizontal moment vanishes.

    Departs from thesis eq. 4.9, which leaves out the shear: it holds where moments are about a point of the surface.

    Args:
        wrench: Its six components, each a number or an array, with a vertical force other than zero.
        surface_m: Height of the surface.
    """
    fx, fy, fz, mx, my, _ = wrench
    return (surface_m * fx - my) / fz, (surface_m * fy + mx) / fz


def force_read(plates: Array) -> tuple[bool, Array]:
    """True where plates read finite numbers alone, and the sum (3,) of their forces, N; those not read count as 0.

    Args:
        plates: (K, 6) wrenches, NaN where not read.
    """
    kernel = library()
    if kernel is not None:
        return kernel.plate_total(np.ascontiguousarray(plates, dtype=float))
    return bool(np.isfinite(plates).all()), np.nansum(plates[:, :3], axis=0)


def centres_of_pressure(wrench: Array, surface_m: float, threshold_n: float) -> Array:
    """(..., 3) world points in which a horizontal surface is pressed; NaN where not loaded.

    Args:
        wrench: (..., 6) wrenches.
        surface_m: Height of the surface.
        threshold_n: Vertical force below which it is not given.
    """
    point = np.full((*wrench.shape[:-1], 3), np.nan)
    loaded = wrench[..., 2] >= least_load(threshold_n)
    point[loaded, 0], point[loaded, 1] = pressed_at(list(wrench[loaded].T), surface_m)
    point[loaded, 2] = surface_m
    return point


def free_moment(wrench: Array, point_m: Array) -> Array:
    """(...,) vertical moment N m of wrenches (..., 6) about points (..., 3)."""
    x, y = point_m[..., 0], point_m[..., 1]
    return np.asarray(wrench[..., 5] - (x * wrench[..., 1] - y * wrench[..., 0]))


def pressure_and_free_moment(wrench: Array, surface_m: float, threshold_n: float) -> tuple[Array, Array]:
    """Centre of pressure (..., 3) at a height and free moment (...,) about it; NaN where not loaded.

    Args:
        wrench: (..., 6) wrenches.
        surface_m: Height of the surface.
        threshold_n: Vertical force below which neither is given.
    """
    point = centres_of_pressure(wrench, surface_m, threshold_n)
    return point, free_moment(wrench, point)


class PlateAreas:
    """Convex plates seen from above, all at once.

    Attributes:
        known: (K,) plates whose corners are known.
    """

    def __init__(self, plates: Sequence[PlateReadings]) -> None:
        self.known = np.array([plate.corners_m is not None for plate in plates], dtype=bool)
        corners = np.zeros((len(plates), 4, 2))
        for own, plate in zip(corners, plates, strict=True):
            if plate.corners_m is not None:
                own[:] = plate.corners_m[:, :2]
        self._from, self._along = corners, np.roll(corners, -1, axis=1) - corners
        self._edges = np.concatenate([self._from, self._along], axis=2).tolist()
        self._boxes = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1).tolist()

    def outlines(self) -> Array:
        """(K, 20) box of each plate from above (least x, y, greatest x, y) and edges (4, 4): origin, direction."""
        edges = np.array(self._edges).reshape(-1, 16)
        return np.concatenate([np.array(self._boxes).reshape(-1, 4), edges], axis=1)

    def contain(self, points_m: Array) -> BoolArray:
        """(n, K) True for points (n, 2) over a plate; never for an unknown point, or a plate without known corners."""
        (x, y), (x_least, y_least, x_most, y_most) = (
            points_m.T[:, :, None],
            np.array(self._boxes).reshape(-1, 4).T,
        )
        found = (x >= x_least) & (x <= x_most) & (y >= y_least) & (y <= y_most) & self.known
        near, plate = np.nonzero(found)
        away, along = points_m[near, None] - self._from[plate], self._along[plate]
        left = along[:, :, 0] * away[:, :, 1] - along[:, :, 1] * away[:, :, 0] >= 0.0
        found[near, plate] = left.all(axis=1) | ~left.any(axis=1)
        return found

    def over(self, plate: int, x: float, y: float) -> bool:
        """True for a point over a plate, as :meth:`contain`; quicker for a single one.

        Args:
            plate: Number of the plate.
            x: World coordinate of the point, m.
            y: Its other coordinate.
        """
        x_least, y_least, x_most, y_most = self._boxes[plate]
        if not (x_least <= x <= x_most and y_least <= y <= y_most and self.known[plate]):
            return False
        left = [ax * (y - y0) - ay * (x - x0) >= 0.0 for x0, y0, ax, ay in self._edges[plate]]
        return all(left) or not any(left)
