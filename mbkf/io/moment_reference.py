"""The point and the unit of the moments that a table of ground reactions states beside force and pressure.

At the centre of pressure p a foot has a vertical torque T, a few centimetres times its force. A moment about another
point o is M = (p − o) × F + T, whose horizontal part determines o where force or p change.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array

LABORATORY_M = 50.0
"""Greatest distance of a point of application from the laboratory's origin."""

_LARGEST_TILT_M = 0.02
"""Horizontal torque over force that a torque at the centre of pressure may show, RMS."""
_EXACT_TILT_M = 0.002
"""Horizontal torque over force, RMS, beyond the rounding of a torque at the centre of pressure."""
_EXACT_SHARE = 0.1
"""Share of the horizontal torque that remains about the centre of pressure, where it is one about another point."""
_CLEAR_SHARE = 0.5
"""Share of what a constant lever at the point of application leaves that a point which stays may leave."""
_LARGEST_FREE_M = 0.2
"""Vertical torque over force of one foot, RMS; feet reach 0.02 to 0.05."""
_LEAST_MOVED_M = 0.005
"""Standard deviation of points of application that follow a foot; those of a fixed point do not move."""


class MomentReference(NamedTuple):
    """Unit and point of the moments of a set.

    Attributes:
        newton_metres: N m per unit.
        origin_m: (3,) point that they refer to; None for the point of application.
        doubt: Evidence against both in words; empty without any.
    """

    newton_metres: float
    origin_m: Array | None
    doubt: str = ""


def reference_at_point(force: Array, point: Array, moment: Array) -> MomentReference:
    """Unit and point of moments that should act at the point of application, in N m.

    Another point is believed where it explains the torques and stays where the point of application moves; N mm, where
    vertical torques are those of feet in N mm and no foot's in N m.

    Args:
        force: (S, 3) force of the loaded samples, N.
        point: (S, 3) points of application, m.
        moment: (S, 3) moments.
    """
    for factor in (1.0, 1e-3):
        origin = _fixed_point(force, point, factor * moment)
        if origin is not None:
            return MomentReference(factor, origin)
    tilt, free = _levers(force, moment)
    if tilt < _EXACT_SHARE * free and _LARGEST_FREE_M < free <= 1e3 * _LARGEST_FREE_M:
        return MomentReference(1e-3, None)
    if point.std(axis=0).max() < _LEAST_MOVED_M:  # a wrench there, at most a laboratory away from its force
        return MomentReference(1.0 if tilt <= LABORATORY_M else 1e-3, None)
    if max(tilt / _LARGEST_TILT_M, free / _LARGEST_FREE_M) <= 1.0:
        return MomentReference(1.0, None)
    doubt = (
        f"torques at the points of application are {tilt:.2g} m times the force about horizontal axes and {free:.2g} m "
        "about the vertical one, and a foot has 0 and less than 0.1 m; check their point and unit"
    )
    return MomentReference(1.0, None, doubt)


def reference_of_moments(
    force: Array, point: Array, moment: Array, newton_metres: float | None
) -> MomentReference | None:
    """Unit and point of moments about a point that the table does not state; None if there are no such.

    Args:
        force: (S, 3) force of the loaded samples, N.
        point: (S, 3) points of application, m.
        moment: (S, 3) moments.
        newton_metres: N m per unit; None where the table does not state it.
    """
    for factor in (1.0, 1e-3) if newton_metres is None else (newton_metres,):
        origin = _origin(force, point, factor * moment)
        ways: list[tuple[tuple[float, float], Array | None]] = [(_levers(force, factor * moment), None)]
        if np.abs(origin).max() <= LABORATORY_M:
            ways.append((_levers(force, factor * moment - np.cross(point - origin, force)), origin))
        possible = [way for way in ways if way[0][0] <= _LARGEST_TILT_M and way[0][1] <= _LARGEST_FREE_M]
        if possible:
            return MomentReference(factor, min(possible, key=lambda way: way[0][0])[1])
    return None


def _fixed_point(force: Array, point: Array, moment: Array) -> Array | None:
    """(3,) the fixed point that moments, N m, refer to, the laboratory's origin first; None without one."""
    tilt, _ = _levers(force, moment)
    if tilt <= _EXACT_TILT_M:
        return None
    for origin in (np.zeros(3), _origin(force, point, moment)):
        left, _ = _levers(force, moment - np.cross(point - origin, force))
        if left < _EXACT_SHARE * tilt and np.abs(origin).max() <= LABORATORY_M:
            at_lever = moment + np.cross(_origin(force, np.zeros_like(point), moment), force)
            if not origin.any() or left < _CLEAR_SHARE * _levers(force, at_lever)[0]:
                return origin
    return None


def _levers(force: Array, torque: Array) -> tuple[float, float]:
    """RMS of horizontal and of vertical torque (S, 3), over that of the force (S, 3), m."""
    rms = np.sqrt((torque**2).mean(axis=0) / (force**2).sum(axis=1).mean())
    return float(np.hypot(rms[0], rms[1])), float(rms[2])


def _origin(force: Array, point: Array, moment: Array) -> Array:
    """(3,) point about which the moments are those of the forces at their points, but for a vertical torque."""
    fx, fy, fz = force.T
    zero = np.zeros_like(fx)
    # o × F = p × F + T − M, of which the horizontal components are free of the vertical torque T
    rows = np.vstack([np.column_stack([zero, fz, -fy]), np.column_stack([-fz, zero, fx])])
    right = np.cross(point, force) - moment
    return np.asarray(np.linalg.lstsq(rows, np.concatenate([right[:, 0], right[:, 1]]), rcond=None)[0])
