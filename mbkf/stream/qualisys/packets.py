"""Packets of QTM's real-time protocol: a header of size and type, little endian; frames of data in components.

Every length is checked against the packet's end before anything is read.

Source: QTM Real-time Server Protocol Documentation 1.25 (Qualisys), sections Protocol structure and Data packet.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import InvalidPacket

ERROR, COMMAND, XML, DATA, NO_DATA, EVENT, DISCOVER = 0, 1, 2, 3, 4, 6, 7
"""Types of packets."""

MARKERS, POINTS, FORCE, MARKERS_RESIDUAL, POINTS_RESIDUAL = 1, 2, 4, 9, 10
"""Types of components that are read; others are skipped by their size."""

HEADER = struct.Struct("<II")
LARGEST = 16 * 1024 * 1024
"""A packet that claims more bytes is not one."""

MOST_COMPONENTS = 64

MOST_SAMPLES = 20_000
"""Samples of a plate in one packet, at most: a fifth of a second at the highest rate of plates that is read."""

_FRAME, _PART = struct.Struct("<QII"), struct.Struct("<II")
_COUNT, _PLATE = struct.Struct("<I"), struct.Struct("<III")
_FLOATS = {MARKERS: 3, POINTS: 4, MARKERS_RESIDUAL: 4, POINTS_RESIDUAL: 5}
"""Numbers of four bytes per point; the first three are its coordinates."""

_WITH_RESIDUAL = (MARKERS_RESIDUAL, POINTS_RESIDUAL)
"""Components whose last number of a point is its residual, mm."""

FORCE_NUMBERS = 9
"""Force N, moment N m and point of application mm."""


class PlateForces(NamedTuple):
    """Samples of one plate.

    Attributes:
        plate: Its ID.
        first: Number of the first sample.
        samples: (S, 9) force, moment and point of application.
    """

    plate: int
    first: int
    samples: NDArray[np.float32]


class DataFrame(NamedTuple):
    """A data packet.

    Attributes:
        number: Of the frame.
        time_us: Microseconds from the start.
        points: (N, 3) coordinates by type of component.
        residuals: (N,) residuals by type of component, where it has them.
        forces: Samples by plate; None where the packet holds no component of forces.
    """

    number: int
    time_us: int
    points: Mapping[int, NDArray[np.float32]]
    residuals: Mapping[int, NDArray[np.float32]]
    forces: tuple[PlateForces, ...] | None


def packet(kind: int, payload: bytes) -> bytes:
    """A packet with its header."""
    return HEADER.pack(HEADER.size + len(payload), kind) + payload


def text_of(payload: bytes) -> str:
    """The text of a command, an error or XML, without the nought at its end."""
    return payload.rstrip(b"\0").decode("utf-8", "replace")


def read_frame(payload: bytes) -> DataFrame:
    """The components of a data packet, header not included.

    Raises:
        InvalidPacket: It does not hold what its counts state.
    """
    if len(payload) < _FRAME.size:
        raise InvalidPacket(f"QTM: a data packet of {len(payload)} bytes")
    time_us, number, count = _FRAME.unpack_from(payload)
    if count > MOST_COMPONENTS:
        raise InvalidPacket(f"QTM: {count} components in one packet")
    points: dict[int, NDArray[np.float32]] = {}
    residuals: dict[int, NDArray[np.float32]] = {}
    forces: tuple[PlateForces, ...] | None = None
    at = _FRAME.size
    for _ in range(count):
        if len(payload) - at < _PART.size:
            raise InvalidPacket("QTM: a component is cut off")
        size, kind = _PART.unpack_from(payload, at)
        if not _PART.size <= size <= len(payload) - at:
            raise InvalidPacket(f"QTM: a component of {size} bytes where {len(payload) - at} are left")
        if kind in _FLOATS:
            rows = _points(payload, at + _PART.size, at + size, _FLOATS[kind])
            points[kind] = rows[:, :3]
            if kind in _WITH_RESIDUAL:
                residuals[kind] = rows[:, -1]
        elif kind == FORCE:
            forces = _forces(payload, at + _PART.size, at + size)
        at += size
    return DataFrame(number, time_us, points, residuals, forces)


def _points(data: bytes, at: int, end: int, width: int) -> NDArray[np.float32]:
    """(N, width) numbers of points; count, and rates of dropped cameras, stand before them."""
    if end - at < 8:
        raise InvalidPacket("QTM: a component of points is cut off")
    count = _COUNT.unpack_from(data, at)[0]
    if count * width * 4 > end - at - 8:
        raise InvalidPacket(f"QTM: {count} points cannot stand in {end - at - 8} bytes")
    return np.frombuffer(data, "<f4", count * width, at + 8).reshape(count, width)


def _forces(data: bytes, at: int, end: int) -> tuple[PlateForces, ...]:
    if end - at < _COUNT.size:
        raise InvalidPacket("QTM: a component of forces is cut off")
    count = _COUNT.unpack_from(data, at)[0]
    at += _COUNT.size
    if count * _PLATE.size > end - at:
        raise InvalidPacket(f"QTM: {count} plates cannot stand in {end - at} bytes")
    found = []
    for _ in range(count):
        if end - at < _PLATE.size:
            raise InvalidPacket("QTM: a plate is cut off")
        plate, samples, first = _PLATE.unpack_from(data, at)
        at += _PLATE.size
        if samples > MOST_SAMPLES:
            raise InvalidPacket(f"QTM: {samples} forces of a plate in one packet")
        if samples * FORCE_NUMBERS * 4 > end - at:
            raise InvalidPacket(f"QTM: {samples} forces cannot stand in {end - at} bytes")
        values = np.frombuffer(data, "<f4", samples * FORCE_NUMBERS, at).reshape(samples, FORCE_NUMBERS)
        found.append(PlateForces(plate, first, values))
        at += 4 * values.size
    return tuple(found)
