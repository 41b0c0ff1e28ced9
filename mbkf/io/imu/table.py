"""Tables of one or several sensors, as makers' programs, telephones and people write them.

Finds the row of names below whatever stands above it, the delimiter, the units in names or in a row of their own, and
the times that belong to each column.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.imu.column_names import ColumnName, in_counts, parse_column_name, time_unit
from mbkf.io.imu.even_times import even_times
from mbkf.io.imu.known_tables import defaults_of
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of, signal_width, with_reference
from mbkf.io.imu.spanning_headers import joined_header
from mbkf.io.imu.stated_rate import rate_above
from mbkf.io.imu.table_defaults import NO_DEFAULTS, TableDefaults
from mbkf.io.imu.table_text import TableText, is_number, read_table_text
from mbkf.io.imu.times import times_s
from mbkf.io.imu.units import UNITS, plain_unit, unit_name

_UNIT_ROWS = 3
_COUNTED, _MG = 200.0, (700.0, 1400.0)
_AXES = "xyzw"


_NEEDED = {
    "acc": "accelerometer column (such as 'acc_x [m/s^2]')",
    "quat": "columns of quaternions (such as qw, qx, qy, qz)",
}
"""By quantity the columns without which a table is refused."""


@dataclass(frozen=True)
class _Column:
    """A column of readings with its place in the table."""

    index: int
    title: str
    name: ColumnName


@dataclass(frozen=True)
class _Time:
    """A column of times and its unit, "" where it states none."""

    index: int
    title: str
    unit: str


def read_imu_csv(
    path: str | Path, *, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """Read a table of one or several sensors.

    Columns are named sensor, quantity, axis and unit, as in ``left_foot_acc_x [m/s^2]``, ``accX`` or ``mag_y_ut``
    (:mod:`mbkf.io.imu.column_names`); the sensor may stand in a row of its own above the names, the unit in one
    below. Other columns are ignored. Blank cells are missing samples.

    Args:
        path: The file; commas, semicolons or tabs between cells.
        units: Unit of "acc", "gyr", "mag" or "time" where the names do not state it; see
            :data:`mbkf.io.imu.units.UNITS`.
        rate_hz: Sample rate; by default the one of the time column.

    Returns:
        One record per sensor, in the order of the columns.

    Raises:
        FileFormatError: The file is missing, has no accelerometer columns, or a cell is not a number; names the line.
        InvalidInput: A unit or the rate is not stated anywhere.
        UnknownName: Unknown unit.
    """
    path = Path(path)
    text = read_table_text(path)
    known = defaults_of(text)
    signals = with_reference(table_signals(text, units=units, rate_hz=rate_hz, defaults=known))
    return readings_of(path, signals, rate_hz if rate_hz else None, _note(text) or known.frame)


def read_orientation_csv(path: str | Path, rate_hz: float | None = None) -> tuple[tuple[Signal, ...], str]:
    """Reads the quaternions of a table, which may hold nothing else.

    Args:
        path: The file, as for :func:`read_imu_csv`.
        rate_hz: Sample rate of a table that states no times.

    Returns:
        The signal of each sensor, and the world of the orientations as the file states it.

    Raises:
        FileFormatError: The file is missing, has no columns of quaternions, or a cell is not a number.
        InvalidInput: The rate is not stated anywhere.
    """
    text = read_table_text(Path(path))
    return tuple(table_signals(text, rate_hz=rate_hz, needed="quat")), _note(text)


def table_signals(
    text: TableText,
    *,
    units: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    defaults: TableDefaults = NO_DEFAULTS,
    needed: str = "acc",
) -> list[Signal]:
    """The signals of a table.

    Args:
        text: The table.
        units: Units that the caller states; they overrule the file's.
        rate_hz: Sample rate that the caller states; it overrules times without a unit.
        defaults: What the maker states.
        needed: Quantity without which the table is refused: "acc", or "quat", which is then the only one read.

    Raises:
        FileFormatError: There are no columns of that quantity, or a cell is not a number.
        InvalidInput: A unit or the rate is not stated anywhere.
        UnknownName: Unknown unit.
    """
    given = {kind: unit_name(kind, unit, "--units") for kind, unit in (units or {}).items()}
    text = joined_header(text)
    head, first = _head(text, defaults.kind, needed)
    titles = text.rows[head][1]
    below = [text.rows[k][1] for k in range(head + 1, first)]
    columns = _columns(titles, _sensors_above(text, head), below, defaults.kind)
    if needed == "quat":
        columns = [column for column in columns if column.name.kind == "quat"]
    elif not any(column.name.kind in ("acc", "free", defaults.kind) for column in columns):
        columns = []
    if not columns:
        raise _lacking(text.path, titles, needed)
    times = _time_columns(text.path, titles, below, given, rate_hz)
    if rate_hz is None and not times:
        rate_hz = rate_above(text, head)
    if rate_hz is None and not times:
        raise InvalidInput(f"{text.path}: no column of times; give the sample rate with --rate")
    used = [column.index for column in columns] + [time.index for time in times]
    numbers = _numbers(text, first, len(titles), used)
    factors = _factors(text.path, columns, numbers, given, defaults.units)
    return _signals(
        _complete(text.path, columns),
        numbers,
        factors,
        _clocks(text.path, times, numbers, rate_hz),
    )


def _lacking(path: Path, titles: Sequence[str], needed: str) -> FileFormatError:
    found = ", ".join(title for title in titles[:8] if title)
    counted = next((title for title in titles if in_counts(title)), "")
    hint = f"; '{counted}' holds raw counts: export calibrated readings" if counted else ""
    return FileFormatError(path, f"no {_NEEDED[needed]} among {found}{hint}")


def _head(text: TableText, kind: str, needed: str) -> tuple[int, int]:
    """Index of the row of names and of the first row of numbers."""
    counts = [
        sum(parse_column_name(cell, kind) is not None for cell in cells) for _, cells in text.rows[:400]
    ]
    head = int(np.argmax(counts))
    if counts[head] == 0:
        number, cells = text.rows[0]
        if any(map(is_number, cells)):
            raise FileFormatError(
                text.path, "the first row names no columns; write names such as 'acc_x [m/s^2]'", number
            )
        raise _lacking(text.path, cells, needed)
    first = head + 1
    while (
        first < len(text.rows) and first <= head + _UNIT_ROWS and not any(map(is_number, text.rows[first][1]))
    ):
        first += 1
    if first >= len(text.rows):
        raise FileFormatError(text.path, "cut short: no rows after the column names")
    return head, first


def _sensors_above(text: TableText, head: int) -> list[str]:
    """Names of sensors in the row above the names; a name counts for the blank cells to its right, too."""
    titles = text.rows[head][1]
    if head == 0:
        return [""] * len(titles)
    above = text.rows[head - 1][1]
    if len(above) != len(titles) or any(map(is_number, above)) or sum(map(bool, above)) < 2:
        return [""] * len(titles)
    names, last = [], ""
    for cell in above:
        last = cell or last
        names.append(last)
    return names


def _columns(
    titles: Sequence[str], above: Sequence[str], below: Sequence[Sequence[str]], kind: str
) -> list[_Column]:
    """Every column of readings, one per sensor, quantity and axis: wide-range accelerometers come first."""
    found: dict[tuple[str, str, int], _Column] = {}
    for index, title in enumerate(titles):
        name = parse_column_name(title, kind)
        under = [row[index] for row in below if index < len(row) and row[index]]
        if name is None or any(cell.upper() == "RAW" for cell in under):
            continue
        if not name.unit and name.kind != "quat":
            quantity = "acc" if name.kind == "free" else name.kind
            stated = next((unit for cell in under if (unit := plain_unit(quantity, cell))), "")
            name = replace(name, unit=stated or next((cell for cell in under if cell.upper() != "CAL"), ""))
        sensor = " ".join(filter(None, (above[index], name.sensor)))
        name = replace(name, sensor=sensor)
        key = (name.sensor, name.kind, name.axis)
        if key not in found or (name.wide and not found[key].name.wide):
            found[key] = _Column(index, title, name)
    return sorted(found.values(), key=lambda column: column.index)


def _time_columns(
    path: Path,
    titles: Sequence[str],
    below: Sequence[Sequence[str]],
    given: Mapping[str, str],
    rate_hz: float | None,
) -> list[_Time]:
    """The columns of times; where the caller states a rate, those with a unit only."""
    found = []
    for index, title in enumerate(titles):
        unit = time_unit(title)
        if unit is None:
            continue
        under = (row[index] for row in below if index < len(row))
        unit = unit or next((one for cell in under if (one := plain_unit("time", cell))), "")
        if "time" in given:
            unit = given["time"]
        elif unit:
            unit = unit_name("time", unit, f"{path}, column '{title}'")
        if rate_hz is None or unit:
            found.append(_Time(index, title, unit))
    if rate_hz is not None and not (np.isfinite(rate_hz) and rate_hz > 0.0):
        raise InvalidInput(f"{path}: the rate must be positive, got {rate_hz} Hz")
    return found


def _numbers(text: TableText, first: int, width: int, used: Sequence[int]) -> Array:
    """(T, width) cells, NaN where blank or not used; times of day as seconds."""
    rows = text.rows[first:]
    table = np.full((len(rows), width), np.nan)
    most = max(used)
    for target, (number, row) in zip(table, rows, strict=True):
        if len(row) < width and len(row) <= most and len(row) < 2:
            raise FileFormatError(text.path, f"{len(row)} cells for {width} columns; export it again", number)
        for k in used:
            cell = row[k] if k < len(row) else ""
            if cell:
                try:
                    target[k] = text.number(cell)
                except ValueError as error:
                    raise FileFormatError(
                        text.path, f"'{cell}' is not a number; correct or blank it", number
                    ) from error
    if np.isnan(table).all():
        raise FileFormatError(text.path, "no numbers after the column names")
    return table


def _factors(
    path: Path,
    columns: Sequence[_Column],
    numbers: Array,
    given: Mapping[str, str],
    defaults: Mapping[str, str],
) -> dict[int, float]:
    """Factor to SI (µT for fields) of each column: by the caller's unit, else by the table's, else by the maker's."""
    factors, unknown = {}, dict[str, list[_Column]]()
    for column in columns:
        name = column.name
        kind = "acc" if name.kind == "free" else name.kind
        if kind == "quat":
            factors[column.index] = 1.0
        elif kind in given:
            factors[column.index] = UNITS[kind][given[kind]]
        elif name.unit:
            factors[column.index] = UNITS[kind][
                unit_name(kind, name.unit, f"{path}, column '{column.title}'")
            ]
        elif kind in defaults:
            factors[column.index] = UNITS[kind][defaults[kind]]
        else:
            unknown.setdefault(kind, []).append(column)
    if unknown:
        first = next(iter(unknown.values()))[0].title
        if _are_counts(numbers[:, [column.index for column in unknown.get("acc", ())]]):
            raise InvalidInput(
                f"{path}: column '{first}' and others hold whole numbers of a size that no unit has, so raw counts of "
                "the sensor; multiply them by the scales of its data sheet, and state the units with --units"
            )
        likely = ",".join(
            f"{kind}={_likely(kind, numbers[:, [column.index for column in own]])}"
            for kind, own in unknown.items()
        )
        raise InvalidInput(
            f"{path}: column '{first}' states no unit; by the size of the readings it may be --units {likely} "
            "(correct it where it is not)"
        )
    return factors


