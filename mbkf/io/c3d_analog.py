"""Analog side of a C3D file: channels as stored, force plates as readings in world axes, events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import METRES_PER_UNIT, rotation_to_world
from mbkf.io.c3d_decode import C3dContent
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.c3d_plates import CALIBRATION_OF_TYPE, RawPlate, check_geometry, wrench_at_surface
from mbkf.io.c3d_scaling import sample_scalings
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.plate_table import plate_with_corners
from mbkf.io.readable_plates import NO_CHANNELS, readable_plates
from mbkf.io.records import AnalogChannel, CaptureEvent, PlateReadings
from mbkf.io.wrench import PlateWay, require_finite
from mbkf.numerics.printed import percent

_NO_ORIGIN = (
    "the file lacks FORCE_PLATFORM:ORIGIN: moments of its plates are taken about the middle of their surfaces; compare "
    "the centres of pressure with the feet, or give the readings with --forces"
)

_OFF_PLATE_M = 0.1
_OFF_PLATE_SHARE = 0.5


def analog_rate_hz(content: C3dContent) -> float:
    """Sample rate of the analog channels in Hz, from their number per frame."""
    frames, samples = len(content.points), content.analogs.shape[1]
    per_frame = samples / frames if frames else 0.0
    return float(str(np.float32(content.rate_hz * per_frame)))


def analog_channels(content: C3dContent) -> tuple[AnalogChannel, ...]:
    """Every analog channel, scaled by the file's parameters, in its own unit; in the file's order."""
    values, parameters = content.analogs, content.parameters
    if not values.size:
        return ()
    labels, units, descriptions = (
        parameters.texts("ANALOG", name) for name in ("LABELS", "UNITS", "DESCRIPTIONS")
    )
    rate_hz = analog_rate_hz(content)
    scalings = sample_scalings(parameters, len(values))
    return tuple(
        AnalogChannel(
            name=(labels[i] if i < len(labels) else "") or f"channel {i + 1}",
            values=row,
            unit=units[i] if i < len(units) else "",
            rate_hz=rate_hz,
            scaling=scalings[i],
            description=descriptions[i] if i < len(descriptions) else "",
        )
        for i, row in enumerate(values)
    )


def raw_plates(
    path: Path, content: C3dContent, unit: str, options: CaptureOptions, notes: list[str]
) -> list[RawPlate]:
    """The force plates a file declares, checked but not yet converted; empty where the file has none.

    Args:
        path: The file, for messages.
        content: The decoded file.
        unit: The file's length unit.
        options: Plates to withhold; receives those that cannot be read, or to which no channel belongs.
        notes: Receives remarks on missing parameters.
    """
    analog, parameters = content.analogs, content.parameters
    count = _plate_count(parameters, notes)
    channels = _channels(parameters, count)
    wired = []
    for i in range(count):
        indices = channels[i] if i < len(channels) else np.zeros(0, dtype=int)
        if analog.size and indices.size:
            wired.append((str(i + 1), (i, indices)))
        else:
            options.left_out[str(i + 1)] = NO_CHANNELS
    found = readable_plates(
        wired, lambda one: _raw_plate(path, content, unit, *one), options, str(path), needs_one=False
    )
    if found and not parameters.numbers("FORCE_PLATFORM", "ORIGIN").size:
        notes.append(_NO_ORIGIN)
    return found


def _plate_count(parameters: C3dParameters, notes: list[str]) -> int:
    """Number of plates: USED or, where that is missing or cannot be a number, as many as TYPE lists."""
    used = parameters.numbers("FORCE_PLATFORM", "USED").ravel()
    if used.size and np.isfinite(used[0]) and used[0] >= 0.0:
        return int(used[0])
    listed = parameters.numbers("FORCE_PLATFORM", "TYPE").size
    if listed:
        found = f"{used[0]:g}" if used.size else "missing"
        notes.append(f"FORCE_PLATFORM:USED is {found}; the number of plates is that of TYPE, {listed}")
    return listed


def _channels(parameters: C3dParameters, count: int) -> list[NDArray[np.int_]]:
    """Indices of each plate's channels, from 0, of a table or of a list that the plates share equally."""
    listed = parameters.numbers("FORCE_PLATFORM", "CHANNEL")
    rows = len(listed) if listed.ndim > 1 else listed.size // max(count, 1)
    numbers = parameters.per_plate("CHANNEL", (rows,)) if rows else []
    return [(one[one >= 1.0] - 1.0).astype(int) for one in numbers]


