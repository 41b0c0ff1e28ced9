"""Frames of NatNet, protocols 3.0 to 4.x, read without a loop over markers.

Markers stay views of the packet. Rigid bodies, skeletons, assets and devices are passed over: by the size that
protocols from 4.1 on send in front of each part, else by the layout of their fields.

Source: the NatNet SDK's description of its packets (NatNetTypes.h, and the sample PacketClient).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.stream.natnet import packets
from mbkf.stream.natnet.cursor import Cursor, opened
from mbkf.stream.natnet.server import Version

SIZED: Version = (4, 1)
"""From this protocol on the size of each part is sent."""

MODELS_CHANGED = 2
"""Bit of a frame's parameters: what the stream describes has changed."""

_END = struct.Struct("<HI")
"""The last fields of a frame: its parameters, and the end of data."""

_RIGID_BODY_BYTES = 38
_SUFFIX, _FIRST_PLATE = struct.Struct("<2Id"), struct.Struct("<3I")
_COUNT, _FLOAT = np.dtype("<u4"), np.dtype("<f4")
_UNLABELLED = np.zeros(0, dtype=packets.LABELLED)


class Plates(NamedTuple):
    """Samples of a frame's force plates.

    Attributes:
        numbers: The plates' numbers.
        samples: (C, m) samples of each plate's channels; one array (K, C, m) where all plates have equally many.
    """

    numbers: list[int]
    samples: Sequence[NDArray[np.float32]] | NDArray[np.float32]


class Frame(NamedTuple):
    """One frame, in the stream's axes, m.

    Attributes:
        number: As the server counts.
        time_s: On the server's clock.
        sets: (n, 3) positions of each set's markers, by the set's name.
        points: (N, 3) points without names.
        labelled: (L,) labelled markers, as :data:`mbkf.stream.natnet.packets.LABELLED`.
        plates: The force plates' samples.
        changed: The server states that its list of tracked models has changed.
    """

    number: int
    time_s: float
    sets: dict[str, NDArray[np.float32]]
    points: NDArray[np.float32]
    labelled: NDArray[np.void]
    plates: Plates
    changed: bool = False


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
    count, end = _begin(cursor, 8, sized)
    plates = _plates(cursor, count)
    _finish(cursor, end)
    if sized:
        _pass_over(cursor)  # devices
    else:
        for _ in range(cursor.count(8)):
            cursor.take(4)
            _channels(cursor)
    time_s = float(cursor.fields(_SUFFIX)[2])
    at = cursor.end - _END.size  # the fields between differ between protocols
    changed = at >= cursor.at and bool(_END.unpack_from(packet, at)[0] & MODELS_CHANGED)
    return Frame(number, time_s, sets, points, labelled, plates, changed)


def _begin(cursor: Cursor, least: int, sized: bool) -> tuple[int, int]:
    """Number of things in a part, of which each takes at least so many bytes, and where it ends; −1 where not sent."""
    return cursor.sized_count(least) if sized else (cursor.count(least), -1)


def _finish(cursor: Cursor, end: int) -> None:
    if end >= 0:
        cursor.leave(end)


def _pass_over(cursor: Cursor) -> None:
    cursor.take(4)
    cursor.leave(cursor.part())


def _plates(cursor: Cursor, count: int) -> Plates:
    """Samples of so many plates: at once where all have as many channels and samples as the first, else one by one."""
    begin = cursor.at
    if count and cursor.end - begin >= _FIRST_PLATE.size:
        _, channels, each = _FIRST_PLATE.unpack_from(cursor.data, begin)
        size = count * (2 + channels * (1 + each))
        if channels and 4 * size <= cursor.end - begin:
            words = np.frombuffer(cursor.data, _COUNT, size, begin).reshape(count, -1)
            cells = words[:, 2:].reshape(count, channels, 1 + each)
            if (words[:, 1] == channels).all() and (cells[:, :, 0] == each).all():
                cursor.take(4 * size)
                return Plates(words[:, 0].tolist(), cells[:, :, 1:].view(_FLOAT))
    one_by_one = [(cursor.integer(), _channels(cursor)) for _ in range(count)]
    return Plates([number for number, _ in one_by_one], [samples for _, samples in one_by_one])


def _channels(cursor: Cursor) -> NDArray[np.float32]:
    """(C, m) samples of a plate or device; (0, 0) where its channels have different numbers of samples."""
    channels = [cursor.rows(_FLOAT, cursor.integer()) for _ in range(cursor.count(4))]
    if not channels or any(len(one) != len(channels[0]) for one in channels):
        return np.zeros((0, 0), dtype=_FLOAT)
    return np.array(channels)
