"""Several files of one session, of whatever form each, as sensors on one clock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import opened
from mbkf.io.imu.clocks import on_one_clock
from mbkf.io.imu.column_names import parse_column_name
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.text import decoded

_TEXTS = (".csv", ".tsv", ".txt")
_HEAD_BYTES = 1 << 16
_ANALOG = (".c3d",)
"""Files that lie in such folders for their markers, too."""


def sensor_files(folder: Path, suffixes: Sequence[str]) -> list[Path]:
    """The files of a folder that hold readings of sensors, by suffix and, of texts, by the names of their columns."""
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and path.suffix.lower() in suffixes]
    return [
        path
        for path in files
        if path.suffix.lower() not in _ANALOG and (path.suffix.lower() not in _TEXTS or names_readings(path))
    ]


def read_together(
    paths: Sequence[Path],
    read: Callable[[Path], tuple[ImuReadings, ...]],
    *,
    started_together: bool = False,
) -> tuple[ImuReadings, ...]:
    """The sensors of several files on one clock, each under a name of its own.

    A sensor of a file of its own is called as the file where names would be the same.

    Args:
        paths: The files.
        read: Reads a file.
        started_together: All recordings started at the same moment, whatever their clocks say.

    Raises:
        FileFormatError: A file is broken.
        InvalidInput: The sensors have no time in common.
    """
    found = [(path, one) for path in paths for one in read(path)]
    named = []
    for path, one in found:
        same = [other for _, other in found if other.name == one.name]
        own = [other for place, other in found if place == path]
        name = path.stem if len(own) == 1 else f"{path.stem}_{one.name}"
        named.append(replace(one, name=name) if len(same) > 1 else one)
    return on_one_clock(named, started_together=started_together)


def read_folder(
    folder: Path, suffixes: Sequence[str], read: Callable[[Path], tuple[ImuReadings, ...]]
) -> tuple[ImuReadings, ...]:
    """The sensors of a folder with a file, or several, for each.

    Args:
        folder: The folder.
        suffixes: Endings of files that can be read.
        read: Reads a file.

    Raises:
        FileFormatError: The folder holds no sensor's file, or one is broken.
        InvalidInput: The sensors have no time in common.
    """
    files = sensor_files(folder, suffixes)
    if not files:
        raise FileFormatError(folder, "no file of inertial readings in this folder")
    return read_together(files, read)


def names_readings(path: Path) -> bool:
    """True for a text with a row near its beginning that names three or more columns of readings.

    Args:
        path: The file.
    """
    with opened(path) as file:
        head = decoded(file.read(_HEAD_BYTES))
    rows = (line.replace("\t", ",").replace(";", ",").split(",") for line in head.splitlines()[:100])
    return any(sum(parse_column_name(cell.strip('" ')) is not None for cell in row) >= 3 for row in rows)
