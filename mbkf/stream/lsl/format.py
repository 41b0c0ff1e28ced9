"""Format of markers and plates in Lab Streaming Layer: channels and the stream's XML description.

A marker stream is of type "MoCap", three channels per marker ("PositionX", … in "meters"), each with a <marker> that
names it; points without names have none. A plate stream is of type "ForcePlate", six channels per plate ("ForceX" …
"MomentZ" in "newtons" and "newtonmeters"), force of the plate on the body and moment about the plate's origin. Both may
end with a channel of type "FrameNumber" that counts frames or samples; without it, numbers follow from time stamps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.identity import Columns
from mbkf.stream.source import StreamDescription, empty_plate

StreamInfo: TypeAlias = Any
"""A stream's description as pylsl holds it; the library carries no types."""

MARKERS_TYPE, PLATES_TYPE = "MoCap", "ForcePlate"
MARKER_TYPES = ("mocap", "motioncapture", "motion capture")
COUNTER = "framenumber"
Channels: TypeAlias = slice | Array
"""Numbers of channels in a sample."""

_POSITION = ("positionx", "positiony", "positionz")
_LOAD = ("forcex", "forcey", "forcez", "momentx", "momenty", "momentz")
_NEWTONS = {"": 1.0, "newtons": 1.0, "newton": 1.0, "n": 1.0, "kilonewtons": 1e3, "kn": 1e3}
_NEWTON_METRES = {
    **dict.fromkeys(("", "newtonmeters", "newtonmetres", "newtonmeter", "newtonmetre", "nm"), 1.0),
    **dict.fromkeys(("newtonmillimeters", "newtonmillimetres", "newtonmillimeter", "nmm"), 1e-3),
}
_METRES = {
    "": 1.0,
    "meters": 1.0,
    "metres": 1.0,
    "m": 1.0,
    "millimeters": 1e-3,
    "millimetres": 1e-3,
    "mm": 1e-3,
}
"""Units that channels state, without spaces and signs between their parts, in newtons, newton metres and metres."""


@dataclass(frozen=True)
class MarkerLayout:
    """Channel layout of a sample of markers.

    Attributes:
        named: (M, 3) channels of named markers.
        nameless: (N, 3) channels of points without names.
        counter: Channel that counts frames, None where there is none.
        rotation: (3, 3) from the stream's axes to the world's, times metres per unit.
    """

    named: Array
    nameless: Array
    counter: int | None
    rotation: Array

    def points(self, sample: Array) -> tuple[Array, Array]:
        """(M, 3) named markers and (N, 3) points of a sample, world axes, m."""
        return self._world(sample[self._named]), self._world(sample[self._nameless])

    def _world(self, values: Array) -> Array:
        points = values.reshape(-1, 3)
        return points @ self.rotation.T if self._turned else points

    def reordered(self, columns: Columns) -> MarkerLayout:
        """The layout with named markers in another order, by their (M,) places in this one."""
        return replace(self, named=self.named[columns])

    @cached_property
    def _named(self) -> Channels:
        return _together(self.named)

    @cached_property
    def _nameless(self) -> Channels:
        return _together(self.nameless)

    @cached_property
    def _turned(self) -> bool:
        return not np.array_equal(self.rotation, np.eye(3))


@dataclass(frozen=True)
class PlateLayout:
    """Channel layout of a sample of plates.

    Attributes:
        loads: (K, 6) channels of each plate.
        counter: Channel that counts samples, None where there is none.
        rotation: (3, 3) from the stream's axes to the world's.
        units: Newtons and newton metres per unit of forces and moments.
    """

    loads: Array
    counter: int | None
    rotation: Array
    units: tuple[float, float] = (1.0, 1.0)

    def wrenches(self, samples: Array) -> Array:
        """(S, K, 6) wrenches of samples (S, channels), world axes."""
        found = samples[:, self._loads].reshape(-1, 3)
        turned = found @ self.rotation.T if self._turned else found
        wrenches = turned.reshape(len(samples), *self.loads.shape)
        return wrenches if self.units == (1.0, 1.0) else wrenches * np.repeat(self.units, 3)

    def reordered(self, columns: Columns) -> PlateLayout:
        """The layout with plates in another order, by their (K,) places in this one."""
        return replace(self, loads=self.loads[columns])

    @cached_property
    def _loads(self) -> Channels:
        return _together(self.loads)

    @cached_property
    def _turned(self) -> bool:
        return not np.array_equal(self.rotation, np.eye(3))


def _together(channels: Array) -> Channels:
    """Channels as a slice where they follow each other, which numpy takes ten times as quickly."""
    flat = channels.ravel()
    first = int(flat[0]) if len(flat) else 0
    return slice(first, first + len(flat)) if np.array_equal(flat, first + np.arange(len(flat))) else flat


