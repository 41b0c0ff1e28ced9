"""Messages of the JSON protocol of docs/live_streams.md: the description of a stream, a frame, or both in a line."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.io.axes import METRES_PER_UNIT, length_unit, rotation_to_world
from mbkf.io.plate_corners import has_area
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.source import FARTHEST_M, LARGEST_COUNT, StreamDescription, counts, empty_plate

DEFAULT_PORT = 15100
"""Port of ``--from udp`` without one."""

RATES_HZ = (1.0, 100_000.0)
"""Rates of frames and plates that a stream may state."""

MOST_MARKERS, MOST_PLATES = 1000, 64

MOST_LETTERS, MOST_SHOWN = 200, 40
"""Letters of a text, and of a refused value that a message shows, at most."""

DESCRIBING = ("trial", "rate", "unit", "moment_unit", "up", "names", "plates", "start")
"""Keys of a description; each stays until it is sent again."""

NEWTON_METRES = {"n m": 1.0, "nm": 1.0, "n mm": 1e-3, "nmm": 1e-3}
"""Units of moments, in lower case."""


@dataclass(frozen=True)
class UdpDescription:
    """A stream's description.

    Attributes:
        stream: Its description in metres and world axes; ``marker_names`` as the stream states them, none where it
            states none.
        metres: Size of its length unit, m.
        newton_metres: Size of its unit of moments, N m.
        rotation: (3, 3) from its axes to the world's.
    """

    stream: StreamDescription
    metres: float
    newton_metres: float
    rotation: Array

    @cached_property
    def to_world(self) -> Array:
        """(3, 3) matrix that takes rows of coordinates, in the stream's unit and axes, to the world's in metres."""
        return self.metres * self.rotation.T

    def wrenches(self, forces: Array) -> Array:
        """(S, K, 6) force N and moment N m in world axes, from samples (S, K, 6) in the stream's units and axes."""
        found: Array = (forces.reshape(-1, 3) @ self.rotation.T).reshape(forces.shape)
        if self.newton_metres != 1.0:
            found[:, :, 3:] *= self.newton_metres
        return found


@dataclass(frozen=True)
class Message:
    """A line.

    Attributes:
        described: Its keys that describe the stream.
        number: The frame's number; None for a line without a frame.
        markers: Coordinates by name, in the stream's unit and axes.
        points: (N, 3) points without names, likewise.
        sample: Number of the first sample of the plates; None where it is not sent.
        forces: (S, K, 6) samples of the plates, in the stream's units and axes; None without any.
    """

    described: Mapping[str, object]
    number: int | None
    markers: Mapping[str, object] = field(default_factory=dict)
    points: Array | None = None
    sample: int | None = None
    forces: Array | None = None


def read_messages(data: bytes) -> list[Message]:
    """The lines of a datagram.

    Raises:
        InvalidPacket: A line is not a message of the protocol.
    """
    found = [_message(line) for line in data.splitlines() if line.strip()]
    if not found:
        raise InvalidPacket("UDP: the datagram is empty")
    return found


def _message(line: bytes) -> Message:
    try:
        fields = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise InvalidPacket(f"UDP: a line is not JSON: {error}") from error
    if not isinstance(fields, dict):
        raise InvalidPacket("UDP: a line is not an object, { … }")
    described = {key: fields[key] for key in DESCRIBING if key in fields}
    markers = fields.get("markers") or {}
    if not isinstance(markers, dict):
        raise InvalidPacket('UDP: "markers" is not an object of names and [x, y, z]')
    return Message(
        described,
        None if "frame" not in fields else _count(fields["frame"], "frame"),
        markers,
        None if fields.get("points") is None else _numbers(fields["points"], "points", (-1, 3)),
        None if fields.get("sample") is None else _count(fields["sample"], "sample"),
        None if fields.get("forces") is None else _numbers(fields["forces"], "forces", (-1, -1, 6)),
    )


