"""Steps and differences of free and spherical joints in CasADi, in the conventions of Pinocchio.

q ⊕ δ = q exp(δ), with δ in the joint's own axes: of a spherical joint a rotation vector, of a free one a twist
(linear, angular). Derivatives exist everywhere, at δ = 0, too: near zero, quotients such as sin(t)/t are their series.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca

from mbkf.model.symbolic.spatial import rotation_of

NEAR = 1e-2
"""Square of the angle, rad², below which the series are used; their error there is below 1e-14."""

HALF_SINE = (1 / 2, -1 / 48, 1 / 3840, -1 / 645120, 1 / 185794560)
"""Series of sin(t/2)/t in t²."""

VERSINE = (1 / 2, -1 / 24, 1 / 720, -1 / 40320, 1 / 3628800)
"""Series of (1 − cos t)/t²."""

DEFECT = (1 / 6, -1 / 120, 1 / 5040, -1 / 362880, 1 / 39916800)
"""Series of (t − sin t)/t³."""

INVERSE = (1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160)
"""Series of 1/t² − cot(t/2)/(2 t)."""

ARCSINE = (1.0, 1 / 6, 3 / 40, 5 / 112, 35 / 1152, 63 / 2816)
"""Series of arcsin(x)/x in x²."""


def stepped_rotation(quaternion: ca.SX, turn: ca.SX) -> ca.SX:
    """(4,) quaternion after a rotation vector (3,), rad."""
    return _normalised(_product(quaternion, _exponential(turn)))


def stepped_pose(pose: ca.SX, twist: ca.SX) -> ca.SX:
    """(7,) position and quaternion after a twist (6,); the quaternion stays in its hemisphere."""
    linear, turn = twist[:3], twist[3:]
    t2 = ca.sumsqr(turn)
    travel = linear + _near(t2, VERSINE, _versine) * ca.cross(turn, linear)
    travel += _near(t2, DEFECT, _defect) * ca.cross(turn, ca.cross(turn, linear))
    change = _exponential(turn)
    change *= ca.if_else(change[3] < 0, -1.0, 1.0)
    return ca.vertcat(pose[:3] + rotation_of(pose[3:]) @ travel, _normalised(_product(pose[3:], change)))


def rotation_difference(start: ca.SX, end: ca.SX) -> ca.SX:
    """(3,) rotation vector of at most π from one quaternion (4,) to another."""
    change = _normalised(_product(_conjugate(start), end))
    change *= ca.if_else(change[3] < 0, -1.0, 1.0)
    n2 = ca.sumsqr(change[:3])
    return 2.0 * _near(n2, ARCSINE, lambda s2: ca.atan2(ca.sqrt(s2), change[3]) / ca.sqrt(s2)) * change[:3]


def pose_difference(start: ca.SX, end: ca.SX) -> ca.SX:
    """(6,) twist from one position and quaternion (7,) to another."""
    turn = rotation_difference(start[3:], end[3:])
    travel = rotation_of(start[3:]).T @ (end[:3] - start[:3])
    back = _near(ca.sumsqr(turn), INVERSE, _inverse)
    linear = travel - 0.5 * ca.cross(turn, travel) + back * ca.cross(turn, ca.cross(turn, travel))
    return ca.vertcat(linear, turn)


def _exponential(turn: ca.SX) -> ca.SX:
    """(4,) quaternion of a rotation vector."""
    t2 = ca.sumsqr(turn)
    half_sine = _near(t2, HALF_SINE, lambda s2: ca.sin(0.5 * ca.sqrt(s2)) / ca.sqrt(s2))
    # cos(t/2) through (1 − cos t)/t²: the root t itself has no derivative at zero.
    cosine = 1.0 - 0.25 * t2 * _near(0.25 * t2, VERSINE, _versine)
    return ca.vertcat(half_sine * turn, cosine)


def _near(square: ca.SX, series: Sequence[float], formula: Callable[[ca.SX], ca.SX]) -> ca.SX:
    """A function of a square: its series where that is small, else its formula.

    CasADi evaluates both branches; the formula sees 1 where the series counts, so that no 0/0 arises.
    """
    small = square < NEAR
    value = ca.SX(series[-1])
    for coefficient in reversed(series[:-1]):
        value = coefficient + square * value
    return ca.if_else(small, value, formula(ca.if_else(small, 1.0, square)))


def _versine(t2: ca.SX) -> ca.SX:
    return 2.0 * ca.sin(0.5 * ca.sqrt(t2)) ** 2 / t2


def _defect(t2: ca.SX) -> ca.SX:
    t = ca.sqrt(t2)
    return (t - ca.sin(t)) / (t * t2)


def _inverse(t2: ca.SX) -> ca.SX:
    t = ca.sqrt(t2)
    return 1.0 / t2 - ca.cos(0.5 * t) / (2.0 * t * ca.sin(0.5 * t))


def _product(a: ca.SX, b: ca.SX) -> ca.SX:
    """(4,) product of quaternions (x, y, z, w)."""
    vector = a[3] * b[:3] + b[3] * a[:3] + ca.cross(a[:3], b[:3])
    return ca.vertcat(vector, a[3] * b[3] - ca.dot(a[:3], b[:3]))


def _conjugate(quaternion: ca.SX) -> ca.SX:
    return ca.vertcat(-quaternion[:3], quaternion[3])


def _normalised(quaternion: ca.SX) -> ca.SX:
    return quaternion / ca.norm_2(quaternion)