def marker_info(lsl: ModuleType, stream: StreamDescription, name: str, points: int) -> StreamInfo:
    """The stream information of markers, or of points without names where the stream has no marker names.

    Args:
        lsl: The module pylsl.
        stream: Markers and frame rate.
        name: Name of the LSL stream.
        points: Number of points in a frame without names.
    """
    labels = stream.marker_names or tuple(f"point{k + 1}" for k in range(points))
    channels = [
        {"label": f"{label}_{axis}", "marker": label, "type": f"Position{axis}", "unit": "meters"}
        for label in labels
        for axis in "XYZ"
    ]
    if not stream.marker_names:
        channels = [{key: one[key] for key in ("label", "type", "unit")} for one in channels]
    info = new_info(lsl, stream, name, MARKERS_TYPE, [*channels, counter_channel("frame")])
    if stream.plates:
        info.desc().append_child_value("plates_stream", plates_name(name))
    return info


def plates_info(lsl: ModuleType, stream: StreamDescription, name: str) -> StreamInfo:
    """The stream information of the force plates that belong to a marker stream.

    Args:
        lsl: The module pylsl.
        stream: The plates and their rate.
        name: Name of the LSL stream of the markers.
    """
    channels = [
        {
            "label": f"{plate.name}_{kind[0]}{axis.lower()}",
            "plate": plate.name,
            "type": f"{kind}{axis}",
            "unit": unit,
        }
        for plate in stream.plates
        for kind, unit in (("Force", "newtons"), ("Moment", "newtonmeters"))
        for axis in "XYZ"
    ]
    start_s = stream.plates[0].start_time_s
    timed = replace(stream, rate_hz=stream.plate_rate_hz, start_time_s=start_s)
    info = new_info(lsl, timed, plates_name(name), PLATES_TYPE, [*channels, counter_channel("sample")])
    plates = info.desc().append_child("plates")
    for plate in stream.plates:
        entry = plates.append_child("plate")
        entry.append_child_value("name", plate.name)
        entry.append_child_value("threshold_n", repr(plate.threshold_n))
        entry.append_child_value("origin_m", _numbers(plate.origin_m))
        if plate.corners_m is not None:
            entry.append_child_value("corners_m", _numbers(plate.corners_m.ravel()))
    return info


def plates_name(markers_name: str) -> str:
    """Name of the plate stream that belongs to a marker stream."""
    return f"{markers_name}-plates"


def read_marker_info(info: StreamInfo) -> tuple[StreamDescription, MarkerLayout, str]:
    """Description and channel layout of a marker stream, and the name of its plate stream ("" for none).

    Raises:
        InvalidInput: It states no rate, or no channels of positions.
    """
    where = f"LSL stream '{info.name()}'"
    if not info.nominal_srate() > 0.0:
        raise InvalidInput(f"{where} states no rate; the filter needs a regular one")
    channels = described_channels(info)
    names, named, nameless = [], [], []
    for k, triple in _groups(channels, _POSITION):
        if triple.get("marker"):
            names.append(triple["marker"])
            named.append(k)
        else:
            nameless.append(k)
    if not named and not nameless:
        raise InvalidInput(f"{where} has no channels of type PositionX, PositionY, PositionZ")
    positions = [k for group in (*named, *nameless) for k in group]
    metres = _unit(channels, positions, _METRES, f"{where} has positions", "meters or millimeters")
    desc = info.desc()
    layout = MarkerLayout(
        np.array(named, dtype=int).reshape(-1, 3),
        np.array(nameless, dtype=int).reshape(-1, 3),
        counter_of(channels),
        rotation_to_world(desc.child_value("up") or "z") * metres,
    )
    description = StreamDescription(
        desc.child_value("trial") or info.name(),
        tuple(names),
        float(desc.child_value("rate_hz") or info.nominal_srate()),
        float(desc.child_value("start_time_s") or 0.0),
    )
    return description, layout, desc.child_value("plates_stream")


def read_plates_info(info: StreamInfo) -> tuple[tuple[PlateReadings, ...], PlateLayout]:
    """The plates of a plate stream, without readings, and its channel layout.

    Raises:
        InvalidInput: It states no rate, or its plates and channels do not belong together.
    """
    where = f"LSL stream '{info.name()}'"
    desc, channels = info.desc(), described_channels(info)
    if not info.nominal_srate() > 0.0:
        raise InvalidInput(f"{where} states no rate; the filter needs a regular one")
    loads, labels = [], []
    for k, first in _groups(channels, _LOAD):
        loads.append(k)
        labels.append(first["plate"])
    rotation = rotation_to_world(desc.child_value("up") or "z")
    start_s = float(desc.child_value("start_time_s") or 0.0)
    rate_hz = float(desc.child_value("rate_hz") or info.nominal_srate())
    plates: list[PlateReadings] = []
    entry = desc.child("plates").child("plate")
    while not entry.empty():
        corners = entry.child_value("corners_m")
        plates.append(
            empty_plate(
                entry.child_value("name") or str(len(plates) + 1),
                rate_hz,
                start_s,
                rotation @ _array(entry.child_value("origin_m"), where),
                float(entry.child_value("threshold_n") or DEFAULT_COP_THRESHOLD_N),
                _array(corners, where).reshape(-1, 3) @ rotation.T if corners else None,
            )
        )
        entry = entry.next_sibling("plate")
    if len(plates) != len(loads):
        raise InvalidInput(
            f"{where} has force channels of {len(loads)} plates and describes {len(plates)} in <plates>"
        )
    if not loads:
        raise InvalidInput(
            f"{where} has no channels of type ForceX, ForceY, ForceZ, MomentX, MomentY, MomentZ"
        )
    forces, moments = ([k for load in loads for k in load[part]] for part in (slice(0, 3), slice(3, 6)))
    units = (
        _unit(channels, forces, _NEWTONS, f"{where} has forces", "newtons"),
        _unit(channels, moments, _NEWTON_METRES, f"{where} has moments", "newtonmeters"),
    )
    places = _by_label(labels, [plate.name for plate in plates], where)
    channels_of = np.array([loads[k] for k in places], dtype=int).reshape(-1, 6)
    return tuple(plates), PlateLayout(channels_of, counter_of(channels), rotation, units)


