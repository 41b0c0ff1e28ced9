"""Frames of OpenSim's models: places and turns, and chains of frames that are fixed to a body."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.io.loose_xml import Element
from mbkf.io.osim_functions import number_list

_OFFSET_PARENTS = ("socket_parent", "socket_parent_connectee_name")


def body_frame(path: str, frames: Mapping[str, Element], depth: int = 4) -> tuple[str, Array]:
    """The body that a path leads to through frames fixed to it, and the (4, 4) last frame in that body.

    Args:
        path: Path or name of a frame or body.
        frames: Frames by their name.
        depth: Number of frames that are followed.
    """
    name = path.strip().rstrip("/").rpartition("/")[2]
    frame = frames.get(name)
    if frame is None or depth == 0:
        return name, np.eye(4)
    own = placed(frame.child_text("translation"), frame.child_text("orientation"))
    body, beyond = body_frame(frame.child_text(*_OFFSET_PARENTS), frames, depth - 1)
    return body, beyond @ own


def placed(translation: str, orientation: str) -> Array:
    """(4, 4) a frame from its origin, m, and its turns about its own x, y, z in turn, rad."""
    pose = np.eye(4)
    shift, turns = vector(translation), vector(orientation)
    if shift is not None:
        pose[:3, 3] = shift
    if turns is not None:
        pose[:3, :3] = Rotation.from_euler("XYZ", turns).as_matrix()
    return pose


def vector(text: str) -> Array | None:
    """(3,) finite numbers, None where the text is not three of them."""
    found = number_list(text)
    return np.array(found) if len(found) == 3 else None
