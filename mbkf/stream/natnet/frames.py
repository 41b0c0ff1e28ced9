"""Frames of NatNet, protocols 3.0 to 4.x, read without a loop over markers.

Markers stay views of the packet. Rigid bodies, skeletons, assets and devices are passed over: by the size that
protocols from 4.1 on send in front of each part, else by the layout of their fields.

Source: the NatNet SDK's description of its packets (NatNetTypes.h, and the sample PacketClient).
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.stream.natnet import packets
from mbkf.stream.natnet.cursor import Cursor, opened
from mbkf.stream.natnet.server import Version

SIZED: Version = (4, 1)
"""From this protocol on the size of each part is sent."""

_RIGID_BODY_BYTES = 38
_SUFFIX = struct.Struct("<2Id")
_COUNT, _FLOAT = np.dtype("<u4"), np.dtype("<f4")
_UNLABELLED = np.zeros(0, dtype=packets.LABELLED)


class Frame(NamedTuple):
    """One frame, in the stream's axes, m.

    Attributes:
        number: As the server counts.
        time_s: On the server's clock.
        sets: (n, 3) positions of each set's markers, by the set's name.
        points: (N, 3) points without names.
        labelled: (L,) labelled markers, as :data:`mbkf.stream.natnet.packets.LABELLED`.
        plates: (C, m) samples of each plate's channels, by the plate's number.
    """

    number: int
    time_s: float
    sets: dict[str, NDArray[np.float32]]
    points: NDArray[np.float32]
    labelled: NDArray[np.void]
    plates: dict[int, NDArray[np.float32]]


def read_frame(packet: bytes, version: Version) -> Frame:
    """Reads a whole packet.

    Raises:
        InvalidPacket: It does not fit its own lengths.
    """
    cursor = opened(packet)[1]
    sized = version >= SIZED
    number = cursor.integer()
    sets: dict[str, NDArray[np.float32]] = {}
    count, end = _begin(cursor, 5, sized)
    for _ in range(count):
        name = cursor.text()
        sets[name] = cursor.points(cursor.integer())
    _finish(cursor, end)
    count, end = _begin(cursor, 12, sized)
    points = cursor.points(count) if count else packets.NO_POINTS
    _finish(cursor, end)
    if sized:
        for _ in range(3):  # rigid bodies, skeletons, assets
            _pass_over(cursor)
    else:
        cursor.take(_RIGID_BODY_BYTES * cursor.integer())
        for _ in range(cursor.count(8)):  # skeletons
            cursor.take(4)
            cursor.take(_RIGID_BODY_BYTES * cursor.integer())
    count, end = _begin(cursor, packets.LABELLED.itemsize, sized)
    labelled = cursor.rows(packets.LABELLED, count) if count else _UNLABELLED
    _finish(cursor, end)
    plates: dict[int, NDArray[np.float32]] = {}
    count, end = _begin(cursor, 8, sized)
    for _ in range(count):
        identity = cursor.integer()
        plates[identity] = _channels(cursor)
    _finish(cursor, end)
    if sized:
        _pass_over(cursor)  # devices
    else:
        for _ in range(cursor.count(8)):
            cursor.take(4)
            _channels(cursor)
    time_s = float(cursor.fields(_SUFFIX)[2])
    return Frame(number, time_s, sets, points, labelled, plates)


def _begin(cursor: Cursor, least: int, sized: bool) -> tuple[int, int]:
    """Number of things in a part, of which each takes at least so many bytes, and where it ends; −1 where not sent."""
    return cursor.sized_count(least) if sized else (cursor.count(least), -1)


def _finish(cursor: Cursor, end: int) -> None:
    if end >= 0:
        cursor.leave(end)


def _pass_over(cursor: Cursor) -> None:
    cursor.take(4)
    cursor.leave(cursor.part())


def _channels(cursor: Cursor) -> NDArray[np.float32]:
    """(C, m) samples of a plate or device; (0, 0) where its channels have different numbers of samples."""
    count = cursor.count(4)
    if not count:
        return np.zeros((0, 0), dtype=_FLOAT)
    begin = cursor.at
    each = cursor.integer() + 1
    cursor.at = begin
    if count * each * 4 <= cursor.end - begin:
        cells = np.frombuffer(cursor.data, _COUNT, count * each, begin).reshape(count, each)
        if cells[:, 0].tolist() == [each - 1] * count:
            cursor.take(count * each * 4)
            return cells[:, 1:].view(_FLOAT)
    for _ in range(count):
        cursor.take(4 * cursor.integer())
    return np.zeros((0, 0), dtype=_FLOAT)
