"""Objects of Vicon's DataStream: blocks of a type, a length and fields, little endian; packets are blocks of blocks.

Every length and count is checked against the block's end before anything is read.

Source: headers ViconCGStream of Vicon's DataStream SDK 1.11 (MIT), which lay out each object.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidPacket
from mbkf.stream.cursor import PacketCursor

PACKET = 0x1A2B0001
"""Type of the block that holds all others."""

OBJECT_ENUMS, REQUEST_FRAME, CONTENTS = 100001, 100002, 100004
STREAM_INFO, SUBJECT_INFO, DEVICE_INFO, CHANNEL_INFO, FRAME_INFO = 1, 2, 3, 4, 5
LABELED, UNLABELED, FORCE, MOMENT, CENTRE_OF_PRESSURE = 6, 7, 10, 11, 12
PLATE_INFO, APPLICATION_INFO, DEVICE_INFO_EXTRA = 20, 37, 38

STATIC = (
    STREAM_INFO,
    SUBJECT_INFO,
    DEVICE_INFO,
    DEVICE_INFO_EXTRA,
    CHANNEL_INFO,
    PLATE_INFO,
    APPLICATION_INFO,
)
"""Types that are sent when they change."""

WANTED = (*STATIC, CONTENTS, FRAME_INFO, LABELED, UNLABELED, FORCE, MOMENT, CENTRE_OF_PRESSURE)
"""Types that are asked for."""

HEADER = struct.Struct("<II")
LARGEST = 16 * 1024 * 1024
"""A packet that claims more bytes is not one."""

MOST_SAMPLES = 20_000
"""Samples of a plate in one packet, at most: a fifth of a second at the highest rate of plates that is read."""

_F4 = np.dtype("<f4")
_U32, _U64 = struct.Struct("<I"), struct.Struct("<Q")
_POINT = np.dtype([("radius", "<f8"), ("place", "<f8", (3,)), ("covariance", "<f8", (9,)), ("track", "<u4")])
_MARKER = np.dtype([("ids", "<u4", (2,)), *_POINT.descr])


@dataclass(frozen=True)
class Subject:
    """A subject: its ID, name, and markers by ID."""

    number: int
    name: str
    markers: dict[int, str]


@dataclass(frozen=True)
class Plate:
    """Where a plate lies.

    Attributes:
        device: Its ID.
        translation_mm: (3,) its origin in Vicon's world.
        rotation: (3, 3) from its axes to the world's.
        bounds_mm: (2, 3) least and largest coordinates of its box, in its axes about its origin.
        sensor_mm: (3,) point of its transducers, likewise.
    """

    device: int
    translation_mm: Array
    rotation: Array
    bounds_mm: Array
    sensor_mm: Array


@dataclass(frozen=True)
class DeviceSamples:
    """A frame of a device's channel: count of its own frames, and samples (n, 3)."""

    frame: int
    device: int
    values: NDArray[np.float32]


class Fields(PacketCursor):
    """Reads a block without its header from front to back."""

    __slots__ = ()

    protocol: ClassVar[str] = "Vicon"

    def __init__(self, data: bytes) -> None:
        """Args: the block without its header."""
        super().__init__(data, 0, len(data))

    def long_integer(self) -> int:
        """An unsigned integer of eight bytes."""
        return int(self.fields(_U64)[0])

    def text(self) -> str:
        """Text behind its length; bytes that are not UTF-8 are replaced."""
        size = self.integer()
        at = self.take(size)
        return self.data[at : at + size].decode("utf-8", "replace")

    def floats(self, count: int) -> Array:
        """(count,) numbers of four bytes."""
        return self.rows(np.dtype("<f4"), count).astype(float)


def block(kind: int, data: bytes) -> bytes:
    """A block with its header."""
    return HEADER.pack(kind, len(data)) + data


def packet(*blocks: bytes) -> bytes:
    """A packet of blocks."""
    return block(PACKET, b"".join(blocks))


