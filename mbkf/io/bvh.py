"""Writing a motion as BVH (Biovision hierarchy): joints with constant offsets, then a line of angles per frame.

A joint's frame is R = Rz(a) Rx(b) Ry(c) in its parent's, in the order of its channels (M. Meredith and S. Maddock,
Motion Capture File Formats Explained, University of Sheffield CS-01-11, 2001). Lengths are in cm, y is up, angles in
degrees.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, ShapeError
from mbkf.io.written import BVH_BLANKS
from mbkf.numerics.cardan import cardan_angles, follow

ROTATIONS = "Zrotation Xrotation Yrotation"
"""Channels of every joint; many programs know this order only."""

POSITIONS = "Xposition Yposition Zposition"

_ZXY = np.array([2, 0, 1])
_CM = 100.0


@dataclass(frozen=True)
class BvhJoint:
    """A joint of the tree.

    Attributes:
        name: Its name, without blanks.
        parent: Place of its parent in the list, −1 for the root.
        offset_m: (3,) its place in its parent's frame, m.
        end_m: (3,) end of a joint without children in its own frame, m; None where it has some.
    """

    name: str
    parent: int
    offset_m: Array
    end_m: Array | None = None


def bvh_text(joints: Sequence[BvhJoint], root_m: Array, rotations: Array, rate_hz: float) -> str:
    """The text of a file.

    Args:
        joints: J joints, every subtree in one piece after its parent, the root first.
        root_m: (F, 3) places of the root, m, y up.
        rotations: (F, J, 3, 3) rotation of every joint in its parent's frame, of the root in the world.
        rate_hz: Frame rate.

    Raises:
        ShapeError: The arrays do not belong to these joints.
        InvalidInput: The joints do not form such a tree, or a name holds a blank.
    """
    if rotations.shape[1:] != (len(joints), 3, 3):
        raise ShapeError("rotations", f"(F, {len(joints)}, 3, 3)", rotations.shape)
    if root_m.shape != (len(rotations), 3):
        raise ShapeError("root_m", f"({len(rotations)}, 3)", root_m.shape)
    _check_tree(joints)
    lines = ["HIERARCHY" + BVH_BLANKS, *_tree(joints, 0, 0), "MOTION", f"Frames: {len(rotations)}"]
    lines.append(f"Frame Time: {1.0 / rate_hz:.9g}")
    numbers = np.round(np.hstack([_CM * root_m, _angles_deg(rotations)]), 6) + 0.0  # no "-0.000000"
    lines += [" ".join(f"{number:.6f}" for number in row) for row in numbers.tolist()]
    return "\n".join(lines) + "\n"


def _angles_deg(rotations: Array) -> Array:
    """(F, 3 J) angles about z, x and y, continuous in time, degrees."""
    by_order = rotations[..., _ZXY[:, None], _ZXY[None, :]]
    joints = rotations.shape[1]
    followed = follow(cardan_angles(by_order, np.ones(joints)), np.ones(joints, dtype=bool))
    return np.rad2deg(followed).reshape(len(rotations), 3 * joints)


def _check_tree(joints: Sequence[BvhJoint]) -> None:
    """Depth-first with one root, so that the channels' order is the list's."""
    open_branch: list[int] = []
    for k, joint in enumerate(joints):
        if len(joint.name.split()) != 1:
            raise InvalidInput(f"'{joint.name}' cannot name a joint of a BVH file; leave blanks out")
        while open_branch and open_branch[-1] != joint.parent:
            open_branch.pop()
        if bool(open_branch) != (k > 0) or (k == 0 and joint.parent != -1):
            raise InvalidInput(f"joint {joint.name} does not follow its parent's subtree")
        open_branch.append(k)


def _tree(joints: Sequence[BvhJoint], at: int, depth: int) -> Iterator[str]:
    """The lines of a joint and of all below it."""
    joint, pad, inner = joints[at], "\t" * depth, "\t" * (depth + 1)
    yield f"{pad}{'JOINT' if depth else 'ROOT'} {joint.name}"
    yield f"{pad}{{"
    yield f"{inner}OFFSET {_triple(joint.offset_m)}"
    yield f"{inner}CHANNELS {f'3 {ROTATIONS}' if depth else f'6 {POSITIONS} {ROTATIONS}'}"
    children = [k for k, other in enumerate(joints) if other.parent == at]
    for child in children:
        yield from _tree(joints, child, depth + 1)
    if not children:
        end = np.zeros(3) if joint.end_m is None else joint.end_m
        yield from (f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET {_triple(end)}", f"{inner}}}")
    yield f"{pad}}}"


def _triple(place_m: Array) -> str:
    return " ".join(f"{_CM * number:.6f}" for number in place_m)
