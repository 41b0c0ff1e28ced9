"""Writing captures as C3D files that this package and other software read back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.atomic import replacing
from mbkf.io.axes import METRES_PER_UNIT, finite, length_unit, rotation_to_world
from mbkf.io.c3d_encode import MOST_ENTRIES, Value, encoded
from mbkf.io.c3d_scaling import stored_samples
from mbkf.io.derived import COMPUTED_PLACES, GROUP_KINDS, TYPE_WORDS, UNIT_PARAMETERS
from mbkf.io.plate_corners import QUADRANTS, plate_axes, plate_sides
from mbkf.io.records import AnalogChannel, Capture, DerivedPoint, PlateReadings, SampleScaling
from mbkf.io.written import MARK

Parameters: TypeAlias = dict[str, Value]
"""Parameters of a group by their names."""

_MM = 1000.0
_DEFAULT_HALF_SIDES_M = QUADRANTS * [0.3, 0.2]
"""Corners given to a plate whose geometry is not known, about the point its moments refer to."""

MOST_CHANNELS = 255
"""The format counts them in one byte."""

EVENT_ICONS = {"Foot Strike": 1, "Foot Off": 2}
"""Pictures that Vicon's programs show for events."""

MOST_STEPS, LEAST_STEP_MM = 255, 0.01
"""A residual is a number of steps in one byte; smaller steps say nothing of cameras."""

_CHANNELS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")

_OFFSET_LIMIT = 2.0**15
"""OFFSET is an integer of 16 bits with a sign; channels with another offset are stored without one."""


def write_c3d(
    capture: Capture, path: str | Path, *, every_channel: bool = False, residuals_m: Array | None = None
) -> None:
    """Writes a capture as C3D: z up, mm, plates of type 2 with their offset already removed; whole or not at all.

    Missing samples get residual −1, others that of the camera system in up to 255 steps, or 0. Plates and channels are
    interpolated to a whole number per frame where they are not; where a recording does not reach, they hold 0. C3D
    stores 32-bit floats. Samples that came from a C3D file keep its scaling, and so every bit.

    Args:
        capture: The capture.
        path: The file.
        every_channel: Write channels that are named as those of the plates, too; the plates' then get other names.
        residuals_m: (T, M) residuals of the markers, NaN where they are not known; None for no residuals.

    Raises:
        InvalidInput: The name does not end in ``.c3d``, the capture has no frames, or more channels than fit.
        OSError: The file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".c3d":
        raise InvalidInput(f"{path}: a C3D file is named .c3d; change the name")
    if not capture.markers.frames:
        raise InvalidInput(f"{path}: nothing to write, the capture has no frames")
    markers = capture.markers
    points, missing, point = _points(capture)
    analogs, channels = _analogs(capture, every_channel)
    words, point["SCALE"] = _fourth_words(missing, residuals_m)
    groups = {"POINT": point, **channels, **_events(capture)}
    if capture.subject_mass_kg is not None:
        groups["PROCESSING"] = {"BODYMASS": float(capture.subject_mass_kg)}
    first_frame = max(round(markers.start_time_s * markers.rate_hz), 0) + 1
    groups["MANUFACTURER"] = {"SOFTWARE": [MARK]}
    content = encoded(groups, points, words, analogs, markers.rate_hz, first_frame)
    with replacing(path.with_suffix(".c3d")) as temporary:
        temporary.write_bytes(content)


def _points(capture: Capture) -> tuple[Array, BoolArray, Parameters]:
    """(T, N, 3) measured and derived points in mm, (T, N) missing ones, and the group POINT."""
    markers, derived = capture.markers, capture.derived
    values = [markers.positions_m * _MM]
    values += [_in_file_axes(point, capture)[:, None, :] for point in derived]
    points = np.concatenate(values, axis=1)
    missing = ~finite(points)
    group: Parameters = {
        "LABELS": [*markers.names, *(point.name for point in derived)],
        "DESCRIPTIONS": [""] * len(markers.names) + [_ascii(point.description) for point in derived],
        "UNITS": ["mm"],
        "X_SCREEN": ["+X"],
        "Y_SCREEN": ["+Z"],
        **_lists(derived),
    }
    return np.where(missing[:, :, None], 0.0, points), missing, group


def _fourth_words(missing: BoolArray, residuals_m: Array | None) -> tuple[Array, float]:
    """(T, N) the points' fourth numbers, and POINT:SCALE.

    The low byte counts steps of |SCALE| mm, the high one would name cameras; missing points have −1, and 0 stands for a
    residual that is not known. Source: C3D manual (c3d.org), sections on 3D residuals and on floating-point files.
    """
    words = np.where(missing, -1.0, 0.0)
    if residuals_m is None:
        return words, -1.0
    known = np.zeros(missing.shape, dtype=bool)
    known[:, : residuals_m.shape[1]] = (residuals_m > 0.0) & np.isfinite(residuals_m)
    known &= ~missing
    if not known.any():
        return words, -1.0
    found_mm = _MM * residuals_m[known[:, : residuals_m.shape[1]]]
    step_mm = max(LEAST_STEP_MM, float(found_mm.max()) / MOST_STEPS)
    words[known] = np.clip(np.round(found_mm / step_mm), 1.0, MOST_STEPS)
    return words, -step_mm


def _lists(derived: Sequence[DerivedPoint]) -> Parameters:
    """Lists of the computed points by kind, with the units of kinds that are not places."""
    group: Parameters = {}
    for name, kind in {**GROUP_KINDS, COMPUTED_PLACES: "point"}.items():
        listed = [point for point in derived if point.kind == kind]
        if listed:
            group[name] = [point.name for point in listed]
            if kind != "point":
                group[UNIT_PARAMETERS[kind]] = [listed[0].unit]
    if group:
        group["TYPE_GROUPS"] = np.array([(name, word) for name, word in TYPE_WORDS.items() if name in group])
    return group


def _ascii(text: str) -> str:
    """A text that every reader's letters can show."""
    return text.encode("ascii", "replace").decode("ascii")


