"""HDF5 files that may be damaged: sealed with a checksum, since the library may end the process on damage or never end.

The seal is a line of text in the file's user block, the first 512 bytes, which HDF5 leaves to applications; a second
line may hold the run that wrote the file. Older files have neither and are read as they are.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO, FileIO
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from mbkf.io.files_read import PIECE_BYTES, opened

if TYPE_CHECKING:
    import h5py
    from _typeshed import ReadableBuffer

DAMAGED = (
    OSError, RuntimeError, KeyError, TypeError, ValueError, AttributeError, IndexError, OverflowError, MemoryError,
)  # fmt: skip
"""Errors that h5py, and code that works on its objects, raise of damaged files."""

SEAL, USER_BLOCK = b"mbkf: %d bytes after this block, CRC-32 %08x\n", 512
"""The line, and the block that it begins."""

RUN = b"run "
"""Beginning of the second line."""

HDF5 = b"\x89HDF\r\n\x1a\n"
"""Beginning of HDF5, at the start of the file or after the user block."""

MOST_COMPRESSED, SPARE_BYTES = 1100, 1 << 20
"""Deflate makes nothing smaller than a thousandth; and room for the rest of a file."""


def array(
    file: h5py.File, key: str, dtype: np.dtype | type | None = None, rows: slice | None = None
) -> NDArray:
    """A dataset as an array.

    Args:
        file: The file.
        key: Name of the dataset.
        dtype: Type of the array; the dataset's own by default.
        rows: The rows to read; None for all.

    Raises:
        ValueError: It claims to be larger than the file can hold.
    """
    dataset = file[key]
    if dataset.nbytes > MOST_COMPRESSED * file.id.get_filesize() + SPARE_BYTES:
        raise ValueError(f"'{key}' claims {dataset.nbytes} bytes, more than the file can hold")
    return np.asarray(dataset[() if rows is None else rows], dtype=dtype)


def sealed(made: BytesIO, run_id: str = "") -> memoryview:
    """A file, made with ``userblock_size=USER_BLOCK``, with its seal and the run that it belongs to; in place."""
    content = made.getbuffer()
    body = content[USER_BLOCK:]
    content[:USER_BLOCK] = _block(len(body), zlib.crc32(body), run_id)
    return content


class WrittenFile(FileIO):
    """A file for HDF5 to write, which keeps the system's refusals: HDF5 ends the process where it meets one."""

    def __init__(self, path: Path) -> None:
        """Makes the file.

        Args:
            path: The file.

        Raises:
            OSError: It cannot be made.
        """
        super().__init__(path, "w+")
        self._path = path
        self._error: OSError | None = None

    def write(self, data: ReadableBuffer, /) -> int:
        """Writes all data, or none after a refusal; the size is that of the data in either case."""
        rest = memoryview(data).cast("B")
        size = len(rest)
        while rest and self._error is None:
            try:
                rest = rest[super().write(rest) or 0 :]
            except OSError as error:
                self._error = error
        return size

    def truncate(self, size: int | None = None, /) -> int:
        """Sets the size."""
        try:
            return super().truncate(size)
        except OSError as error:
            self._error = self._error or error
            return size or 0

    @contextmanager
    def checked(self) -> Iterator[None]:
        """Reports a refusal at the end of the block, in place of HDF5's errors that follow from it.

        Raises:
            OSError: A write was refused, for example on a full disk.
        """
        try:
            yield
        finally:
            if self._error is not None:
                raise OSError(self._error.errno, self._error.strerror, str(self._path))


def seal_file(path: Path, run_id: str = "") -> None:
    """Seals a file as :func:`sealed` does, in place and without reading it into memory.

    Args:
        path: The file, made with ``userblock_size=USER_BLOCK``.
        run_id: Number that the files of one run share.

    Raises:
        OSError: It cannot be read or written.
    """
    with path.open("r+b") as file:
        size, checksum = _checked(file)
        file.seek(0)
        file.write(_block(size, checksum, run_id))


def _block(size: int, checksum: int, run_id: str) -> bytes:
    """The user block of a body of so many bytes."""
    run = RUN + run_id.encode() + b"\n" if run_id else b""
    return (SEAL % (size, checksum) + run).ljust(USER_BLOCK, b"\0")


def _checked(file: BinaryIO) -> tuple[int, int]:
    """Size and checksum of an open file's body."""
    file.seek(USER_BLOCK)
    size = checksum = 0
    while piece := file.read(PIECE_BYTES):
        size, checksum = size + len(piece), zlib.crc32(piece, checksum)
    return size, checksum


def run_of(path: Path) -> str:
    """The run that was given to :func:`sealed`; empty for a file without one.

    Raises:
        OSError: The file cannot be read.
    """
    with opened(path) as file:
        lines = file.read(USER_BLOCK).split(b"\n")
    line = lines[1] if len(lines) > 1 else b""
    return line.removeprefix(RUN).decode("ascii", "replace") if line.startswith(RUN) else ""


def check_seal(path: Path) -> None:
    """Makes sure that a file is as it was written.

    Raises:
        ValueError: It is not.
        OSError: It cannot be read.
    """
    with opened(path) as file:
        block, begin = file.read(USER_BLOCK), file.read(len(HDF5))
        if block.startswith(HDF5) or (block == bytes(USER_BLOCK) and begin == HDF5):
            return  # written before there were seals, or by another program
        whole = begin == HDF5 and block.startswith(SEAL % _checked(file))
    if not whole:
        raise ValueError(
            "its checksum does not fit; it was cut short or changed after it was written; make it again"
        )