def read_description(fields: Mapping[str, object]) -> UdpDescription:
    """A stream's description from all keys that it has sent so far.

    Raises:
        InvalidInput: A value is missing or not possible.
        UnknownName: A unit or an axis does not exist.
    """
    if "rate" not in fields:
        raise InvalidInput('UDP: the stream states no rate; send "rate" with its frames per second')
    rate_hz = _within(fields["rate"], "rate", *RATES_HZ)
    metres = METRES_PER_UNIT[length_unit(_text(fields, "unit", "m"))]
    moment = _text(fields, "moment_unit", "N m")
    if moment.lower() not in NEWTON_METRES:
        raise InvalidInput(f'UDP: "moment_unit" is {moment!r}; send "N m" or "N mm"')
    rotation = rotation_to_world(_text(fields, "up", "z"))
    start_s = _within(fields.get("start", 0.0), "start", -1e10, 1e10)
    names = fields.get("names") or []
    if not isinstance(names, list) or not all(isinstance(one, str) for one in names):
        raise InvalidInput('UDP: "names" is not a list of the markers\' names')
    if len(names) > MOST_MARKERS or len(set(names)) < len(names):
        raise InvalidInput(f'UDP: "names" holds a name twice, or more than {MOST_MARKERS}')
    plates = fields.get("plates") or []
    if not isinstance(plates, list) or len(plates) > MOST_PLATES:
        raise InvalidInput(f'UDP: "plates" is not a list of at most {MOST_PLATES} plates')
    read = tuple(_plate(one, k, rate_hz, metres, rotation, start_s) for k, one in enumerate(plates))
    if len({(plate.rate_hz, plate.start_time_s) for plate in read}) > 1:
        raise InvalidInput("UDP: the plates state different rates or starts")
    stream = StreamDescription(_text(fields, "trial", "udp"), tuple(names), rate_hz, start_s, read)
    return UdpDescription(stream, metres, NEWTON_METRES[moment.lower()], rotation)


def _plate(
    one: object, k: int, rate_hz: float, metres: float, rotation: Array, start_s: float
) -> PlateReadings:
    if not isinstance(one, Mapping):
        raise InvalidInput(f"UDP: plate {k + 1} is not an object, {{ … }}")
    corners = None
    try:
        if one.get("corners") is not None:
            corners = metres * _numbers(one["corners"], "corners", (4, 3)) @ rotation.T
        origin = None if one.get("origin") is None else _numbers(one["origin"], "origin", (3,))
    except InvalidPacket as error:
        raise InvalidInput(f"UDP: plate {k + 1}: {error}") from error
    if origin is not None:
        origin = metres * origin @ rotation.T
    elif corners is not None:
        origin = corners.mean(axis=0)
    else:
        origin = np.zeros(3)
    known = corners is not None and has_area(corners, FARTHEST_M)
    if (
        not np.isfinite(origin).all()
        or np.abs(origin).max() > FARTHEST_M
        or (corners is not None and not known)
    ):
        raise InvalidInput(f'UDP: plate {k + 1}: "corners" or "origin" are no place in a laboratory')
    rate = _within(one.get("rate", rate_hz), "plates: rate", *RATES_HZ)
    start = _within(one.get("start", start_s), "plates: start", -1e10, 1e10)
    name = _text(one, "name", str(k + 1))
    return empty_plate(name, rate, start, origin, DEFAULT_COP_THRESHOLD_N, corners)


def _count(value: object, key: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidPacket(f'UDP: "{key}" is not a number')
    if isinstance(value, int) and abs(value) <= LARGEST_COUNT:
        return value
    return int(counts(np.float64(value))) if abs(value) < 1e300 else int(counts(np.float64(math.nan)))


def _numbers(value: object, key: str, shape: Sequence[int]) -> Array:
    """Numbers of a shape, in which −1 stands for any length; ``null`` becomes NaN."""
    try:
        found = np.array(value, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        raise InvalidPacket(
            f'UDP: "{key}" holds other things than numbers, or rows of several lengths'
        ) from error
    if found.size == 0:
        return np.zeros([max(0, length) for length in shape])
    fits = found.ndim == len(shape) and all(w in (-1, n) for w, n in zip(shape, found.shape, strict=True))
    if not fits:
        wanted = " × ".join("n" if length < 0 else str(length) for length in shape)
        raise InvalidPacket(f'UDP: "{key}" has the shape {found.shape} where {wanted} is wanted')
    return found


def _within(value: object, key: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InvalidInput(f'UDP: "{key}" is {_shown(value)}; send a number from {low:g} to {high:g}')
    return float(value)


def _text(fields: Mapping[str, object], key: str, default: str) -> str:
    text = fields.get(key, default)
    if not isinstance(text, str) or len(text) > MOST_LETTERS:
        raise InvalidInput(f'UDP: "{key}" is not a text of at most {MOST_LETTERS} letters')
    return text


def _shown(value: object) -> str:
    """The beginning of a value, for a message."""
    text = repr(value)
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]} …"


def described_again(fields: dict[str, object], more: Mapping[str, object]) -> bool:
    """Adds keys to those that a stream has sent so far; true where one is new or has another value."""
    changed = {key: value for key, value in more.items() if key not in fields or fields[key] != value}
    fields |= changed
    return bool(changed)


def described_fully(fields: Mapping[str, object], waited: bool) -> UdpDescription | None:
    """A description once it is complete; None while keys may still come.

    Args:
        fields: All keys so far.
        waited: The stream has been heard for so long that no more keys are to be expected.

    Raises:
        MbkfError: It cannot be used.
    """
    return None if "rate" not in fields and not waited else read_description(fields)
