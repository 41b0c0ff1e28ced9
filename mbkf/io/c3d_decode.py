"""Contents of a C3D file, decoded from its bytes: parameters, points, analog samples and events of the header.

A frame is four numbers per point (x, y, z, and the residual with the cameras' mask) and then the analog samples, as
16-bit integers or floats, in the byte order and float format of the processor that wrote them (Intel, DEC, SGI-MIPS).
Points in integers are scaled by POINT:SCALE; analog samples as :mod:`mbkf.io.c3d_scaling` states. Source: The C3D File
Format (c3d.org).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.c3d_layout import BLOCK_BYTES, LAST_FRAME_OF_HEADER, C3dLayout, Processor
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.c3d_rate import frame_rate
from mbkf.io.c3d_records import ParameterRecord
from mbkf.io.c3d_scaling import ANALOG_SCALING, scaled_samples
from mbkf.io.files_read import opened

EVENTS_KEY = 12345
"""Stands in word 150 of a header whose events have four letters."""

MOST_EVENTS, EVENT_TIMES, EVENT_LABELS = 18, 304, 396
"""Events that a header has room for, and the bytes at which their times and labels begin."""

_STEADY = 0.2
"""Largest median step of points between frames, as a share of their median distance from their middle."""

MOST_SAMPLES = 1000
"""Bound of analog samples per frame."""


_PLATES = "FORCE_PLATFORM"
PLATE_GEOMETRY = ("TYPE", "CHANNEL", "CORNERS", "ORIGIN")
"""Parameters without which force plates are not known."""

_NO_PLATES = (
    "force plates are left out: damage may have taken their parameters; give their readings with --forces"
)


@dataclass(frozen=True)
class C3dContent:
    """A decoded file.

    Attributes:
        parameters: Its parameters.
        points: (T, N, 3) points in the file's axes and unit.
        residuals: (T, N) negative where a point was not seen.
        analogs: (C, S) analog channels, scaled.
        rate_hz: Frame rate.
        first_frame: Number of the first frame, counted from 1.
        events: Labels and times in s of the header's events.
        notes: What had to be settled about the layout.
    """

    parameters: C3dParameters
    points: Array
    residuals: Array
    analogs: Array
    rate_hz: float
    first_frame: int
    events: tuple[tuple[str, float], ...]
    notes: tuple[str, ...] = ()


def decode(path: Path, layout: C3dLayout, stretches: Sequence[tuple[int, int]] | None = None) -> C3dContent:
    """Decodes a file whose layout was checked.

    Args:
        path: The file.
        layout: The header's counts.
        stretches: First frame and the one after the last, from 0, of the stretches to decode, one after the other; None
            for the whole file.

    Raises:
        FileFormatError: The data do not fit the layout.
    """
    processor = Processor(layout.processor)
    parameters, without_plates = _parameters(layout, processor)
    shape = data_layout(path, layout, parameters)
    width = 4 * layout.points + shape.analog_per_frame
    header, data, rest = _bytes(path, layout, stretches or ((0, shape.frames),), width, stretches is None)
    frames = shape.frames if stretches is None else sum(after - first for first, after in stretches)
    whole = layout.bytes_per_number == 2
    numbers = (processor.integers(data) if whole else processor.floats(data)).reshape(frames, width)
    corners = numbers[:, : 4 * layout.points].reshape(frames, layout.points, 4)
    if shape.guessed and not _moves_steadily(corners[:, :, :3]):
        present = f"{layout.frames} frames promised, {layout.frames_present} present"
        raise FileFormatError(path, f"cut short: {present}; copy or export it again")
    scale = _point_scale(path, parameters, float(processor.floats(header[12:16])[0])) if whole else 1.0
    rate_hz, doubts = _rate(path, parameters, float(processor.floats(header[20:24])[0]), shape)
    analogs, remarks = scaled_samples(numbers[:, 4 * layout.points :], shape.channels, parameters, whole)
    if len(analogs) and layout.section.may_lack("ANALOG", ANALOG_SCALING):
        analogs = np.zeros((0, 0))
        remarks = ("analog channels are left out: damage may have taken the parameters that scale them",)
    return C3dContent(
        parameters,
        corners[:, :, :3] * scale,
        corners[:, :, 3],
        analogs,
        rate_hz,
        _first_frame(layout, parameters, shape.frames),
        _header_events(header, processor),
        (
            *layout.notes,
            *shape.notes,
            *_unread(rest, width * layout.bytes_per_number),
            *doubts,
            *remarks,
            *([_NO_PLATES] if without_plates else []),
        ),
    )


def frames_stated(path: Path, layout: C3dLayout) -> int | None:
    """Number of frames of a file, from its header, parameters and size; None where its data have to show it.

    Raises:
        FileFormatError: The data do not fit the layout.
    """
    parameters, _ = _parameters(layout, Processor(layout.processor))
    shape = data_layout(path, layout, parameters)
    return None if shape.guessed else shape.frames


def _parameters(layout: C3dLayout, processor: Processor) -> tuple[C3dParameters, bool]:
    """The parameters, and True where those of force plates are left out, since damage may have taken some."""
    values = values_of(layout.section.groups, layout.section.records, processor)
    without_plates = bool(values.get(_PLATES)) and layout.section.may_lack(_PLATES, PLATE_GEOMETRY)
    return C3dParameters(values | {_PLATES: {}} if without_plates else values), without_plates


def _bytes(
    path: Path, layout: C3dLayout, stretches: Sequence[tuple[int, int]], width: int, to_end: bool
) -> tuple[bytes, bytes, bytes]:
    """The header, the frames of stretches, and what follows the last one if it is read ``to_end``."""
    size = width * layout.bytes_per_number
    begin = (layout.data_block - 1) * BLOCK_BYTES
    with opened(path) as file:
        header, data = file.read(BLOCK_BYTES), []
        for first, after in stretches:
            file.seek(begin + first * size)
            data.append(file.read((after - first) * size))
        rest = file.read() if to_end else b""
    return header, data[0] if len(data) == 1 else b"".join(data), rest


def _unread(rest: bytes, frame_bytes: int) -> Iterator[str]:
    """A remark on bytes after the last frame, but for the zeros that fill a block."""
    if len(rest) >= BLOCK_BYTES and rest.strip(b"\0"):
        frames = len(rest) // frame_bytes if frame_bytes else 0
        yield f"{len(rest)} bytes after the last frame are not read" + (
            f" ({frames} frames)" if frames else ""
        )


def _point_scale(path: Path, parameters: C3dParameters, header: float) -> float:
    """Length of one step of integer points: the scale that is positive, as for integers, else without its sign."""
    scales = [
        scale for scale in (parameters.number("POINT", "SCALE"), header) if scale and np.isfinite(scale)
    ]
    if not scales:
        reason = "its points are integers, and neither POINT:SCALE nor the header states their size"
        raise FileFormatError(path, f"{reason}; export it again")
    return next((scale for scale in scales if scale > 0.0), abs(scales[0]))


def _rate(
    path: Path, parameters: C3dParameters, header_hz: float, shape: DataLayout
) -> tuple[float, list[str]]:
    """The frame rate in Hz, and remarks on it."""
    samples = shape.analog_per_frame // shape.channels if shape.channels else 0
    analog_hz = parameters.number("ANALOG", "RATE") / samples if samples else 0.0
    return frame_rate(path, parameters.number("POINT", "RATE"), header_hz, analog_hz)


def _moves_steadily(points: Array) -> bool:
    """True for points (T, N, 3) that move less from frame to frame than they are apart, as rows of a right width do."""
    with np.errstate(all="ignore"):
        step = np.median(np.abs(np.diff(points, axis=0))) if len(points) > 1 else np.nan
        apart = np.median(np.abs(points - np.median(points, axis=1, keepdims=True)))
        return bool(step < _STEADY * apart)


def values_of(
    groups: Mapping[int, str], records: Sequence[ParameterRecord], processor: Processor
) -> dict[str, dict[str, object]]:
    """Parameters by group and name: lists of texts, or arrays with the dimensions that the file states.

    Args:
        groups: Names of the groups by their numbers.
        records: The parameters as they stand in the file.
        processor: Who wrote them.
    """
    found: dict[str, dict[str, object]] = {name: {} for name in groups.values()}
    for record in records:
        found[groups[record.group]][record.name] = _value(record, processor)
    return found


def _value(record: ParameterRecord, processor: Processor) -> object:
    if record.kind == -1:
        return _texts(record)
    if record.kind == 1:
        flat = np.frombuffer(record.data, dtype=np.uint8).astype(np.float64)
    else:
        flat = processor.integers(record.data) if record.kind == 2 else processor.floats(record.data)
    return flat.reshape(record.dimensions or (1,), order="F")


def _texts(record: ParameterRecord) -> list[str]:
    """Words, the first dimension being their length."""
    length = record.dimensions[0] if record.dimensions else 1
    if not length:
        return []
    words = [record.data[at : at + length] for at in range(0, len(record.data), length)]
    return [_text(word) for word in words]


def _text(word: bytes) -> str:
    plain = word.split(b"\0")[0]
    try:
        return plain.decode("utf-8").strip()
    except UnicodeDecodeError:
        return plain.decode("latin-1").strip()


class DataLayout(NamedTuple):
    """Frames, analog numbers per frame, channels, remarks on them, and True for counts that the file does not state."""

    frames: int
    analog_per_frame: int
    channels: int
    notes: tuple[str, ...] = ()
    guessed: bool = False


def data_layout(path: Path, layout: C3dLayout, parameters: C3dParameters) -> DataLayout:
    """Layout on which header, parameters and the file's size agree.

    Args:
        path: The file, for messages.
        layout: The header's counts.
        parameters: Its parameters.

    Raises:
        FileFormatError: The file holds fewer frames than it promises, by more than one, or its layout is ambiguous.
    """
    used = _count(parameters.number("ANALOG", "USED"))
    stated = used * _samples_per_frame(parameters)
    channels = used if stated == layout.analog_per_frame else layout.channels
    header = (layout.analog_per_frame, channels)
    kinds = dict.fromkeys((header, (stated, used if stated else 0), (0, 0)))
    for frames in stated_frames(layout, parameters):
        fits = [kind for kind in kinds if _fits(layout, frames, kind[0])]
        if not layout.section.states("ANALOG", "USED") and header in fits:
            fits = [header]
        if len(fits) == 1 or (fits and used == channels):
            return DataLayout(frames, *fits[0], tuple(_remarks(layout, frames, *fits[0])))
    fewer = _one_fewer(layout, used, _samples_per_frame(parameters))
    if fewer is not None:
        return fewer
    if layout.frames_present < layout.frames:
        present = f"{layout.frames} frames promised, {layout.frames_present} present"
        raise FileFormatError(path, f"cut short: {present}; copy or export it again")
    if layout.counts_no_further:
        reason = f"its header counts {layout.frames} frames and can count no further, {layout.frames_present} are there"
        raise FileFormatError(path, f"{reason}, and no other entry states their number; export it again")
    if layout.frames <= 0:
        raise FileFormatError(path, "its header counts no frames; export the trial again")
    if used != channels:
        reason = f"ANALOG:USED is {used}, the header counts {layout.channels}; export it again"
        raise FileFormatError(path, reason)
    return DataLayout(layout.frames, *header, tuple(_remarks(layout, layout.frames, *header)))


def _one_fewer(layout: C3dLayout, used: int, samples: int) -> DataLayout | None:
    """The layout of a file whose writer counted one frame, channel or sample a frame too many; None for any other.

    Such a file ends with a whole block, and only one of the three fills it.

    Args:
        layout: The header's counts.
        used: Channels by ANALOG:USED.
        samples: Samples of a channel per frame, by the rates.
    """
    channels = used or layout.channels
    samples = samples or (layout.analog_per_frame // layout.channels if layout.channels else 0)
    ways = {  # of as many channels as samples, one channel fewer is the likelier
        (layout.frames, channels * (samples - 1)): channels,
        (layout.frames, (channels - 1) * samples): channels - 1,
        (layout.frames - 1, layout.analog_per_frame): layout.channels,
    }
    possible = [way for way in ways if way[0] > 0 and way[1] >= 0 and _fits(layout, *way)]
    if layout.file_bytes % BLOCK_BYTES or layout.counts_no_further or len(possible) != 1:
        return None
    ((frames, per_frame),) = possible
    remarks = tuple(_remarks(layout, frames, per_frame, layout.channels))
    return DataLayout(frames, per_frame, ways[frames, per_frame], remarks, guessed=True)


def _fits(layout: C3dLayout, frames: int, per_frame: int) -> bool:
    """True where so many frames fill the file to its last block."""
    taken = frames * (4 * layout.points + per_frame) * layout.bytes_per_number
    return 0 <= layout.data_bytes - taken < BLOCK_BYTES


def stated_frames(layout: C3dLayout, parameters: C3dParameters) -> tuple[int, ...]:
    """Numbers of frames that the file states in one place or another, the likeliest first.

    That is the header's, unless its first frame is 0, since frames count from 1; where its words, which end at 65535,
    can count no further, it is the largest.
    """
    last, first = (
        _two_words(parameters.numbers("TRIAL", f"ACTUAL_{which}_FIELD")) for which in ("END", "START")
    )
    counts = [layout.frames, 0 if last is None or first is None else last - first + 1]
    counts += [_count(parameters.number("POINT", name)) for name in ("LONG_FRAMES", "FRAMES")]
    if layout.first_frame == 0:
        counts = [*counts[1:], counts[0]]
    found = dict.fromkeys(count for count in counts if count > 0)
    return tuple(sorted(found, reverse=True) if layout.counts_no_further else found)


def _first_frame(layout: C3dLayout, parameters: C3dParameters, frames: int) -> int:
    """Number of the first frame, counted from 1.

    That is the header's or TRIAL:ACTUAL_START_FIELD's: beyond the header's words, and where only TRIAL counts as many
    frames as there are.
    """
    first, last = (
        _two_words(parameters.numbers("TRIAL", f"ACTUAL_{which}_FIELD")) for which in ("START", "END")
    )
    if first is None:
        return layout.first_frame
    if layout.first_frame == LAST_FRAME_OF_HEADER:
        return max(layout.first_frame, first)
    alone = layout.frames != frames and not layout.counts_no_further and last == first + frames - 1
    return first if alone else layout.first_frame


def _remarks(layout: C3dLayout, frames: int, per_frame: int, channels: int) -> Iterator[str]:
    if frames != layout.frames and not layout.counts_no_further:
        yield f"the header counts {layout.frames} frames, the file has {frames}"
    if per_frame != layout.analog_per_frame:
        yield f"the header counts {layout.analog_per_frame} analog numbers a frame, the file has {per_frame}"
    elif channels != layout.channels:
        yield f"the header counts {layout.channels} analog channels, the file has {channels}"


def _count(number: float) -> int:
    """A count of frames or channels; 0 for a number that cannot be one."""
    return int(number) if 0.0 <= number < 2**31 else 0


def _two_words(value: Array) -> int | None:
    """A 32-bit number in two 16-bit words, low word first."""
    words = value.ravel() % 65536
    return int(words @ [1, 65536]) if len(words) == 2 else None


def _samples_per_frame(parameters: C3dParameters) -> int:
    ratio = parameters.number("ANALOG", "RATE") / (parameters.number("POINT", "RATE") or np.nan)
    return round(ratio) if 0.0 < ratio < MOST_SAMPLES else 0


def _header_events(header: bytes, processor: Processor) -> tuple[tuple[str, float], ...]:
    words = np.frombuffer(header, dtype=f"{processor.order}u2")
    if words[149] != EVENTS_KEY:
        return ()
    count = min(int(words[150]), MOST_EVENTS)
    times = processor.floats(header[EVENT_TIMES : EVENT_TIMES + 4 * count])
    labels = [_text(header[EVENT_LABELS + 4 * k : EVENT_LABELS + 4 * k + 4]) for k in range(count)]
    return tuple((label, float(time)) for label, time in zip(labels, times, strict=True) if label)