def _are_counts(force: Array) -> bool:
    """True for accelerations (T, 3 N) of N sensors in whole numbers whose size is neither that of g nor of mg."""
    known = force[np.isfinite(force).all(axis=1)]
    if not known.size or (known != np.round(known)).any():
        return False
    size = float(np.sqrt(3.0) * np.median(np.sqrt((known**2).mean(axis=1))))
    return size > _COUNTED and not _MG[0] < size < _MG[1]


def _likely(kind: str, values: Array) -> str:
    """The unit that the size of readings speaks for; for a question only."""
    size = np.abs(values[np.isfinite(values).all(axis=1)])
    middle = float(np.median(size.max(axis=1))) if len(size) else 0.0
    large = float(size.max()) if len(size) else 0.0
    if kind == "acc":
        return "g" if middle < 4.0 else "m/s2" if middle < 100.0 else "mg"
    if kind == "gyr":
        return "rad/s" if large < 35.0 else "deg/s" if large < 5e3 else "mdeg/s"
    bounds = {"gauss": 0.08, "au": 0.8, "ut": 8.0, "mgauss": 200.0, "nt": 5e3}
    return "au" if middle < 0.08 else [unit for unit, least in bounds.items() if middle >= least][-1]


def _complete(path: Path, columns: Sequence[_Column]) -> dict[tuple[str, str], list[_Column]]:
    """The columns of each sensor and quantity, in the order of the axes, all of them there."""
    groups = dict[tuple[str, str], list[_Column]]()
    for column in columns:
        groups.setdefault((column.name.sensor, column.name.kind), []).append(column)
    for (sensor, kind), own in groups.items():
        there = {column.name.axis for column in own}
        missing = [f"{kind}_{_AXES[axis]}" for axis in range(signal_width(kind)) if axis not in there]
        if missing:
            raise FileFormatError(
                path, f"sensor '{sensor}' has no column {', '.join(missing)}; export all axes"
            )
        own.sort(key=lambda column: column.name.axis)
    return groups


