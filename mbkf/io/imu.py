"""Readings of inertial sensors as an immutable record, and CSV tables of them with their units."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray, read_only
from mbkf.errors import FileFormatError, InvalidInput, ShapeError, UnknownName

UNITS: dict[str, dict[str, float]] = {
    "acc": {"m/s2": 1.0, "g": GRAVITY_M_S2, "mg": 1e-3 * GRAVITY_M_S2},
    "gyr": {"rad/s": 1.0, "deg/s": np.pi / 180.0, "mdeg/s": 1e-3 * np.pi / 180.0},
    "mag": {"ut": 1.0, "nt": 1e-3, "t": 1e6, "gauss": 100.0, "mgauss": 0.1, "au": 1.0},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
}
"""Units of each quantity in a table and their factor to m/s², rad/s, µT and s; "au" is a field of unknown size."""

_SPELLINGS = {
    "m/s/s": "m/s2", "ms2": "m/s2", "ms-2": "m/s2", "mps2": "m/s2",
    "rads-1": "rad/s", "degs-1": "deg/s",
    "rads": "rad/s", "radps": "rad/s", "degs": "deg/s", "dps": "deg/s", "degps": "deg/s",
    "mdps": "mdeg/s", "a.u.": "au", "arbitrary": "au", "normalized": "au",
    "normalised": "au", "microtesla": "ut", "sec": "s", "seconds": "s", "msec": "ms", "usec": "us",
}  # fmt: skip

_READING = re.compile(
    r"(?P<sensor>.*?)[\s_.:\-]*"
    r"(?P<kind>free_?acc|acc(?:el(?:eration|erometer)?)?|specific_?force|gyro?(?:scope)?|angular_?velocity|omega"
    r"|mag(?:netic_?field|netometer|net)?|quat(?:ernion)?)"
    r"[\s_.:\-]*(?P<axis>[wxyz])(?:[\s_.:\-(\[]+(?P<unit>.*?)[)\]]?)?",
    re.IGNORECASE,
)
_TIME = re.compile(
    r"(?:time(?:_?stamp)?|t|seconds|zeit|tiempo)(?:[\s_.:\-(\[]+(?P<unit>.*?)[)\]]?)?", re.IGNORECASE
)
_MOST_GAPS = 3
_COMMENT = ("#", "//", "%")


_KINDS = {"a": "acc", "s": "acc", "g": "gyr", "o": "gyr", "m": "mag", "q": "quat"}
"""Quantity by the first letter of its word, but for "angular velocity"."""


@dataclass(frozen=True)
class ImuReadings:
    """Readings of one inertial sensor, in its own axes.

    Attributes:
        name: Sensor name, e.g. the segment that carries it.
        time_s: (T,) sample times, s.
        specific_force_mps2: (T, 3) accelerometer: acceleration minus gravity, m/s²; at rest it points up.
        angular_velocity_rad_s: (T, 3) gyroscope, rad/s; NaN throughout where the file has none.
        magnetic_field: (T, 3) magnetometer, µT; None where there is none.
        rate_hz: Nominal sample rate.
        frame: A note on the sensor's axes or the file's world frame, "" where nothing is known.
        orientation: (T, 4) sensor → world as unit quaternions (x, y, z, w) where the file brings one (an optical
            reference, or the maker's own filter), else None; ``frame`` names that world.
        moving: (T,) samples that the file marks as those of a movement; None where it marks none.

    Missing samples are NaN.
    """

    name: str
    time_s: Array
    specific_force_mps2: Array
    angular_velocity_rad_s: Array
    magnetic_field: Array | None
    rate_hz: float
    frame: str = ""
    orientation: Array | None = None
    moving: BoolArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_s", read_only(self.time_s))
        if self.time_s.ndim != 1:
            raise ShapeError("time_s", "(T,)", self.time_s.shape)
        widths = {
            "specific_force_mps2": 3,
            "angular_velocity_rad_s": 3,
            "magnetic_field": 3,
            "orientation": 4,
        }
        for name, width in widths.items():
            value = getattr(self, name)
            if value is None:
                continue
            array = read_only(value)
            if array.shape != (len(self.time_s), width):
                raise ShapeError(name, f"({len(self.time_s)}, {width})", array.shape)
            object.__setattr__(self, name, array)
        if self.moving is not None:
            flags = np.array(self.moving, dtype=bool)
            flags.flags.writeable = False
            if flags.shape != self.time_s.shape:
                raise ShapeError("moving", f"({len(self.time_s)},)", flags.shape)
            object.__setattr__(self, "moving", flags)
        if not (np.isfinite(self.rate_hz) and self.rate_hz > 0.0):
            raise InvalidInput(f"sensor {self.name}: the rate must be positive, got {self.rate_hz} Hz")

    @property
    def samples(self) -> int:
        """Number of samples T."""
        return len(self.time_s)


@dataclass(frozen=True)
class _Column:
    """Where a quantity stands in a table: index, sensor, quantity, axis, factor to the record's unit."""

    index: int
    sensor: str
    kind: str
    axis: str
    factor: float


def read_imu_csv(
    path: str | Path, *, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """Read a table of one or several sensors.

    Columns are named sensor, quantity, axis and unit, as in ``left_foot_acc_x [m/s^2]``, ``Gyr_Z (deg/s)`` or
    ``mag_y_ut``; the sensor may stand in a row of its own above the names. Other columns are ignored. Blank cells
    are missing samples.

    Args:
        path: The file; commas, semicolons or tabs between cells.
        units: Unit of "acc", "gyr", "mag" or "time" where the names do not state it; see :data:`UNITS`.
        rate_hz: Sample rate; by default the one of the time column.

    Returns:
        One record per sensor, in the order of the columns.

    Raises:
        FileFormatError: The file is missing, has no accelerometer columns, or a cell is no number; names the line.
        InvalidInput: A unit or the rate is not stated anywhere.
        UnknownName: Unknown unit.
    """
    path = Path(path)
    lines = _lines(path)
    given = {kind: unit_name(kind, unit, "--units") for kind, unit in (units or {}).items()}
    names, first = _column_names(path, lines)
    columns = _columns(path, names, given)
    time = _time_column(path, names, given, rate_hz)
    used = [column.index for column in columns] + ([] if time is None else [time.index])
    table = _numbers(path, lines, first, len(names), used)
    if time is None or rate_hz is not None:
        rate = float(rate_hz or 0.0)
        time_s = np.arange(len(table)) / rate if time is None else time.factor * table[:, time.index]
    else:
        time_s = time.factor * table[:, time.index]
        rate = rate_of(time_s, str(path))
    sensors = dict.fromkeys(column.sensor for column in columns)
    chosen = {name: [column for column in columns if column.sensor == name] for name in sensors}
    return tuple(_sensor(path, name, own, table, time_s, rate) for name, own in chosen.items())


def on_regular_grid(one: ImuReadings) -> ImuReadings:
    """The readings at times that are a whole number of steps apart; lost samples become missing ones.

    Raises:
        InvalidInput: The times do not increase, or gaps make up most of the recording.
    """
    row = np.round((one.time_s - one.time_s[0]) * one.rate_hz).astype(int)
    if len(row) == row[-1] + 1 and (np.diff(row) == 1).all():
        return one
    if (np.diff(one.time_s) <= 0.0).any():
        raise InvalidInput(f"sensor {one.name}: its times do not increase; sort the file")
    count = int(row[-1]) + 1
    if count > _MOST_GAPS * len(row):
        raise InvalidInput(
            f"sensor {one.name}: {count - len(row)} of {count} samples are missing; check the rate"
        )
    known, first = np.unique(row, return_index=True)

    def spread(values: Array | None) -> Array | None:
        if values is None:
            return None
        grid = np.full((count, values.shape[1]), np.nan)
        grid[known] = values[first]
        return grid

    force, rate = spread(one.specific_force_mps2), spread(one.angular_velocity_rad_s)
    assert force is not None and rate is not None
    times = one.time_s[0] + np.arange(count) / one.rate_hz
    field, orientation = spread(one.magnetic_field), spread(one.orientation)
    moving = None
    if one.moving is not None:
        moving = np.zeros(count, dtype=bool)
        moving[known] = one.moving[first]
    return ImuReadings(one.name, times, force, rate, field, one.rate_hz, one.frame, orientation, moving)


def unit_name(kind: str, text: str, where: str) -> str:
    """The unit of :data:`UNITS` that a text means, in any of its spellings.

    Args:
        kind: Quantity, a key of :data:`UNITS`.
        text: The unit as written.
        where: Where it stands, for the message.

    Raises:
        UnknownName: There is no such quantity or unit.
    """
    if kind not in UNITS:
        raise UnknownName("quantity", kind, UNITS, where)
    plain = text.strip().lower().replace("µ", "u").replace("μ", "u").replace("²", "2").replace("°", "deg")
    plain = re.sub(r"[\s_^*·]", "", plain)
    plain = _SPELLINGS.get(plain, plain)
    if plain not in UNITS[kind]:
        raise UnknownName(f"unit of {kind}", text, UNITS[kind], where)
    return plain


def rate_of(time_s: Array, where: str) -> float:
    """Sample rate, Hz, from the usual step between times (T,), which gaps do not change.

    Raises:
        InvalidInput: The times do not increase.
    """
    steps = np.diff(time_s[np.isfinite(time_s)])
    usual = float(np.median(steps)) if len(steps) else 0.0
    if usual <= 0.0:
        raise InvalidInput(f"{where}: the times do not increase; give the rate with --rate")
    regular = steps[np.abs(steps - usual) < 0.5 * usual]
    return 1.0 / float(regular.mean())


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Line number and cells of every line that is neither blank nor a comment."""
    if not path.is_file():
        raise FileFormatError(path, "no such file; name a CSV table of inertial readings")
    text = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    kept = [
        (number, line)
        for number, line in enumerate(text, start=1)
        if line.strip(" ,;\t") and not line.lstrip().startswith(_COMMENT)
    ]
    if len(kept) < 2:
        raise FileFormatError(path, "cut short: no rows after the column names")
    delimiter = max(",;\t", key=kept[0][1].count)
    cells = csv.reader((line for _, line in kept), delimiter=delimiter)
    try:
        return [(number, row) for (number, _), row in zip(kept, cells, strict=True)]
    except (csv.Error, ValueError) as error:  # a quotation mark that does not end joins rows
        raise FileFormatError(path, f"damaged ({error}); export it again") from error


def _column_names(path: Path, lines: Sequence[tuple[int, list[str]]]) -> tuple[list[str], int]:
    """Names with their sensor, and the index of the first row of numbers."""
    heads = 0
    while heads < len(lines) and heads < 3 and not any(map(_is_number, lines[heads][1])):
        heads += 1
    if heads == 0:
        raise FileFormatError(
            path, "the first row names no columns; write names such as 'acc_x [m/s^2]'", lines[0][0]
        )
    rows = [row for _, row in lines[:heads]]
    width = max(len(row) for row in rows)
    parts = [[row[k].strip() if k < len(row) else "" for row in rows] for k in range(width)]
    if heads == 1:
        return [part[0] for part in parts], 1
    if any(_READING.fullmatch(part[0]) for part in parts):  # names first, then a row of units
        return [f"{part[0]} [{part[1]}]" if part[1] else part[0] for part in parts], heads
    return [" ".join(filter(None, part)) for part in parts], heads


def _columns(path: Path, names: Sequence[str], given: Mapping[str, str]) -> list[_Column]:
    """Every column of a sensor with its unit."""
    columns = []
    for index, name in enumerate(names):
        match = _READING.fullmatch(name.strip())
        if match is None or match["kind"].lower().startswith("free"):
            continue
        kind = "gyr" if match["kind"].lower().startswith("ang") else _KINDS[match["kind"][0].lower()]
        columns.append(
            _Column(
                index,
                match["sensor"].strip(" _.:-"),
                kind,
                match["axis"].lower(),
                _factor(path, name, kind, match["unit"], given),
            )
        )
    if not any(column.kind == "acc" for column in columns):
        found = ", ".join(name for name in names[:8] if name)
        raise FileFormatError(path, f"no accelerometer column (such as 'acc_x [m/s^2]') among {found}")
    return columns


def _time_column(
    path: Path, names: Sequence[str], given: Mapping[str, str], rate_hz: float | None
) -> _Column | None:
    """The first column of times; None where there is none but a rate is given."""
    for index, name in enumerate(names):
        match = _TIME.fullmatch(name.strip())
        if match is not None and (rate_hz is None or match["unit"] or "time" in given):
            return _Column(index, "", "time", "", _factor(path, name, "time", match["unit"], given))
    if rate_hz is None:
        raise InvalidInput(f"{path}: no column of times; give the sample rate with --rate")
    if not (np.isfinite(rate_hz) and rate_hz > 0.0):
        raise InvalidInput(f"{path}: the rate must be positive, got {rate_hz} Hz")
    return None


def _factor(path: Path, name: str, kind: str, unit: str | None, given: Mapping[str, str]) -> float:
    """Factor to SI (µT for fields): by the caller's unit, else by the name's; seconds for bare times."""
    if kind == "quat":
        return 1.0
    if kind in given:
        return UNITS[kind][given[kind]]
    if unit:
        return UNITS[kind][unit_name(kind, unit, f"{path}, column '{name}'")]
    if kind == "time":
        return 1.0
    example = next(iter(UNITS[kind]))
    raise InvalidInput(
        f"{path}: column '{name}' states no unit; write it as '{name} [{example}]' or give --units {kind}={example}"
    )


def _numbers(
    path: Path, lines: Sequence[tuple[int, list[str]]], first: int, width: int, used: Sequence[int]
) -> Array:
    """(T, width) cells, NaN where blank or not used."""
    table = np.full((len(lines) - first, width), np.nan)
    for target, (number, row) in zip(table, lines[first:], strict=True):
        if len(row) < width and len(row) <= max(used):
            raise FileFormatError(path, f"{len(row)} cells for {width} columns; export it again", number)
        for k in used:
            text = row[k].strip()
            if text:
                try:
                    target[k] = float(text)
                except ValueError as error:
                    raise FileFormatError(
                        path, f"'{text}' is not a number; correct or blank it", number
                    ) from error
    if np.isnan(table).all():
        raise FileFormatError(path, "no numbers after the column names")
    return table


def _sensor(
    path: Path, name: str, columns: Sequence[_Column], table: Array, time_s: Array, rate_hz: float
) -> ImuReadings:
    """The record of one sensor; an accelerometer is needed, the others are not."""
    values = {}
    for kind, axes in (("acc", "xyz"), ("gyr", "xyz"), ("mag", "xyz"), ("quat", "xyzw")):
        own = {column.axis: column for column in columns if column.kind == kind}
        missing = [f"{kind}_{axis}" for axis in axes if axis not in own]
        if own and missing:
            raise FileFormatError(
                path, f"sensor '{name}' has no column {', '.join(missing)}; export all axes"
            )
        if own:
            values[kind] = np.stack([own[axis].factor * table[:, own[axis].index] for axis in axes], axis=1)
    if "acc" not in values:
        raise FileFormatError(
            path, f"sensor '{name}' has no accelerometer; export its acc_x, acc_y and acc_z"
        )
    nothing = np.full((len(time_s), 3), np.nan)
    return ImuReadings(
        name or path.stem,
        time_s,
        values["acc"],
        values.get("gyr", nothing),
        values.get("mag"),
        rate_hz,
        _note(path) if "quat" in values else "",
        values.get("quat"),
    )


def _note(path: Path) -> str:
    """World frame of the orientations, as a comment states it."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        for line in file:
            if not line.startswith(_COMMENT):
                return ""
            if "orientation:" in line:
                return line.partition("orientation:")[2].strip()
    return ""


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return bool(cell.strip())
