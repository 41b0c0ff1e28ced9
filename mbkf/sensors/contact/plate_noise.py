"""White noise of plates, forces and moments each by their own readings, and as it stands in wrenches on the feet.

A plate's moments about its own origin o have noise of their own, σ_M. Moved to the world's origin they take up noise
of the forces, too:

    σ² = σ_M² + |o − (o·e) e|² σ_F²        about an axis e of the world

Which plate a foot is on makes little difference, since plates of a laboratory are alike; the nearest one counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.sensors.white_noise import WhiteNoise

LEAST_FORCE_N, LEAST_MOMENT_NM = 0.1, 0.02
"""Least noise of a plate's forces and moments: readings are stored in steps of such a size."""

OF_WHITE_NOISE = 6.0**0.5
"""Standard deviation of the second differences of white noise of standard deviation 1."""

_NO_ORIGINS = np.zeros((0, 3))

_OTHERS = 1.0 - np.eye(3)
"""Of squares by axis, the sums of the other two."""


class PlateNoise(NamedTuple):
    """Noise of K plates after a frame.

    Attributes:
        origins_m: (K, 3) points that the plates' own moments refer to.
        force: Noise of the forces, N.
        moment: Noise of the moments about these points, N m.
    """

    origins_m: Array
    force: WhiteNoise
    moment: WhiteNoise

    @classmethod
    def before(cls, origins_m: Array, force_n: float, moment_nm: float) -> PlateNoise:
        """Before the first reading.

        Args:
            origins_m: (K, 3) points that the plates' own moments refer to.
            force_n: Usual noise of forces, N.
            moment_nm: Usual noise of moments, N m.
        """
        noise = WhiteNoise(force_n, LEAST_FORCE_N), WhiteNoise(moment_nm, LEAST_MOMENT_NM)
        return cls(np.ascontiguousarray(origins_m, float), *noise)

    def after(self, wrench: Array) -> PlateNoise:
        """The noise after the next frame's (K, 6) wrenches about the world's origin; NaN without a reading."""
        kernel = library()
        if kernel is None:
            force = wrench[:, :3]
            own = wrench[:, 3:] - np.cross(self.origins_m, force)
        else:
            force, own = kernel.plate_loads(self.origins_m, np.ascontiguousarray(wrench, float))
        return PlateNoise(self.origins_m, self.force.after(force), self.moment.after(own))

    def on_feet(self, middles_m: Array) -> Array:
        """(2, 6) noise of the feet's wrenches about the world's origin, N, N m.

        Args:
            middles_m: (2, 3) middles of the soles.
        """
        kernel = library()
        if kernel is not None:
            return kernel.plate_spreads(
                self.origins_m, np.ascontiguousarray(middles_m, float), self.force.sd, self.moment.sd
            )
        if not len(self.origins_m):
            return spread_about_origin(self.force.sd, self.moment.sd, middles_m)
        away = middles_m[:, None] - self.origins_m
        nearest = np.einsum("fki,fki->fk", away, away).argmin(axis=1)
        return spread_about_origin(self.force.sd, self.moment.sd, self.origins_m[nearest])


def spread_about_origin(force_n: float, moment_nm: float, points_m: Array) -> Array:
    """(n, 6) spreads of wrenches about the world's origin, of those that are independent about points (n, 3).

    Args:
        force_n: Spread of each force, N.
        moment_nm: Spread of each moment about the points, N m.
        points_m: The points, m.
    """
    kernel = library()
    if kernel is not None:
        return kernel.plate_spreads(_NO_ORIGINS, np.ascontiguousarray(points_m, float), force_n, moment_nm)
    found = np.empty((len(points_m), 6))
    found[:, :3] = force_n
    levers = (points_m * points_m) @ _OTHERS
    levers *= force_n**2
    levers += moment_nm**2
    np.sqrt(levers, out=found[:, 3:])
    return found


def changes_within(change: Array, noise: Array, shares: tuple[float, float]) -> Array:
    """(2, 2, 6) by how much means over a frame may be off: shares of a wrench's change and of that change's change.

    Args:
        change: (2, 2, 6) change of the feet's wrenches since the frame before, and of that change, N and N m.
        noise: (2, 6) white noise of the wrenches, whose second differences are left out.
        shares: Share of each.
    """
    kernel = library()
    if kernel is not None:
        return kernel.plate_changes(change, noise, OF_WHITE_NOISE, *shares)
    found = np.empty(change.shape)
    np.multiply(shares[0], change[0], out=found[0])
    beyond = np.maximum(change[1] ** 2 - (OF_WHITE_NOISE * noise) ** 2, 0.0)
    found[1] = shares[1] * np.copysign(np.sqrt(beyond), change[1])
    return found
