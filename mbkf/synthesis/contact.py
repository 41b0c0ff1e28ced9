"""The ground under the feet: outline of the soles, load sharing, and the split of one ground wrench into two."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body

FRICTION = 0.8
"""Coefficient of friction of a shoe on a dry laboratory floor; horizontal force stays below this times vertical."""

NEGLIGIBLE = 1e-9
"""Share of the load that counts as unloaded."""


@dataclass(frozen=True)
class SoleOutline:
    """Rectangle under a foot in its frame, m: ``heel_x``…``toe_x``, ``low_y``…``high_y``, at ``height``."""

    heel_x: float
    toe_x: float
    low_y: float
    high_y: float
    height: float

    def holds(self, points: Array, tolerance_m: float = 1e-9) -> np.ndarray:
        """(...) whether points (..., 3) of the foot's frame lie over the rectangle."""
        x, y = points[..., 0], points[..., 1]
        return (
            (x >= self.heel_x - tolerance_m)
            & (x <= self.toe_x + tolerance_m)
            & (y >= self.low_y - tolerance_m)
            & (y <= self.high_y + tolerance_m)
        )


def sole_outline(model: Body, side: str) -> SoleOutline:
    """The scaled sole of side "r" or "l"."""
    sole = model.description.sole
    name = "right_foot" if side == "r" else "left_foot"
    x, y, z = model.axis_scale(model.description.segment(name))
    across = sorted((1.0 if side == "r" else -1.0) * y * edge for edge in (sole.inner_y_m, sole.outer_y_m))
    return SoleOutline(x * sole.heel_x_m, x * sole.toe_x_m, across[0], across[1], z * sole.height_m)


@dataclass(frozen=True)
class Load:
    """Planned load of the feet.

    Attributes:
        share: (T,) part of the load on the right foot, 0…1.
        pressure: (T, 2, 2) wanted centre of pressure of right and left foot on its surface, m.
        grounded: (T,) whether anything is on the ground.
        surface_m: (T, 2) height of the surface under right and left foot, m; None: the floor.
        apex_m: Height at which both feet's forces point, m; None: that of the centre of mass.
    """

    share: Array
    pressure: Array
    grounded: np.ndarray
    surface_m: Array | None = None
    apex_m: float | None = None

    @property
    def shares(self) -> Array:
        """(T, 2) parts of the load on right and left foot, rounded to 0 and 1 where they come that close."""
        right = np.clip(self.share, 0.0, 1.0)
        right = np.where(right < NEGLIGIBLE, 0.0, np.where(right > 1 - NEGLIGIBLE, 1.0, right))
        return np.column_stack([right, 1 - right])

    @property
    def surfaces(self) -> Array:
        """(T, 2) height of the surface under right and left foot, m."""
        return np.zeros((len(self.share), 2)) if self.surface_m is None else self.surface_m

    @property
    def mean_surface(self) -> Array:
        """(T,) height of the surfaces, weighted with the shares, m."""
        return np.asarray((self.shares * self.surfaces).sum(axis=1))

    @property
    def total_pressure(self) -> Array:
        """(T, 2) mean of the wanted centres of pressure, weighted with the shares, m."""
        return np.einsum("tf,tfi->ti", self.shares, self.pressure)

    def between(self, height: Array) -> Array:
        """(T,) how far the mean pressure lies beyond the point of zero moment, as part of the way left to right foot.

        The feet's forces point from their centres of pressure at the centre of mass; on surfaces of different heights
        the forces that this adds between the feet have a moment.

        Args:
            height: (T,) height of the centre of mass, m.
        """
        shares, surfaces = self.shares, self.surfaces
        step = surfaces[:, 1] - surfaces[:, 0]
        return np.asarray(shares[:, 0] * shares[:, 1] * step / (height - self.mean_surface))

    def zero_moment(self, height: Array) -> Array:
        """(T, 2) point of zero moment, at the mean height of the surfaces, that gives the wanted pressure, m.

        Args:
            height: (T,) height of the centre of mass, m.
        """
        apart = self.pressure[:, 0] - self.pressure[:, 1]
        return self.total_pressure - self.between(height)[:, None] * apart


LoadPlan = Callable[[Array], Load]
"""(T,) times in s to the load."""


def split(wrench: Array, load: Load, height: Array) -> tuple[Array, Array]:
    """Divides the ground's wrench between the feet.

    Each foot's force points from its centre of pressure roughly at the centre of mass, so that in walking the
    front foot brakes and the rear one pushes; the forces that this adds cancel.

    Args:
        wrench: (T, 6) total force N and moment N m about the world origin.
        load: The intended load; the difference of the motion from it shifts both centres of pressure, that of
            the foot with more load more.
        height: (T,) height of the centre of mass, m.

    Returns:
        (T, 2, 6) wrenches about the world origin of right and left foot, and (T, 2, 3) centres of pressure, NaN
        for a foot without load.
    """
    frames = len(wrench)
    wrenches, centres = np.zeros((frames, 2, 6)), np.full((frames, 2, 3), np.nan)
    on = load.grounded
    force, moment = wrench[on, :3], wrench[on, 3:]
    shares, surfaces, pressure = load.shares[on], load.surfaces[on], load.pressure[on]
    mean_surface, between = load.mean_surface[on], load.between(height)[on, None]
    over = (height[on] if load.apex_m is None else load.apex_m) - mean_surface
    lever = np.stack([-moment[:, 1], moment[:, 0]], axis=-1) + mean_surface[:, None] * force[:, :2]
    zero_moment = lever / force[:, 2:]
    own = shares / (shares**2).sum(axis=1)[:, None]
    apart, unequal = pressure[:, 0] - pressure[:, 1], own[:, :1] - own[:, 1:]
    missed = (zero_moment + between * apart - load.total_pressure[on]) / (1 - between * unequal)
    mean = zero_moment + between * (apart + unequal * missed)
    twist = moment[:, 2] - (mean[:, 0] * force[:, 1] - mean[:, 1] * force[:, 0])
    for foot in range(2):
        share = shares[:, foot]
        at = np.column_stack([pressure[:, foot] + own[:, foot, None] * missed, surfaces[:, foot]])
        part = share[:, None] * force
        part[:, :2] += (share * force[:, 2] / over)[:, None] * (mean - at[:, :2])
        turned = np.cross(at, part)
        turned[:, 2] += share * twist
        wrenches[on, foot] = np.hstack([part, turned])
        centres[on, foot] = np.where(share[:, None] > 0, at, np.nan)
    return wrenches, centres
