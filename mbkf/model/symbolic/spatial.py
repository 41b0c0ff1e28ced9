"""Spatial algebra in CasADi: motions and forces as columns (linear, angular), in the order of Pinocchio.

A transform of a frame is its rotation R (3, 3) and its origin p (3,) in the frame before: x_before = R x + p.
R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 2.
"""

from __future__ import annotations

import casadi as ca

from mbkf.conventions import Array


def constant(values: Array) -> ca.SX:
    """Numbers as an expression; zeros are structural, so that products with them vanish."""
    return ca.SX(ca.sparsify(ca.DM(values)))


def motion_transform(rotation: ca.SX, origin: ca.SX) -> ca.SX:
    """X (6, 6) from a motion in the frame before to the same motion in a frame; forces return by Xᵀ."""
    turn = rotation.T
    return ca.blockcat([[turn, -turn @ ca.skew(origin)], [ca.SX(3, 3), turn]])


def motion_cross(velocity: ca.SX) -> ca.SX:
    """(6, 6) v ×: rate of a motion that is carried along with the velocity v (6,). On forces v ×* is −(v ×)ᵀ."""
    linear, angular = ca.skew(velocity[:3]), ca.skew(velocity[3:])
    return ca.blockcat([[angular, linear], [ca.SX(3, 3), angular]])


def rotation_of(quaternion: ca.SX) -> ca.SX:
    """R (3, 3) of a unit quaternion (x, y, z, w)."""
    x, y, z, w = ca.vertsplit(quaternion)
    return ca.blockcat(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_about(axis: Array, angle: ca.SX) -> ca.SX:
    """R (3, 3) of a turn by an angle, rad, about a unit axis (3,)."""
    a = constant(axis)
    along = a @ a.T
    return along + ca.cos(angle) * (ca.SX.eye(3) - along) + ca.sin(angle) * ca.skew(a)
