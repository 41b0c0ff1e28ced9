"""A log that grows row by row and stays readable after a crash: one line of JSON, then rows of fixed size.

A row that was written stays, also when the process is killed or the disk is full. Behind each row stands its CRC-32,
which begins with the row's place, so that what a power cut left of the end (zeros, a part of a row, old blocks of a
disk) is known and left out.
"""

from __future__ import annotations

import json
import os
import zlib
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import FileFormatError
from mbkf.io.plain_data import parse_json

FORMAT = "mbkf frame log"
FORMAT_VERSION = 2
"""Version 1 had no checksums."""

CHECKSUM = np.dtype("<u4")


class FrameLogWriter:
    """Appends rows to a new log.

    Attributes:
        path: The file.
        rows: How many rows lie in it.
        dtype: Type of a row.
    """

    def __init__(self, path: str | Path, dtype: np.dtype, header: dict[str, object]) -> None:
        """Creates the file.

        Args:
            path: The file.
            dtype: Type of a row.
            header: Plain data that belongs to all rows.

        Raises:
            OSError: The file cannot be written.
        """
        self.path, self.rows = Path(path), 0
        self.dtype, self._size = dtype, dtype.itemsize + CHECKSUM.itemsize
        first = {"format": FORMAT, "format_version": FORMAT_VERSION, "dtype": _plain(dtype), "header": header}
        self._file = self.path.open("wb", buffering=0)
        line = (json.dumps(first) + "\n").encode()
        self._start = len(line)
        self._write(line)

    def append(self, rows: NDArray) -> None:
        """Writes rows; they are with the operating system when this returns.

        Raises:
            OSError: Not all of them could be written. Those that were stay; a cut one is removed.
        """
        plain = np.ascontiguousarray(rows, dtype=self.dtype)
        try:
            self._write(_with_checksums(plain, self.rows))
        finally:
            size = os.fstat(self._file.fileno()).st_size
            self.rows = (size - self._start) // self._size
            whole = self._start + self.rows * self._size
            if whole != size:
                self._file.truncate(whole)
                self._file.seek(whole)

    def _write(self, data: bytes | memoryview) -> None:
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) :]

    def close(self) -> None:
        """No more rows."""
        self._file.close()

    def __enter__(self) -> FrameLogWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class FrameLog(NamedTuple):
    """Contents of a log.

    Attributes:
        header: Plain data that belongs to all rows.
        rows: (N,) rows up to the first one that is damaged.
        damaged: How many rows follow that are not as they were written, a part of one counted.
    """

    header: dict[str, object]
    rows: NDArray
    damaged: int


def read_frame_log(path: str | Path) -> FrameLog:
    """Header and rows of a log, as far as they are as they were written.

    Raises:
        FileFormatError: The file is missing or no log.
    """
    source = Path(path)
    try:
        with source.open("rb") as file:
            first = parse_json(file.readline())
            version = first["format_version"]
            if first["format"] != FORMAT or version > FORMAT_VERSION:
                raise FileFormatError(source, "not a frame log of this version of mbkf")
            dtype = np.dtype([(name, kind, tuple(shape)) for name, kind, shape in first["dtype"]])
            header, data = dict(first["header"]), file.read()
        checked = CHECKSUM.itemsize if version > 1 else 0
        size = dtype.itemsize + checked
        stored = np.frombuffer(data[: len(data) // size * size], dtype=np.uint8).reshape(-1, size)
        good = _good_rows(stored) if checked else len(stored)
        rows = np.frombuffer(stored[:good, : dtype.itemsize].tobytes(), dtype=dtype)
        return FrameLog(header, rows, len(stored) - good + (len(data) % size > 0))
    except FileNotFoundError as error:
        raise FileFormatError(source, "no such file; 'mbkf live' keeps it while it runs") from error
    except OSError as error:
        raise FileFormatError(source, f"cannot be read ({error.strerror})") from error
    except (ValueError, KeyError, TypeError, ZeroDivisionError, OverflowError, MemoryError) as error:
        raise FileFormatError(source, f"not a frame log ({error})") from error


def _with_checksums(rows: NDArray, first: int) -> memoryview:
    """The bytes of rows, each followed by its checksum.

    Args:
        rows: (N,) the rows, contiguous.
        first: Place of the first one in the log.
    """
    size = rows.dtype.itemsize
    stored = np.empty((len(rows), size + CHECKSUM.itemsize), dtype=np.uint8)
    stored[:, :size] = np.frombuffer(rows.tobytes(), dtype=np.uint8).reshape(len(rows), size)
    sums = [zlib.crc32(row[:size].data, first + k) for k, row in enumerate(stored)]
    stored[:, size:] = np.array(sums, dtype=CHECKSUM).view(np.uint8).reshape(len(rows), -1)
    return memoryview(stored.tobytes())


def _good_rows(stored: NDArray[np.uint8]) -> int:
    """How many rows from the first on fit their checksums, (N, S) bytes."""
    sums = np.ascontiguousarray(stored[:, -CHECKSUM.itemsize :]).view(CHECKSUM)[:, 0]
    for k, row in enumerate(stored):
        if zlib.crc32(row[: -CHECKSUM.itemsize].data, k) != sums[k]:
            return k
    return len(stored)


def _plain(dtype: np.dtype) -> list[list[Any]]:
    """Name, kind and shape of each field."""
    fields: Any = dtype.fields or {}
    described = []
    for name in dtype.names or ():
        base, shape = (fields[name][0].subdtype) or (fields[name][0], ())
        described.append([name, base.str, list(shape)])
    return described