def _in_file_axes(point: DerivedPoint, capture: Capture) -> Array:
    """Values to store: places in mm and world axes, all other kinds as they are."""
    if point.kind != "point":
        return point.values
    unit = length_unit(point.unit or capture.length_unit)
    return point.values @ rotation_to_world(capture.up_axis).T * (METRES_PER_UNIT[unit] * _MM)


class _Channel(NamedTuple):
    """A channel of the file: samples as they are stored, label, unit, description and scaling."""

    samples: Array
    name: str
    unit: str
    description: str
    scaling: SampleScaling


def _analogs(capture: Capture, every_channel: bool) -> tuple[Array, dict[str, Parameters]]:
    """(C, S) samples and the groups about them: six channels per plate, then the others."""
    markers = capture.markers
    rates = [plate.rate_hz for plate in capture.plates] + [channel.rate_hz for channel in capture.analog]
    if not rates:
        return np.zeros((0, 0)), {}
    per_frame = max(1, round(max(rates) / markers.rate_hz))
    rate_hz = per_frame * markers.rate_hz
    times = markers.start_time_s + np.arange(markers.frames * per_frame) / rate_hz
    general = _general_scale(capture)
    outlines = [_corners(plate) for plate in capture.plates]
    taken = {channel.name for channel in capture.analog} if every_channel else set()
    found = list(_of_plates(capture.plates, outlines, (times, per_frame, general), taken))
    names = {one.name for one in found}
    for channel in capture.analog:
        if every_channel or channel.name not in names:
            names.add(channel.name)
            found.append(_as_stored(channel, times, markers.start_time_s, per_frame, general))
    if len(found) > MOST_CHANNELS:
        raise InvalidInput(
            f"{len(found)} analog channels, six of them for each of {len(capture.plates)} plates; a C3D file holds "
            f"{MOST_CHANNELS}: leave some away"
        )
    analog: Parameters = {
        "RATE": rate_hz,
        "LABELS": [one.name for one in found],
        "DESCRIPTIONS": [_ascii(one.description) for one in found],
        "UNITS": [one.unit for one in found],
        "GEN_SCALE": general,
        "SCALE": np.array([one.scaling.scale for one in found]),
        "OFFSET": np.array([one.scaling.offset for one in found]).astype(np.int16),
    }
    return np.array([one.samples for one in found]), {"ANALOG": analog, **_plates(capture.plates, outlines)}


def _general_scale(capture: Capture) -> float:
    """The scale of all channels, where those of the capture share one; else 1."""
    scales = {channel.scaling.general for channel in capture.analog}
    return scales.pop() if len(scales) == 1 else 1.0


def _of_plates(
    plates: Sequence[PlateReadings],
    outlines: Sequence[Array],
    clock: tuple[Array, int, float],
    taken: Set[str],
) -> Iterator[_Channel]:
    """Six channels of each plate, under names that are not taken.

    Args:
        plates: The plates.
        outlines: Their corners (4, 3), m.
        clock: The file's (S,) sample times, samples per frame, and the general scale.
        taken: Names of other channels.
    """
    times, per_frame, general = clock
    for number, (plate, outline) in enumerate(zip(plates, outlines, strict=True), start=1):
        for row, channel in zip(_plate_channels(plate, outline).T, _CHANNELS, strict=True):
            name = f"{channel}{number}"
            name = f"{name}_tared" if name in taken else name
            unit = "N" if channel.startswith("F") else "Nmm"
            values = _sampled(times, plate.times_s, row, per_frame) / general
            yield _Channel(values, name, unit, plate.description, SampleScaling(general=general))


