"""A log that grows row by row and stays readable after a crash: one line of JSON, then rows of fixed size.

A row that was written stays, also when the process is killed or the disk is full; a row cut off at the end is ignored.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import FileFormatError

FORMAT = "mbkf frame log"
FORMAT_VERSION = 1


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
        data = np.ascontiguousarray(rows, dtype=self.dtype).tobytes()
        try:
            self._write(data)
        finally:
            size = os.fstat(self._file.fileno()).st_size
            self.rows = (size - self._start) // self.dtype.itemsize
            whole = self._start + self.rows * self.dtype.itemsize
            if whole != size:
                self._file.truncate(whole)
                self._file.seek(whole)

    def _write(self, data: bytes) -> None:
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


def read_frame_log(path: str | Path) -> tuple[dict[str, object], NDArray]:
    """Header and rows of a log; a row cut off at its end is left out.

    Raises:
        FileFormatError: The file is missing or no log.
    """
    source = Path(path)
    try:
        with source.open("rb") as file:
            first = json.loads(file.readline())
            if first["format"] != FORMAT or first["format_version"] > FORMAT_VERSION:
                raise FileFormatError(source, "not a frame log of this version of mbkf")
            dtype = np.dtype([(name, kind, tuple(shape)) for name, kind, shape in first["dtype"]])
            header, data = dict(first["header"]), file.read()
        return header, np.frombuffer(data[: len(data) // dtype.itemsize * dtype.itemsize], dtype=dtype)
    except FileNotFoundError as error:
        raise FileFormatError(source, "no such file; 'mbkf live' keeps it while it runs") from error
    except (ValueError, KeyError, TypeError, ZeroDivisionError, OverflowError, MemoryError) as error:
        raise FileFormatError(source, f"not a frame log ({error})") from error


def _plain(dtype: np.dtype) -> list[list[Any]]:
    """Name, kind and shape of each field."""
    fields: Any = dtype.fields or {}
    described = []
    for name in dtype.names or ():
        base, shape = (fields[name][0].subdtype) or (fields[name][0], ())
        described.append([name, base.str, list(shape)])
    return described
