"""A result as animation programs take it: y up, z forward, a tree of joints, and every frame with a pose.

Animation's axes (glTF 2.0 specification, section 3.3): x to the person's left, y up, z forward, where mbkf has x
forward, y left, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel
from mbkf.model.skeleton import joint_origin

TO_ANIMATION = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Takes vectors from mbkf's axes to those of animation programs."""


@dataclass(frozen=True)
class AnimatedBody:
    """A moving body in the axes of animation programs; its joints stay where they are on their segments.

    Attributes:
        model: The body.
        names: S segments, depth-first, the root first.
        parents: (S,) place of each segment's parent, −1 for the root.
        offsets_m: (S, 3) place of each segment's joint in its parent's frame; of the root 0.
        root_m: (F, 3) places of the root.
        rotations: (F, S, 3, 3) rotation of each segment in its parent's frame, of the root in the world.
    """

    model: HumanModel
    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets_m: Array
    root_m: Array
    rotations: Array


def animated_body(r: Reconstruction, rows: NDArray[np.intp]) -> AnimatedBody:
    """The body of a result in some of its frames.

    Args:
        r: The result.
        rows: (F,) the frames, in all of which the body is followed.

    Raises:
        UnknownName: The subject's body is unknown.
    """
    model = HumanModel.of(r.subject)
    names = tuple(model.joints)
    segments = [model.description.segment(name) for name in names]
    parents = tuple(-1 if s.parent == "world" else names.index(s.parent) for s in segments)
    offsets = np.zeros((len(names), 3))
    for k, parent in enumerate(parents):
        if parent >= 0:
            offsets[k] = joint_origin(model, segments[k].name)
    ids = [joint.joint_id for joint in model.joints.values()]
    world = np.empty((len(rows), len(names), 3, 3))
    root = np.empty((len(rows), 3))
    for f, row in enumerate(rows):
        R, origins = model.placements(r.q[row])
        world[f], root[f] = R[ids], origins[ids[0]]
    inside = world.copy()
    for k, parent in enumerate(parents):
        if parent >= 0:
            inside[:, k] = world[:, parent].transpose(0, 2, 1) @ world[:, k]
    C = TO_ANIMATION
    return AnimatedBody(model, names, parents, offsets @ C.T, root @ C.T, C @ inside @ C.T)


def held_rows(rows: NDArray[np.intp], tracked: BoolArray) -> NDArray[np.intp]:
    """(F,) the rows to show: the latest one in which the body is followed, before the first one that first one.

    Args:
        rows: (F,) row of every frame, −1 where a frame is lost.
        tracked: (T,) rows in which the body is followed.

    Raises:
        InvalidInput: The body is followed in no frame.
    """
    known = (rows >= 0) & tracked[rows] if len(rows) else np.zeros(0, dtype=bool)
    if not known.any():
        raise InvalidInput("the body is followed in no frame of this result, so no motion can be exported")
    latest = np.maximum.accumulate(np.where(known, np.arange(len(rows)), -1))
    return np.asarray(rows[np.where(latest < 0, int(np.argmax(known)), latest)])
