"""TRC files, OpenSim's text format of marker positions, read and written."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.atomic import replacing
from mbkf.io.axes import (
    METRES_PER_UNIT,
    axes_text,
    check_body_size,
    finite,
    length_unit,
    positions_to_world,
    rotation_to_world,
    up_axis,
)
from mbkf.io.records import AxesSource, Capture, MarkerTrajectories

_TITLES = (
    "DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units", "OrigDataRate", "OrigDataStartFrame",
    "OrigNumFrames",
)  # fmt: skip
_HEADER_LINES = 5
_RATE_TOLERANCE = 0.005
_COLUMNS_BEFORE_MARKERS = 2


@dataclass(frozen=True)
class TrcHeader:
    """Third line of a TRC file.

    Attributes:
        rate_hz: DataRate in Hz.
        frames: NumFrames, None where it is not stated.
        markers: NumMarkers, None where it is not stated.
        unit: Units as written, "" where none is stated.
        shifted: Whether the fields do not stand under their titles.
    """

    rate_hz: float
    frames: int | None
    markers: int | None
    unit: str
    shifted: bool


def read_trc(path: str | Path, *, up: str | None = None, unit: str | None = None) -> Capture:
    """Read a TRC file.

    Blank cells, NaN and exact zeros are missing samples. The header's fields are found by their order, since
    some programs put extra tabs between them.

    Args:
        path: The file.
        up: Axis of the file that points up; TRC files do not state it, by default it is OpenSim's y.
        unit: Length unit; by default the one in the header.

    Returns:
        A capture with markers only, at the header's rate; the Time column gives the time of the first frame.

    Raises:
        FileFormatError: The file is missing or not a TRC file; names the line.
        InvalidInput: The markers cannot be in that unit.
        UnknownName: Unknown axis or unit.
    """
    source = AxesSource.DEFAULT if up is None else AxesSource.UP_GIVEN
    path, up = Path(path), up_axis("y" if up is None else up)
    lines = _lines(path)
    header = _header(path, lines)
    names = _names(lines[3])
    notes = []
    if header.shifted:
        notes.append("header line 3 is shifted against its titles; its fields were read in order")
    if header.markers is not None and header.markers != len(names):
        notes.append(f"the header counts {header.markers} markers, {len(names)} are named")
    times, values = _rows(path, lines, len(names))
    if header.frames is not None and header.frames != len(times):
        if header.frames > len(times):
            reason = f"cut short: the header promises {header.frames} frames, {len(times)} are there"
            raise FileFormatError(path, f"{reason}; copy or export it again")
        notes.append(f"the header counts {header.frames} frames, {len(times)} are there")
    notes += _compare_rate(header.rate_hz, times)
    used_unit = _unit(path, header.unit, unit, notes)
    positions = positions_to_world(values, finite(values), up, used_unit)
    if unit is None:
        notes += check_body_size(positions, used_unit, str(path))
    markers = MarkerTrajectories(names, positions, header.rate_hz, float(times[0]))
    return Capture(
        str(path),
        markers,
        up_axis=up,
        length_unit=used_unit,
        notes=tuple(notes),
        axes=axes_text(rotation_to_world(up)),
        axes_source=source,
    )


def write_trc(markers: MarkerTrajectories, path: str | Path) -> None:
    """Write marker positions as OpenSim reads them: y up, mm, missing samples as NaN.

    Args:
        markers: Positions in m and world axes.
        path: The file, replaced whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    values = markers.positions_m @ rotation_to_world("y") / METRES_PER_UNIT["mm"]
    rate, frames, count = repr(float(markers.rate_hz)), markers.frames, len(markers.names)
    table = values.reshape(frames, 3 * count)
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"PathFileType\t4\t(X/Y/Z)\t{Path(path).name}\n")
        file.write("\t".join(_TITLES) + "\n")
        file.write(f"{rate}\t{rate}\t{frames}\t{count}\tmm\t{rate}\t1\t{frames}\n")
        file.write("Frame#\tTime\t" + "\t\t\t".join(markers.names) + "\t\t\n")
        file.write("\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(count) for axis in "XYZ") + "\n\n")
        for number, (time_s, row) in enumerate(zip(markers.times_s, table, strict=True), start=1):
            cells = "\t".join("NaN" if math.isnan(value) else f"{value:.6f}" for value in row)
            file.write(f"{number}\t{time_s:.8f}\t{cells}\n")


def _lines(path: Path) -> list[str]:
    if not path.is_file():
        raise FileFormatError(path, "no such file; name a TRC file")
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    if not lines or "pathfiletype" not in lines[0].lower():
        raise FileFormatError(path, "not a TRC file (it does not begin with PathFileType)", 1)
    if len(lines) <= _HEADER_LINES:
        raise FileFormatError(path, "cut short: no frames after the header; export it again", len(lines))
    return lines


def _header(path: Path, lines: list[str]) -> TrcHeader:
    """Numbers in their order (DataRate, CameraRate, NumFrames, NumMarkers …) and the one word among them."""
    words = lines[2].split()
    numbers = [number for word in words if (number := _number(word)) is not None]
    unit = next((word for word in words if _number(word) is None), "")
    if not numbers or not (math.isfinite(numbers[0]) and numbers[0] > 0.0):
        raise FileFormatError(path, "the header gives no DataRate; write it first in this line", 3)
    counts = [int(number) if number >= 0 and number == int(number) else None for number in numbers[2:4]]
    counts += [None] * (2 - len(counts))
    titles = [title.strip().lower() for title in lines[1].split("\t")]
    cells = [cell.strip() for cell in lines[2].split("\t")]
    column = titles.index("units") if "units" in titles else -1
    shifted = bool(unit) and (not 0 <= column < len(cells) or cells[column] != unit)
    return TrcHeader(numbers[0], counts[0], counts[1], unit, shifted)


def _number(word: str) -> float | None:
    try:
        number = float(word)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _names(line: str) -> tuple[str, ...]:
    """Marker names: the cells after Frame# and Time, with any number of tabs between them."""
    cells = line.split("\t") if "\t" in line else line.split()
    return tuple(cell.strip() for cell in cells if cell.strip())[_COLUMNS_BEFORE_MARKERS:]


def _rows(path: Path, lines: list[str], count: int) -> tuple[Array, Array]:
    """(T,) times in s and (T, M, 3) coordinates, NaN where a cell is blank."""
    if not count:
        raise FileFormatError(path, "no marker is named", 4)
    width = _COLUMNS_BEFORE_MARKERS + 3 * count
    table = []
    for number, line in enumerate(lines[_HEADER_LINES:], start=_HEADER_LINES + 1):
        if not line.strip():
            continue
        cells = line.split("\t") if "\t" in line else line.split()
        if any(cell.strip() for cell in cells[width:]):
            raise FileFormatError(path, f"{len(cells)} columns, but {count} markers need {width}", number)
        try:
            row = [float(cell) if cell.strip() else math.nan for cell in cells[:width]]
        except ValueError as error:
            raise FileFormatError(path, f"not a number ({error}); correct or blank it", number) from error
        if len(row) < _COLUMNS_BEFORE_MARKERS or math.isnan(row[1]):
            raise FileFormatError(path, "the row has no time; export the file again", number)
        table.append(row + [math.nan] * (width - len(row)))
    if not table:
        raise FileFormatError(path, "no frames after the header; export it again", len(lines))
    rows = np.array(table, dtype=np.float64)
    return rows[:, 1], rows[:, _COLUMNS_BEFORE_MARKERS:].reshape(len(rows), count, 3)


def _compare_rate(rate_hz: float, times: Array) -> list[str]:
    """A remark where header and Time column disagree."""
    span = times[-1] - times[0]
    if len(times) < 2:
        return []
    if span <= 0.0:
        return ["the Time column does not increase; times follow from the header's rate"]
    from_times = (len(times) - 1) / span
    if abs(from_times - rate_hz) > _RATE_TOLERANCE * rate_hz:
        return [f"the header states {rate_hz:g} Hz, the Time column {from_times:.6g} Hz; the header is used"]
    return []


def _unit(path: Path, stated: str, given: str | None, notes: list[str]) -> str:
    if given is not None:
        return length_unit(given)
    if not stated:
        notes.append("the header states no unit; lengths taken as mm")
        return "mm"
    try:
        return length_unit(stated)
    except UnknownName as error:
        reason = f"Units is '{stated}', no unit of length; give it with --unit (mm, cm or m)"
        raise FileFormatError(path, reason, 3) from error