def _raw_plate(path: Path, content: C3dContent, unit: str, i: int, indices: NDArray[np.int_]) -> RawPlate:
    """A plate by its place among the plates, from 0, and those of its channels.

    Raises:
        FileFormatError: The plate is not usable: type, channels, corners or calibration.
    """
    analog, parameters = content.analogs, content.parameters
    if indices.max() >= len(analog):
        reason = f"force plate {i + 1} names channel {indices.max() + 1}, the file has {len(analog)}"
        raise FileFormatError(path, f"{reason}; export it again or use --forces")
    kinds = parameters.numbers("FORCE_PLATFORM", "TYPE").ravel()
    corners, origins = parameters.per_plate("CORNERS", (3, 4)), parameters.per_plate("ORIGIN", (3,))
    units = parameters.texts("ANALOG", "UNITS") + [""] * len(analog)
    kind = int(kinds[i]) if i < len(kinds) else 0
    plate = RawPlate(
        number=i + 1,
        kind=kind,
        corners=corners[i] if i < len(corners) else np.zeros((3, 4)),
        origin=origins[i] if i < len(origins) else np.zeros(3),
        readings=np.asarray(analog[indices], dtype=np.float64).T,
        units=tuple(units[k] for k in indices),
        rate_hz=analog_rate_hz(content),
        calibration=_calibration(parameters, i, kind),
    )
    check_geometry(plate, str(path), unit)
    return plate


def _calibration(parameters: C3dParameters, plate: int, kind: int) -> Array | None:
    """A plate's CAL_MATRIX; None where its type has none, or the file holds none of that shape.

    Plates count from 0; plates of different types share one array as large as the largest.
    """
    shape = CALIBRATION_OF_TYPE.get(kind)
    if shape is None:
        return None
    stored = parameters.numbers("FORCE_PLATFORM", "CAL_MATRIX")
    if stored.ndim == 2:
        stored = stored[:, :, None]
    if stored.ndim == 3 and stored.shape[2] > plate and (np.array(stored.shape[:2]) >= shape).all():
        return np.asarray(stored[: shape[0], : shape[1], plate])
    blocks = parameters.per_plate("CAL_MATRIX", shape)
    return blocks[plate] if plate < len(blocks) else None


def plate_readings(
    plate: RawPlate,
    path: Path,
    unit: str,
    up: str,
    start_time_s: float,
    options: CaptureOptions,
    notes: list[str],
) -> PlateReadings:
    """Force on the body, moment about the centre of the surface and centre of pressure, SI units and world axes.

    Args:
        plate: The checked plate.
        path: The file, for messages.
        unit: The file's length unit.
        up: Axis of the file that points up.
        start_time_s: Time of the first sample in s.
        options: Removal of the offset, and threshold of the centre of pressure; knows or receives the plate's way.
        notes: Receives offsets removed and doubts about the plate.

    Raises:
        InvalidInput: A force or moment is not a number.
    """
    rotation = rotation_to_world(up)
    corners = (rotation @ plate.corners * METRES_PER_UNIT[unit]).T
    known = None if options.ways is None else options.ways.get(str(plate.number))
    with np.errstate(all="ignore"):  # numbers that overflow are refused below
        wrench, origin, factor = wrench_at_surface(plate, unit, notes, known)
        wrench = np.hstack([wrench[:, :3] @ rotation.T, wrench[:, 3:] @ rotation.T])
    name = f"force plate {plate.number}"
    require_finite(wrench[:, :3], wrench[:, 3:], plate.rate_hz, start_time_s, f"{path}, {name}")
    record = str(plate.number), plate.rate_hz, start_time_s
    found, tare = plate_with_corners(*record, corners, wrench, options, None if known is None else known.tare)
    if options.ways is not None:
        options.ways[str(plate.number)] = PlateWay(origin, factor, tare)
    if options.tare and not tare.found:
        notes.append(f"{name} is loaded all the time; no offset removed")
    elif abs(tare.offset[2]) >= 0.5:
        notes.append(f"{name}: offset of {tare.offset[2]:+.1f} N vertical force removed")
    notes += _doubts(name, found, corners)
    return found


