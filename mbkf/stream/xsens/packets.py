"""Datagrams of Xsens MVN's network streaming: a header of 24 bytes and one item per segment or tracker, big endian.

Every length is checked against the datagram's end before anything is read.

Source: Xsens, MVN real-time network streaming Protocol Specification, revision N, sections 2.4 to 2.7 and 3.1.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidPacket

DEFAULT_PORT = 9763
"""Port at which MVN sends unless another one is stated in it."""

POSES, TRACKERS = 2, 23
"""Types that are read: position and quaternion of segments; quaternion, free acceleration and field of trackers."""

HEADER = struct.Struct(">6sIBBIBBBBHH")
LAST = 0x80
"""Bit of the datagram counter that marks the last part of a sample."""

WIDTHS = {POSES: (32,), TRACKERS: (44, 68)}
"""Bytes of an item; trackers had 68 before June 2018, with their own acceleration and angular velocity between."""

SEGMENTS = {
    1: "pelvis", 5: "torso", 7: "head",
    9: "right_upper_arm", 10: "right_forearm", 11: "right_hand",
    13: "left_upper_arm", 14: "left_forearm", 15: "left_hand",
    16: "right_thigh", 17: "right_shank", 18: "right_foot",
    20: "left_thigh", 21: "left_shank", 22: "left_foot",
}  # fmt: skip
"""MVN's segments that are taken, by ID: T8 for the torso; its further parts of the trunk, shoulders and toes are left
out, as are props and fingers."""


@dataclass(frozen=True)
class MvnDatagram:
    """A datagram.

    Attributes:
        kind: Type of its data.
        sample: Count of the sample.
        part: Number of this part of the sample, from 0.
        last: Whether it is the last part.
        items: Number of items in it.
        time_ms: MVN's clock, ms from the beginning of the recording.
        character: ID of the person.
        payload: The items.
    """

    kind: int
    sample: int
    part: int
    last: bool
    items: int
    time_ms: int
    character: int
    payload: bytes


def read_datagram(data: bytes) -> MvnDatagram:
    """A datagram of any type.

    Raises:
        InvalidPacket: It is another program's, or cut off.
    """
    if len(data) < HEADER.size:
        raise InvalidPacket(f"MVN: a datagram of {len(data)} bytes")
    name, sample, counter, items, time_ms, character, *_, size = HEADER.unpack_from(data)
    if name[:4] != b"MXTP" or not name[4:].isdigit():
        raise InvalidPacket(f"MVN: a datagram begins with {name!r}")
    left = len(data) - HEADER.size
    if size > left:
        raise InvalidPacket(f"MVN: {size} bytes are stated where {left} follow")
    payload = data[HEADER.size : HEADER.size + (size or left)]  # versions before 2019 state no size
    return MvnDatagram(
        int(name[4:]), sample, counter & ~LAST, bool(counter & LAST), items, time_ms, character, payload
    )


def read_items(one: MvnDatagram) -> tuple[NDArray[np.int64], Array]:
    """(n,) IDs and (n, w) numbers of the items of a datagram of :data:`WIDTHS`.

    Of poses: x, y, z and the quaternion w, x, y, z. Of trackers: the quaternion, free acceleration in the world m/s²,
    and what follows.

    Raises:
        InvalidPacket: The items do not fill it.
    """
    widths = WIDTHS[one.kind]
    fitting = [width for width in widths if one.items * width == len(one.payload)]
    if not one.items or not fitting:
        raise InvalidPacket(f"MVN: {one.items} items of type {one.kind:02d} in {len(one.payload)} bytes")
    layout = np.dtype([("id", ">u4"), ("values", ">f4", (fitting[0] // 4 - 1,))])
    rows = np.frombuffer(one.payload, layout, one.items)
    with np.errstate(invalid="ignore"):  # NaN of any kind
        return rows["id"].astype(np.int64), rows["values"].astype(float)
