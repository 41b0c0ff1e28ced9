"""Orthonormal axes from two directions, as anatomical frames and plates are defined."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array


def axes_from(first: str, along: Array, second: str, near: Array) -> Array:
    """(3, 3) right-handed axes as columns: one along a direction, another as near to a second direction as can be.

    Args:
        first: Axis that is given exactly, "x", "y" or "z".
        along: (3,) its direction, of any length.
        second: Axis that lies in the plane of both directions.
        near: (3,) direction that it is near to.
    """
    i, j = "xyz".index(first), "xyz".index(second)
    sense = 1.0 if (j - i) % 3 == 1 else -1.0
    one = along / np.linalg.norm(along)
    third = sense * np.cross(one, near)
    third /= np.linalg.norm(third)
    axes = np.empty((3, 3))
    axes[:, i], axes[:, 3 - i - j], axes[:, j] = one, third, sense * np.cross(third, one)
    return axes
