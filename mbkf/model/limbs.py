"""Limbs of a body: chains of segments that have a side, from the first one that hangs on a segment without a side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.model.body import Body, SegmentJoint
from mbkf.model.sides import mirrored


@dataclass(frozen=True)
class Limb:
    """A leg or an arm.

    Attributes:
        name: Its first segment.
        joints: Joints of its segments, the first one first.
        dofs: (n,) their dofs in the tangent space.
    """

    name: str
    joints: tuple[SegmentJoint, ...]
    dofs: NDArray[np.intp]

    @property
    def other_side(self) -> str:
        """Name of the same limb of the other side."""
        return mirrored(self.name)


def limbs(model: Body) -> tuple[Limb, ...]:
    """The limbs of a body, in the order of its joints; empty for a body whose segments have no sides."""
    found = []
    for segment in model.description.segments:
        parent = segment.parent or ""
        if mirrored(segment.name) == segment.name or mirrored(parent) != parent:
            continue
        first = model.joints[segment.name].v.start
        joints = tuple(one for one in model.joints.values() if model.supports[one.joint_id, first])
        dofs = np.concatenate([np.arange(one.v.start, one.v.stop) for one in joints])
        found.append(Limb(segment.name, joints, dofs))
    return tuple(found)
