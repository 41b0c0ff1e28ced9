"""A result as a wide table: a row a frame, a column a number, its unit at the end of its name; and its key numbers.

Names hold letters, digits and underscores, so that pandas and R keep them; markers that would be called alike get a
number (``R_TOE``, ``R_TOE_2``). An unknown number is an empty field.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.atomic import replacing_text
from mbkf.io.contacts import Source
from mbkf.io.dimensions import ANGLE, AXES
from mbkf.io.labels import unique_labels
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import BLOCK

Column = Array | NDArray[np.str_]

FIRST = ("time_s", "tracked", "valid", "measured")
"""Names of the first columns, by which the file is recognised as mbkf's."""

_DIGITS = 10
"""Significant digits: steps of 0.1 nm and 0.1 mN."""

_DEGREES = ("deg", float(np.degrees(1.0)))


def write_result_csv(r: Reconstruction, path: str | Path) -> None:
    """Writes the table.

    Args:
        r: The result.
        path: The file, replaced whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    write_csv((r.part(slice(begin, begin + BLOCK)) for begin in range(0, max(r.frames, 1), BLOCK)), path)


def write_csv(blocks: Iterable[Reconstruction], path: str | Path) -> None:
    """Writes the table of a result that comes in blocks of frames.

    Args:
        blocks: The blocks, one at least, in order.
        path: The file, replaced whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    rest = iter(blocks)
    first = next(rest)  # a result that cannot be read leaves no folder
    with replacing_text(path) as file:
        for block in chain([first], rest):
            columns = dict(csv_columns(block))
            rows = zip(*(_texts(column) for column in columns.values()), strict=True)
            file.write(csv_text(tuple(columns) if block is first else (), rows))


def csv_text(names: Sequence[str], rows: Iterator[Sequence[str]]) -> str:
    """Lines of a table with a heading, unless its names are empty; separated by commas."""
    made = io.StringIO()
    writer = csv.writer(made, lineterminator="\n")
    writer.writerows([names] if names else [])
    writer.writerows(rows)
    return made.getvalue()


def _texts(column: Column) -> list[str]:
    if column.dtype.kind == "U":
        return column.tolist()
    known = np.isfinite(column)
    return [f"{one:.{_DIGITS}g}" if seen else "" for one, seen in zip(column.tolist(), known, strict=True)]


def csv_columns(r: Reconstruction) -> Iterator[tuple[str, Column]]:
    """Names and values (T,) of the columns: time and flags, coordinates, loads, the residual, markers.

    Args:
        r: The result.
    """
    yield from zip(FIRST, (r.times_s, r.tracked, r.valid, r.measured), strict=True)
    yield from _coordinates(r)
    yield from _loads(r)
    for kind, values, unit in (
        ("residual_force", r.residual_force_n, "n"),
        ("residual_moment", r.residual_moment_nm, "nm"),
    ):
        yield from _along(kind, values, unit)
    yield from _markers(r)


def _coordinates(r: Reconstruction) -> Iterator[tuple[str, Column]]:
    """Each coordinate with its spread, rate, moment and power; deg, m, N m and W, of translations N."""
    for name in r.coordinate_names:
        long = ANGLE.of(name) == "m"
        unit, factor = ("m", 1.0) if long else _DEGREES
        load, load_unit = ("force", "n") if long else ("moment", "nm")
        yield f"{name}_{unit}", factor * r.angle(name)
        yield f"{name}_sd_{unit}", factor * r.angle_sd(name)
        yield f"{name}_rate_{unit}_s", factor * r.angle_rate(name)
        yield f"{name}_{load}_{load_unit}", r.moment(name)
        yield f"{name}_{load}_sd_{load_unit}", r.moment_sd(name)
        if r.angles_read == "model":
            yield f"{name}_power_w", r.power(name)


def _loads(r: Reconstruction) -> Iterator[tuple[str, Column]]:
    """Force, moment about the world's origin, place and source of the load on each part that may bear one."""
    loads = r.loads
    words = np.array([one.name.lower() for one in Source])
    for k, part in enumerate(loads.names):
        yield from _along(f"{part}_force", loads.wrench[:, k, :3], "n")
        yield from _along(f"{part}_force_sd", loads.wrench_sd[:, k, :3], "n")
        yield from _along(f"{part}_moment", loads.wrench[:, k, 3:], "nm")
        yield from _along(f"{part}_point", loads.point_m[:, k], "m")
        yield f"{part}_source", words[loads.source[:, k].astype(int)]


def _markers(r: Reconstruction) -> Iterator[tuple[str, Column]]:
    """Places of each marker as measured, then on the body, m."""
    names = unique_labels([plain(name) for name in r.marker_names], [])
    called = unique_labels([*names, *(f"{name}_model" for name in names)], [])
    for k, (measured, on_body) in enumerate(zip(called[: len(names)], called[len(names) :], strict=True)):
        yield from _along(measured, r.measured_m[:, k], "m")
        yield from _along(on_body, r.predicted_m[:, k], "m")


def _along(name: str, values: Array, unit: str) -> Iterator[tuple[str, Column]]:
    """Columns of (T, 3) vectors in world axes."""
    for axis, column in zip(AXES["xyz"].labels, values.T, strict=True):
        yield f"{name}_{axis}_{unit}", column


def plain(name: str) -> str:
    """A name of letters, digits and underscores."""
    return "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in name)


def leaves(value: object, path: str = "") -> Iterator[tuple[str, object]]:
    """Values inside plain data with their paths, e.g. ``nis.markers``; parts of a list are numbered from 1."""
    if isinstance(value, Mapping):
        parts: Iterable[tuple[str, object]] = ((str(name), inner) for name, inner in value.items())
    elif isinstance(value, list | tuple):
        parts = ((str(number), inner) for number, inner in enumerate(value, start=1))
    else:
        yield path, value
        return
    for name, inner in parts:
        yield from leaves(inner, f"{path}.{name}" if path else name)