def new_info(
    lsl: ModuleType, stream: StreamDescription, name: str, kind: str, channels: Sequence[Mapping[str, str]]
) -> StreamInfo:
    """The information of a stream that is sent.

    Args:
        lsl: The module pylsl.
        stream: Trial, rate and start.
        name: Name of the LSL stream.
        kind: Its type.
        channels: Entries of every channel.
    """
    identity = f"mbkf-{name}-{stream.trial}"
    info = lsl.StreamInfo(name, kind, len(channels), stream.rate_hz, lsl.cf_double64, identity)
    desc = info.desc()
    head = {"manufacturer": "mbkf", "trial": stream.trial, "up": "z"}
    head |= {"rate_hz": repr(float(info.nominal_srate())), "start_time_s": repr(float(stream.start_time_s))}
    for key, value in head.items():
        desc.append_child_value(key, value)
    listed = desc.append_child("channels")
    for channel in channels:
        entry = listed.append_child("channel")
        for key, value in channel.items():
            entry.append_child_value(key, value)
    return info


def counter_channel(label: str) -> dict[str, str]:
    """The channel that counts frames or samples."""
    return {"label": label, "type": "FrameNumber", "unit": "none"}


def described_channels(info: StreamInfo) -> list[dict[str, str]]:
    """Label, marker, plate, type and unit of every channel, as far as the stream describes them."""
    found = []
    entry = info.desc().child("channels").child("channel")
    while not entry.empty():
        found.append({key: entry.child_value(key) for key in ("label", "marker", "plate", "type", "unit")})
        entry = entry.next_sibling("channel")
    return found[: info.channel_count()]


def _groups(channels: list[dict[str, str]], types: tuple[str, ...]) -> list[tuple[list[int], dict[str, str]]]:
    """Neighbouring channels of these types in this order, with the description of the first of them."""
    kinds = [channel["type"].lower() for channel in channels]
    size = len(types)
    return [
        (list(range(k, k + size)), channels[k])
        for k in range(len(channels) - size + 1)
        if tuple(kinds[k : k + size]) == types
    ]


def counter_of(channels: list[dict[str, str]]) -> int | None:
    """Number of the channel that counts, None without one."""
    return next((k for k, channel in enumerate(channels) if channel["type"].lower() == COUNTER), None)


def _unit(
    channels: list[dict[str, str]], chosen: Sequence[int], known: Mapping[str, float], what: str, usual: str
) -> float:
    """The factor of the unit of some channels.

    Raises:
        InvalidInput: It is not known, or they have several.
    """
    units = sorted({channels[k]["unit"] for k in chosen})
    factors = {known.get("".join(one for one in unit.lower() if one not in " -*·."), 0.0) for unit in units}
    if len(factors) == 1 and factors != {0.0}:
        return factors.pop()
    listed = ", ".join(f"'{unit}'" for unit in units)
    raise InvalidInput(f"{what} in {listed}; {usual} are understood, one unit for all channels")


def _by_label(labels: Sequence[str], names: Sequence[str], where: str) -> list[int]:
    """For every described plate the number of its channels' group: that with its name, where channels name plates.

    Raises:
        InvalidInput: Channels name other plates than those described.
    """
    if not any(labels) or list(labels) == list(names):
        return list(range(len(names)))
    if sorted(labels) != sorted(names) or len(set(names)) < len(names):
        listed, described = ", ".join(labels), ", ".join(names)
        raise InvalidInput(f"{where} has channels of plates {listed} and describes {described} in <plates>")
    return [labels.index(name) for name in names]


def _numbers(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)


def _array(text: str, where: str) -> Array:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError as error:
        raise InvalidInput(f"{where}: '{text}' are not numbers") from error
    if len(values) % 3 or not len(values):
        raise InvalidInput(f"{where}: '{text}' are not coordinates of points")
    return values
