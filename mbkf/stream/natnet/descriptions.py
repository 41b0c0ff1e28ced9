"""Descriptions of a NatNet stream, protocols 3.0 to 4.x: marker sets and force plates; all else is passed over.

Source: the NatNet SDK's description of its packets (NatNetTypes.h, and the sample PacketClient).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.cursor import Cursor, opened
from mbkf.stream.natnet.frames import SIZED
from mbkf.stream.natnet.packets import ForcePlate
from mbkf.stream.natnet.server import Version

NAMED_BODIES: Version = (4, 0)
"""From this protocol on the markers of a rigid body have names."""

_KIND = struct.Struct("<2I")
_FLOAT = np.dtype("<f4")


@dataclass(frozen=True)
class MarkerSet:
    """A set of named markers.

    Attributes:
        name: Its name.
        markers: Names of its markers, in the order of their positions in a frame.
    """

    name: str
    markers: tuple[str, ...]


@dataclass(frozen=True)
class Descriptions:
    """Contents of a stream.

    Attributes:
        sets: Its marker sets.
        plates: Its force plates.
    """

    sets: tuple[MarkerSet, ...]
    plates: tuple[ForcePlate, ...]


def read_descriptions(packet: bytes, version: Version) -> Descriptions:
    """Reads a whole packet.

    Raises:
        InvalidPacket: It does not fit its own lengths, or has a part of unknown kind and size.
    """
    cursor = opened(packet)[1]
    sized = version >= SIZED
    sets: list[MarkerSet] = []
    plates: list[ForcePlate] = []
    for _ in range(cursor.count(8 if sized else 4)):
        kind = cursor.integer()
        end = cursor.part() if sized else -1
        if kind == packets.SET_DESCRIPTION:
            sets.append(_marker_set(cursor))
        elif kind == packets.PLATE_DESCRIPTION:
            plates.append(_force_plate(cursor))
        elif not sized:
            passing = _PASSED_OVER.get(kind)
            if passing is None:
                raise InvalidPacket(f"NatNet: the stream describes something of unknown kind {kind}")
            passing(cursor, version)
        if sized:
            cursor.leave(end)
    return Descriptions(tuple(sets), tuple(plates))


def _marker_set(cursor: Cursor) -> MarkerSet:
    name = cursor.text()
    return MarkerSet(name, _texts(cursor))


def _force_plate(cursor: Cursor) -> ForcePlate:
    number, serial = cursor.integer(), cursor.text()
    cursor.take(2 * _FLOAT.itemsize)  # width and length
    offset = cursor.rows(_FLOAT, 3)
    cursor.take(144 * _FLOAT.itemsize)  # calibration matrix
    corners = cursor.points(4)
    _, data = cursor.fields(_KIND)
    with np.errstate(invalid="ignore"):  # numbers of a server may be NaN
        geometry = offset.astype(float), corners.astype(float)
    return ForcePlate(number, serial, *geometry, data != 0, _texts(cursor))


def _texts(cursor: Cursor) -> tuple[str, ...]:
    return tuple([cursor.text() for _ in range(cursor.count(1))])


def _rigid_body(cursor: Cursor, version: Version) -> None:
    cursor.text()
    cursor.take(20)  # number, parent, offset
    count = cursor.count(16)
    cursor.take(16 * count)  # positions and labels of its markers
    if version >= NAMED_BODIES:
        cursor.skip_texts(count)


def _skeleton(cursor: Cursor, version: Version) -> None:
    cursor.text()
    cursor.take(4)
    for _ in range(cursor.count(25)):
        _rigid_body(cursor, version)


def _device(cursor: Cursor, version: Version) -> None:
    del version
    cursor.take(4)
    cursor.skip_texts(2)
    cursor.take(8)
    cursor.skip_texts(cursor.count(1))


def _camera(cursor: Cursor, version: Version) -> None:
    del version
    cursor.text()
    cursor.take(28)


_PASSED_OVER: dict[int, Callable[[Cursor, Version], None]] = {
    1: _rigid_body,
    2: _skeleton,
    4: _device,
    5: _camera,
}
"""Descriptions to pass over before sizes are sent, by the number of their kind."""