def enums(kinds: tuple[int, ...]) -> bytes:
    """The block that lists types of objects."""
    return block(OBJECT_ENUMS, _U32.pack(len(kinds)) + b"".join(map(_U32.pack, sorted(kinds))))


def request(streaming: bool) -> bytes:
    """The packet that asks for all frames from here on, or for a single one."""
    return packet(block(REQUEST_FRAME, bytes([streaming])))


def blocks(payload: bytes) -> dict[int, list[bytes]]:
    """Blocks of a packet by type, in order.

    Raises:
        InvalidPacket: A block is cut off.
    """
    found: dict[int, list[bytes]] = {}
    at = 0
    while at < len(payload):
        if len(payload) - at < HEADER.size:
            raise InvalidPacket("Vicon: an object is cut off")
        kind, size = HEADER.unpack_from(payload, at)
        at += HEADER.size
        if size > len(payload) - at:
            raise InvalidPacket(f"Vicon: an object of {size} bytes where {len(payload) - at} are left")
        found.setdefault(kind, []).append(payload[at : at + size])
        at += size
    return found


def read_numbers(data: bytes) -> tuple[int, ...]:
    """A list of whole numbers, as types of objects are."""
    fields = Fields(data)
    return tuple(int(one) for one in fields.rows(np.dtype("<u4"), fields.count(4)))


def read_unchanged(data: bytes) -> tuple[int, ...]:
    """Types that a packet leaves out since they have not changed."""
    fields = Fields(data)
    fields.rows(np.dtype(("<u4", (2,))), fields.count(8))
    return tuple(int(one) for one in fields.rows(np.dtype("<u4"), fields.count(4)))


def read_subject(data: bytes) -> Subject:
    """A subject; its segments are left out."""
    fields = Fields(data)
    number, name = fields.integer(), fields.text()
    for _ in range(fields.count(36)):
        fields.rows(np.dtype("V32"), 1)
        fields.text()
    markers = {}
    for _ in range(fields.count(8)):
        marker = fields.integer()
        markers[marker] = fields.text()
    return Subject(number, name, markers)


def read_device(data: bytes) -> tuple[int, int]:
    """ID of a device, and the ticks of one of its frames, or that of its first frame."""
    fields = Fields(data)
    return fields.integer(), fields.long_integer()


def read_channel(data: bytes) -> tuple[int, int, tuple[str, ...]]:
    """IDs of a device and a channel, and the names of the channel's components."""
    fields = Fields(data)
    device, channel = fields.integer(), fields.integer()
    fields.text()
    return device, channel, tuple(fields.text() for _ in range(fields.count(4)))


def read_plate(data: bytes) -> Plate:
    """Where a plate lies."""
    fields = Fields(data)
    device, translation, rotation = fields.integer(), fields.floats(3), fields.floats(9).reshape(3, 3)
    return Plate(device, translation, rotation, fields.floats(6).reshape(2, 3), fields.floats(3))


def read_markers(data: bytes) -> tuple[NDArray[np.uint32], Array]:
    """(N, 2) IDs of subjects and markers, and (N, 3) their places, mm."""
    fields = Fields(data)
    rows = fields.rows(_MARKER, fields.count(_MARKER.itemsize))
    return rows["ids"], rows["place"]


def read_points(data: bytes) -> Array:
    """(N, 3) points without names, mm."""
    fields = Fields(data)
    return np.array(fields.rows(_POINT, fields.count(_POINT.itemsize))["place"])


def read_samples(data: bytes) -> DeviceSamples:
    """Samples of a channel of three components, which follow one after the other.

    Raises:
        InvalidPacket: Their number is not one of triples, or too large.
    """
    fields = Fields(data)
    frame, device, _ = fields.integer(), fields.integer(), fields.integer()
    values = fields.rows(_F4, fields.count(4))
    if len(values) % 3 or len(values) > 3 * MOST_SAMPLES:
        raise InvalidPacket(
            f"Vicon: {len(values)} numbers are not samples of three components, or more than {MOST_SAMPLES}"
        )
    return DeviceSamples(frame, device, values.reshape(3, -1).T)
