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
    parent = model.description.segment(segment).parent
    if parent == "world":
        return np.zeros(3)
    tree, first = model.pin_model, model.joint(segment).joint_id
    while tree.parents[first] != model.joint(parent).joint_id:  # a universal joint is two hinges
        first = tree.parents[first]
    return np.array(tree.jointPlacements[first].translation)