def _as_stored(
    channel: AnalogChannel, times_s: Array, start_s: float, per_frame: int, general: float
) -> _Channel:
    """A channel whose samples are those of its own file where that has as many of them."""
    scaling, offset = channel.scaling, channel.scaling.offset
    if scaling.general != general or abs(offset) >= _OFFSET_LIMIT or offset % 1.0 != 0.0:
        scaling = SampleScaling(scaling.scale * scaling.general / general, general)
    values = channel.values
    if len(values) != len(times_s):
        stamps = start_s + np.arange(len(values)) / channel.rate_hz
        values = _sampled(times_s, stamps, values, per_frame)
    return _Channel(stored_samples(values, scaling), channel.name, channel.unit, channel.description, scaling)


def _sampled(times_s: Array, stamps_s: Array, values: Array, per_frame: int) -> Array:
    """Values at the file's sample times: 0 outside the recording, whose last frame is filled with its last value."""
    sampled = np.interp(times_s, stamps_s, values, left=0.0, right=0.0)
    after = np.flatnonzero(times_s > stamps_s[-1])[: per_frame - 1]
    sampled[after] = values[-1]
    return sampled


def _plates(plates: Sequence[PlateReadings], corners: list[Array]) -> dict[str, Parameters]:
    """The group about plates with these corners (4, 3), m; nothing where there are none."""
    count = len(corners)
    if not count:
        return {}
    group: Parameters = {
        "USED": count,
        "TYPE": np.full(count, 2, dtype=np.int16),
        "ZERO": np.array([1, 0], dtype=np.int16),
        "CORNERS": np.stack([outline.T * _MM for outline in corners], axis=2),
        "ORIGIN": np.zeros((3, count)),
        "CHANNEL": np.arange(1, 6 * count + 1, dtype=np.int16).reshape(6, count, order="F"),
    }
    if any(plate.description for plate in plates):
        group["DESCRIPTIONS"] = [_ascii(plate.description) for plate in plates]
    return {"FORCE_PLATFORM": group}


def _corners(plate: PlateReadings) -> Array:
    """(4, 3) corners in m; an outline about the reference point where the geometry is not known.

    Measured corners are hardly ever a rectangle's, and programs take the plate's axes from different sides: those of
    the rectangle with its middle, axes and mean sides have one answer.
    """
    if plate.corners_m is not None:
        x, y = (0.25 * np.linalg.norm(side) for side in plate_sides(plate.corners_m))
        return plate.corners_m.mean(axis=0) + (QUADRANTS * [x, y]) @ plate_axes(plate.corners_m)[:, :2].T
    outline = np.tile(plate.origin_m, (4, 1))
    # Seen from above, x and −y to the quadrants, so that the plate's own z points down.
    outline[:, :2] += _DEFAULT_HALF_SIDES_M * [1.0, -1.0]
    return outline


def _plate_channels(plate: PlateReadings, corners: Array) -> Array:
    """(S, 6) force in N and moment in N mm about the middle of the corners, in the plate's own axes."""
    axes = plate_axes(corners)
    moment = plate.moment_nm + np.cross(plate.origin_m - corners.mean(axis=0), plate.force_n)
    return np.hstack([plate.force_n @ axes, moment @ axes * _MM])


def _events(capture: Capture) -> dict[str, Parameters]:
    events = capture.events
    if not events:
        return {}
    times = np.vstack(np.divmod([event.time_s for event in events], 60.0))
    icons = np.array([EVENT_ICONS.get(event.label, 0) for event in events])
    group: Parameters = {
        "USED": len(events),
        "CONTEXTS": [event.context for event in events],
        "LABELS": [event.label for event in events],
        "DESCRIPTIONS": [""] * len(events),
        "SUBJECTS": [""] * len(events),
    }
    for number, first in enumerate(range(0, len(events), MOST_ENTRIES), start=1):
        some, suffix = slice(first, first + MOST_ENTRIES), str(number) if number > 1 else ""
        group[f"TIMES{suffix}"] = times[:, some]
        group[f"ICON_IDS{suffix}"] = icons[some].astype(np.int16)
        group[f"GENERIC_FLAGS{suffix}"] = np.zeros(len(icons[some]), dtype=np.int16)
    return {"EVENT": group}
