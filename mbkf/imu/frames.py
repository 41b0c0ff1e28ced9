"""World frames of inertial work (ENU, NED, NWU), quaternion algebra, and the attitude that two vectors give.

Filters work in NWU (x to magnetic north, y west, z up), whose z agrees with mbkf's world; results are turned into
the frame that was asked for. Quaternions (x, y, z, w) rotate sensor vectors into the world.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.numerics.cardan import quaternion_matrices

_HALF = np.sqrt(0.5)

FRAMES: dict[str, Array] = {
    "NWU": np.array([0.0, 0.0, 0.0, 1.0]),
    "ENU": np.array([0.0, 0.0, _HALF, _HALF]),
    "NED": np.array([1.0, 0.0, 0.0, 0.0]),
}
"""Per frame the quaternion that takes coordinates in NWU to coordinates in it: a vector keeps its place in space."""


def multiply(a: Array, b: Array) -> Array:
    """(…, 4) Hamilton product a ⊗ b: the rotation b, then a."""
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    product[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    product[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return product


def conjugate(q: Array) -> Array:
    """(…, 4) the inverse of unit quaternions."""
    return q * np.array([-1.0, -1.0, -1.0, 1.0])


def exponential(rotation: Array) -> Array:
    """(…, 4) quaternions of rotation vectors (…, 3), rad."""
    half = 0.5 * np.sqrt((rotation * rotation).sum(axis=-1, keepdims=True))
    return np.concatenate([0.5 * np.sinc(half / np.pi) * rotation, np.cos(half)], axis=-1)


def rotate(q: Array, vectors: Array) -> Array:
    """(…, 3) vectors turned by unit quaternions (…, 4)."""
    return (quaternion_matrices(q) @ vectors[..., None])[..., 0]


def change_frame(q: Array, source: str, target: str) -> Array:
    """(…, 4) the same orientations of a sensor in another world frame.

    Args:
        q: (…, 4) orientations sensor → source.
        source: Name of the world frame they refer to.
        target: Name of the wanted one.

    Raises:
        UnknownName: A frame is none of :data:`FRAMES`.
    """
    for name in (source, target):
        if name not in FRAMES:
            raise UnknownName("world frame", name, FRAMES)
    return multiply(multiply(FRAMES[target], conjugate(FRAMES[source])), q)


def attitude(specific_force: Array, magnetic_field: Array | None = None) -> Array:
    """(…, 4) orientation in NWU that explains a specific force, and a field, of a sensor at rest.

    Up is the specific force, north the horizontal part of the field (Black 1964, triad). Without a field the sensor
    is turned to the level by the shortest way, its heading kept.

    Args:
        specific_force: (…, 3) any unit.
        magnetic_field: (…, 3) any unit, or None.
    """
    up = _unit(specific_force)
    if magnetic_field is None:
        x, y, z = np.moveaxis(up, -1, 0)
        zero = np.zeros_like(x)
        over = np.stack([y, -x, zero, 1.0 + z], axis=-1)
        upside_down = np.stack([zero + 1.0, zero, zero, zero], axis=-1)
        return _unit(np.where((z < -1.0 + 1e-9)[..., None], upside_down, over))
    west = _unit(np.cross(up, magnetic_field))
    return matrix_quaternion(np.stack([np.cross(west, up), west, up], axis=-2))


def matrix_quaternion(R: Array) -> Array:
    """(…, 4) unit quaternions with w ≥ 0 of rotation matrices (…, 3, 3)."""
    # One row each for x, y, z or w being largest: the row whose own component is safely away from 0 (Shepperd 1978).
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    s, d = R + np.swapaxes(R, -1, -2), R - np.swapaxes(R, -1, -2)
    p, q, r = d[..., 2, 1], d[..., 0, 2], d[..., 1, 0]
    xy, xz, yz = s[..., 0, 1], s[..., 0, 2], s[..., 1, 2]
    rows = np.stack(
        [
            np.stack([1 + xx - yy - zz, xy, xz, p], axis=-1),
            np.stack([xy, 1 - xx + yy - zz, yz, q], axis=-1),
            np.stack([xz, yz, 1 - xx - yy + zz, r], axis=-1),
            np.stack([p, q, r, 1 + xx + yy + zz], axis=-1),
        ],
        axis=-2,
    )
    largest = np.diagonal(rows, axis1=-2, axis2=-1).argmax(axis=-1)
    found = np.take_along_axis(rows, largest[..., None, None], axis=-2)[..., 0, :]
    return _unit(np.where(found[..., 3:] < 0.0, -found, found))


def _unit(vectors: Array) -> Array:
    return vectors / np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
