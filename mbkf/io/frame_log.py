"""A log that grows row by row and stays readable after a crash: two lines of text, then rows of fixed size.

The first line is JSON: version, type of a row, header. The second is its CRC-32 in hexadecimal. Each row is followed by
its own CRC-32 (four bytes, little endian), that of its place among the rows and of its bytes. A row that was written
stays, also when the process is killed or the disk is full; what follows the first row that is not whole (cut off,
zero-filled after a power cut, overwritten) is left out when the log is read.
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
from mbkf.io.atomic import new_file
from mbkf.io.files_read import opened
from mbkf.io.leftovers import errors_name
from mbkf.io.plain_data import parse_json

FORMAT = "mbkf frame log"
FORMAT_VERSION = 2
"""Version 1 had neither checksum; it is still read, as far as its rows are whole."""

_CHECKSUM = np.dtype("<u4")


class FrameLog(NamedTuple):
    """Contents of a log.

    Attributes:
        header: Plain data that belongs to all rows.
        rows: (T,) rows before the first damaged one.
        left_out: Number of rows from there on, a cut one included.
    """

    header: dict[str, object]
    rows: NDArray
    left_out: int


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
        self.dtype = dtype
        self._size = dtype.itemsize + _CHECKSUM.itemsize
        first = {"format": FORMAT, "format_version": FORMAT_VERSION, "dtype": _plain(dtype), "header": header}
        line = (json.dumps(first) + "\n").encode()
        line += _line_checksum(line)
        self._start = len(line)
        self._file = new_file(self.path)
        try:
            with errors_name(self.path):
                self._write(line)
        except BaseException:
            self._file.close()
            raise

    def append(self, rows: NDArray) -> None:
        """Writes rows; they are with the operating system when this returns.

        Raises:
            OSError: Not all of them could be written. Those that were stay; a cut one is removed.
        """
        plain = np.ascontiguousarray(rows, dtype=self.dtype).view(np.uint8).reshape(len(rows), -1)
        sums = _checksums(plain, self.rows)
        data = np.concatenate([plain, sums.view(np.uint8).reshape(len(rows), -1)], axis=1).tobytes()
        try:
            self._write(data)
        finally:
            size = os.fstat(self._file.fileno()).st_size
            self.rows = (size - self._start) // self._size
            whole = self._start + self.rows * self._size
            if whole != size:
                self._file.truncate(whole)
                self._file.seek(whole)

    def _write(self, data: bytes) -> None:
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) :]

    def close(self) -> None:
        """Ends the log."""
        self._file.close()

    def __enter__(self) -> FrameLogWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def read_frame_log(path: str | Path) -> FrameLog:
    """Header and rows of a log, as far as it is undamaged.

    Raises:
        FileFormatError: The file is missing or no log, or its header is damaged.
    """
    source = Path(path)
    try:
        with opened(source) as file:
            line = file.readline()
            first = parse_json(line)
            version = first["format_version"]
            if first["format"] != FORMAT or version not in range(1, FORMAT_VERSION + 1):
                raise FileFormatError(source, "not a frame log of this version of mbkf")
            if version > 1 and file.readline() != _line_checksum(line):
                raise FileFormatError(source, "not a frame log (its header is damaged)")
            dtype = np.dtype([(name, kind, tuple(shape)) for name, kind, shape in first["dtype"]])
            header, data = dict(first["header"]), file.read()
        return FrameLog(header, *_rows(data, dtype, checked=version > 1))
    except FileNotFoundError as error:
        raise FileFormatError(source, "no such file; 'mbkf live' keeps it while it runs") from error
    except OSError as error:
        raise FileFormatError(source, f"cannot be read ({error.strerror})") from error
    except (ValueError, KeyError, TypeError, ZeroDivisionError, OverflowError, MemoryError) as error:
        raise FileFormatError(source, f"not a frame log ({error})") from error


def _rows(data: bytes, dtype: np.dtype, checked: bool) -> tuple[NDArray, int]:
    """Rows before the first damaged one, and how many there are from there on."""
    size = dtype.itemsize + (_CHECKSUM.itemsize if checked else 0)
    count, cut = divmod(len(data), size)
    stored = np.frombuffer(data, np.uint8, count * size).reshape(count, size)
    plain = np.ascontiguousarray(stored[:, : dtype.itemsize])
    whole = count
    if checked:
        wrong = (
            _checksums(plain, 0) != np.ascontiguousarray(stored[:, dtype.itemsize :]).view(_CHECKSUM)[:, 0]
        )
        whole = int(wrong.argmax()) if wrong.any() else count
    return plain[:whole].view(dtype)[:, 0], count - whole + (cut > 0)


def _checksums(plain: NDArray[np.uint8], first: int) -> NDArray[np.uint32]:
    """(n,) CRC-32 of rows (n, bytes), of which the first has that place in the log."""
    places = np.arange(first, first + len(plain), dtype="<u8").tobytes()
    crc = zlib.crc32
    return np.fromiter(
        (crc(row, crc(places[8 * k : 8 * k + 8])) for k, row in enumerate(plain)), _CHECKSUM, len(plain)
    )


def _line_checksum(line: bytes) -> bytes:
    return b"%08x\n" % zlib.crc32(line)


def _plain(dtype: np.dtype) -> list[list[Any]]:
    """Name, kind and shape of each field."""
    fields: Any = dtype.fields or {}
    described = []
    for name in dtype.names or ():
        base, shape = (fields[name][0].subdtype) or (fields[name][0], ())
        described.append([name, base.str, list(shape)])
    return described
