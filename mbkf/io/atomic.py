"""Writing so that a reader sees the old file or the whole new one; a wrong place is refused early."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.leftovers import unfinished


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """An empty temporary file beside ``path`` that takes its place when the block ends without an error.

    Missing folders are made. The temporary name keeps the suffix, since some writers insist on theirs. The file is on
    the disk before it takes its place, so that a power cut leaves the old one or the new one.

    Raises:
        OSError: The folder cannot be made or written to.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    with unfinished(target) as temporary:
        yield temporary
        flush(temporary)
        temporary.replace(target)


def write_text(path: str | Path, text: str) -> None:
    """Writes a text file, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")


def flush(path: Path) -> None:
    """Waits until a file is on the disk; does nothing on systems that only flush files open for writing.

    Raises:
        OSError: It cannot be opened, or not be brought onto the disk.
    """
    if os.name != "posix":
        return
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def check_folder(folder: str | Path, files: Sequence[str] = ()) -> Path:
    """The absolute path of a folder that can be written to, with files of these names in it.

    Commands call it before long work, to fail early. Nothing is made, so that a command that fails later leaves no
    empty folder behind.

    Raises:
        FileFormatError: A file stands there or on the way, or a folder in the place of a file.
        PermissionError: It may not be written to, or not be made.
    """
    target = Path(folder).absolute()
    for place in (target, *target.parents):
        if place.exists() and not place.is_dir():
            raise FileFormatError(
                place, "a file stands where a folder is needed; name another folder with --out"
            )
    for place in (target / name for name in files):
        if place.is_dir():
            raise FileFormatError(
                place, "a folder stands where a file is needed; move it, or name another folder with --out"
            )
    nearest = next(place for place in (target, *target.parents) if place.exists())
    if not os.access(nearest, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(nearest))
    return target