def _clocks(
    path: Path,
    times: Sequence[_Time],
    numbers: Array,
    rate_hz: float | None,
) -> list[tuple[int, Array]]:
    """Place and (T,) seconds of each clock of the table."""
    if not times:
        assert rate_hz is not None
        return [(-1, np.arange(len(numbers)) / rate_hz)]
    stated = [time for time in times if time.unit]
    chosen = stated or list(times[:1])
    return [
        (time.index, even_times(times_s(path, numbers[:, time.index], time.unit, time.title), rate_hz))
        for time in chosen
    ]


def _signals(
    groups: Mapping[tuple[str, str], list[_Column]],
    numbers: Array,
    factors: Mapping[int, float],
    clocks: Sequence[tuple[int, Array]],
) -> list[Signal]:
    """Each group on the clock that stands nearest to its left; rows behind the end of a clock are dropped."""
    found = []
    for (sensor, kind), own in groups.items():
        left = [clock for clock in clocks if clock[0] < own[0].index]
        time = (left[-1] if left and len(clocks) > 1 else clocks[0])[1]
        values = np.stack([factors[column.index] * numbers[:, column.index] for column in own], axis=1)
        there = np.isfinite(time) if len(clocks) > 1 else np.ones(len(time), dtype=bool)
        found.append(Signal(sensor, kind, time[there], values[there]))
    return found


def _note(text: TableText) -> str:
    """World frame of the orientations, as a comment states it."""
    stated = (line.partition("orientation:")[2].strip() for line in text.comments if "orientation:" in line)
    return next(stated, "")