def _doubts(name: str, plate: PlateReadings, corners: Array) -> list[str]:
    """Remarks on readings that a person cannot have caused."""
    doubts = []
    vertical, pressure = plate.force_n[:, 2], plate.centre_of_pressure_m
    if vertical.min() < -5.0 * plate.threshold_n and -vertical.min() > vertical.max():
        doubts.append(f"{name} pulls the body down by up to {-vertical.min():.0f} N; check signs and CORNERS")
    seen = pressure[~np.isnan(pressure).any(axis=1)]
    if len(seen):
        half = np.abs(corners - corners.mean(axis=0)).max(axis=0) + _OFF_PLATE_M
        off = (np.abs(seen - corners.mean(axis=0)) > half).any(axis=1).mean()
        if off > _OFF_PLATE_SHARE:
            doubts.append(
                f"{name}: centre of pressure is off the plate {percent(off)} of the time; check CORNERS"
            )
    return doubts


def events(content: C3dContent, notes: list[str]) -> tuple[CaptureEvent, ...]:
    """Labelled instants in order of time, from TIMES (minutes and seconds) of EVENT or EVENTS, else from the header.

    Args:
        content: The decoded file.
        notes: Receives a remark on events without a time.
    """
    parameters = content.parameters
    group = "EVENT" if parameters.group("EVENT") else "EVENTS"
    times = _event_times(parameters, group)
    labels, contexts = parameters.texts(group, "LABELS"), parameters.texts(group, "CONTEXTS")
    if times.size and times.shape[0] == 2:
        seconds = np.atleast_1d(60.0 * times[0] + times[1]).tolist()
        more = [""] * len(seconds)
        notes += [
            f"{group}:{name} lacks {len(seconds) - len(texts)} of {len(seconds)} events"
            for name, texts in (("LABELS", labels), ("CONTEXTS", contexts))
            if len(texts) < len(seconds)
        ]
        found = list(zip(labels + more, contexts + more, seconds, strict=False))
    else:
        found = [(label, "", time_s) for label, time_s in content.events]
        if times.size:
            notes.append(f"{group}:TIMES holds no minutes and seconds; its events are left out")
        elif parameters.number(group, "USED") > 0.0:
            notes.append(f"{group}:USED counts events, {group}:TIMES is missing; they are left out")
    timed = [
        CaptureEvent(label, context, round(at_s, 6)) for label, context, at_s in found if np.isfinite(at_s)
    ]
    if len(timed) < len(found):
        notes.append(f"{len(found) - len(timed)} of {len(found)} events have no time and are left out")
    return tuple(sorted(timed, key=lambda event: event.time_s))


def _event_times(parameters: C3dParameters, group: str) -> Array:
    """(2, n) minutes and seconds of the group's TIMES and of its continuations; another shape is returned as it is."""
    times, number = parameters.numbers(group, "TIMES"), 2
    if times.ndim == 1 and times.size == 2 * parameters.number(group, "USED"):
        times = times.reshape(2, -1, order="F")
    while times.ndim == 2 and len(times) == 2:
        more = parameters.numbers(group, f"TIMES{number}")
        if more.ndim != 2 or len(more) != 2:
            break
        times, number = np.hstack([times, more]), number + 1
    return times
