"""Places of a scaled body's joints: the lengths with which other programs build the same skeleton."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body


def joint_origin(model: Body, segment: str) -> Array:
    """(3,) a segment's proximal joint in its parent's frame, m; zero for the root.

    Raises:
        UnknownName: The segment does not exist.
    """
    own = model.description.segment(segment)
    if own.parent == "world":
        return np.zeros(3)
    return model.axis_scale(model.description.segment(own.parent)) * own.origin_m
