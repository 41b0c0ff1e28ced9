"""OptiTrack's NatNet protocol, version 4.0, from the camera computer's side: messages packed as clients expect them.

Little endian throughout: message number and length (two bytes each), then the payload. Positions are in m; the channels
of a force plate follow the C3D convention, as its corners do: plate axes with z down, force of the plate on the body.

Source: the NatNet SDK's description of its packets (NatNetTypes.h).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput

VERSION = (4, 0, 0, 0)

CONNECT, SERVER_INFO, REQUEST_DESCRIPTIONS, DESCRIPTIONS = 0, 1, 4, 5
FRAME, DISCONNECT, KEEP_ALIVE = 7, 9, 10
"""Numbers of messages."""

CHANNELS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
OCCLUDED, SOLVED, UNLABELLED = 0x01, 0x02, 0x10
"""Flags of a labelled marker."""

LABELLED = np.dtype(
    [("id", "<u4"), ("position", "<f4", (3,)), ("size", "<f4"), ("flags", "<u2"), ("residual", "<f4")]
)
"""A labelled marker: its number in the lower half of ``id``, that of its model in the upper; m."""

NO_POINTS = read_only(np.zeros((0, 3), dtype="<f4"))

MARKER_SIZE_M = 0.014
SET_DESCRIPTION, PLATE_DESCRIPTION = 0, 3
"""Kinds of descriptions."""

_NAME_BYTES = 256
MOST_BYTES = 65_000


@dataclass(frozen=True)
class ForcePlate:
    """Description of a force plate in NatNet.

    Attributes:
        number: Number of its samples in frames, from 1.
        serial: Its serial number; for our own plates their name.
        offset_m: (3,) from the middle of the corners to the point the moments refer to, plate axes.
        corners_m: (4, 3) its corners, the stream's axes.
        raw: It sends other data than calibrated forces.
        channels: Names of its channels.
    """

    number: int
    serial: str
    offset_m: Array
    corners_m: Array
    raw: bool = False
    channels: tuple[str, ...] = CHANNELS


def message(number: int, payload: bytes = b"") -> bytes:
    """A whole packet.

    Raises:
        InvalidInput: The payload is too large for one.
    """
    if len(payload) > MOST_BYTES:
        raise InvalidInput("a frame of this capture is too large for NatNet; play it with --to lsl")
    return struct.pack("<HH", number, len(payload)) + payload


def server_info(application: str, port: int) -> bytes:
    """The answer to a client that connects: unicast, with the clock in ns."""
    name = application.encode()[: _NAME_BYTES - 1].ljust(_NAME_BYTES, b"\0")
    clock = struct.pack("<QHB4B", 1_000_000_000, port, 0, 0, 0, 0, 0)
    return message(SERVER_INFO, name + bytes(VERSION) + bytes(VERSION) + clock)


def descriptions(set_name: str, markers: Sequence[str], plates: Sequence[ForcePlate]) -> bytes:
    """The message that describes the stream: one set of named markers, if there are any, and the plates.

    Args:
        set_name: Name of the marker set.
        markers: Names of its markers; none where points have no names.
        plates: The force plates.
    """
    parts = []
    if markers:
        named = _text(set_name) + struct.pack("<I", len(markers)) + b"".join(map(_text, markers))
        parts.append(struct.pack("<I", SET_DESCRIPTION) + named)
    parts += [struct.pack("<I", PLATE_DESCRIPTION) + _plate_description(plate) for plate in plates]
    return message(DESCRIPTIONS, struct.pack("<I", len(parts)) + b"".join(parts))


def _plate_description(plate: ForcePlate) -> bytes:
    """A force plate with calibrated channels (Fx … Mz) and all four corners."""
    corners = np.asarray(plate.corners_m)
    sides = np.array([np.linalg.norm(corners[0] - corners[k]) for k in (1, 3)])
    kind_and_data = struct.pack("<3I", 2, 0, len(CHANNELS))
    geometry = [sides, plate.offset_m, np.eye(12), corners]
    named = struct.pack("<I", plate.number) + _text(plate.serial)
    return (
        named + b"".join([_floats(one) for one in geometry]) + kind_and_data + b"".join(map(_text, CHANNELS))
    )


def frame(
    number: int,
    time_s: float,
    set_name: str,
    markers_m: Array,
    points_m: Array,
    plates: Array,
) -> bytes:
    """One frame.

    Args:
        number: Frame number.
        time_s: Its time.
        set_name: Of the named markers.
        markers_m: (M, 3) named markers in the stream's axes, NaN where hidden: sent as nought and marked occluded.
        points_m: (N, 3) points without names.
        plates: (K, m, 6) samples of each plate's channels in this frame.
    """
    hidden = np.asarray(np.isnan(markers_m).any(axis=1))
    shown = np.where(hidden[:, None], 0.0, markers_m)
    sets = b""
    if len(markers_m):
        sets = _text(set_name) + struct.pack("<I", len(shown)) + _floats(shown)
    labelled = np.zeros(len(shown) + len(points_m), dtype=LABELLED)
    named, bare = labelled[: len(shown)], labelled[len(shown) :]
    labelled["size"] = MARKER_SIZE_M
    named["id"], bare["id"] = np.arange(len(named)) + (1 << 16) + 1, np.arange(len(bare)) + 1
    named["position"], bare["position"] = shown, points_m
    named["flags"], bare["flags"] = np.where(hidden, OCCLUDED, SOLVED), SOLVED | UNLABELLED
    nanoseconds = round(1e9 * time_s)
    payload = [
        struct.pack("<I", number),
        struct.pack("<I", 1 if len(markers_m) else 0),
        sets,
        struct.pack("<I", len(points_m)),
        _floats(points_m),
        struct.pack("<2I", 0, 0),  # rigid bodies, skeletons
        struct.pack("<I", len(labelled)),
        labelled.tobytes(),
        struct.pack("<I", len(plates)),
        _samples(plates),
        struct.pack("<I", 0),  # devices
        struct.pack("<2Id3QH", 0, 0, time_s, nanoseconds, nanoseconds, nanoseconds, 0),
        struct.pack("<I", 0),  # end of data
    ]
    return message(FRAME, b"".join(payload))


def _samples(plates: Array) -> bytes:
    """All plates' samples (K, m, 6): of each its number, that of its channels, then each channel after its count."""
    count, each, channels = plates.shape
    words = np.empty((count, 2 + channels * (1 + each)), dtype="<u4")
    words[:, 0], words[:, 1] = np.arange(count) + 1, channels
    cells = words[:, 2:].reshape(count, channels, 1 + each)  # a view
    cells[:, :, 0] = each
    cells[:, :, 1:].view("<f4")[:] = plates.transpose(0, 2, 1)
    return words.tobytes()


def _floats(values: Array) -> bytes:
    return np.asarray(values, dtype="<f4").tobytes()


def _text(value: str) -> bytes:
    return value.encode() + b"\0"
