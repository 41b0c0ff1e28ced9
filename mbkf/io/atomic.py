"""Writing so that a reader sees the old file or the whole new one, and a wrong place is refused early."""

from __future__ import annotations

import errno
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mbkf.errors import FileFormatError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary file beside ``path`` that takes its place when the block ends without an error.

    Missing folders are made. The temporary name keeps the suffix, since some writers insist on theirs.

    Args:
        path: The file to write.

    Yields:
        Where to write instead.

    Raises:
        OSError: The folder cannot be made or written to.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f".{target.stem}-{uuid.uuid4().hex}{target.suffix}")
    try:
        yield temporary
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def check_folder(folder: str | Path) -> Path:
    """The absolute path of a folder that can be written to; commands call it before long work, to fail early.

    Nothing is made, so that a command that fails later leaves no empty folder behind.

    Raises:
        FileFormatError: A file stands there or on the way.
        PermissionError: It may not be written to, or not be made.
    """
    target = Path(folder).absolute()
    for place in (target, *target.parents):
        if place.exists() and not place.is_dir():
            raise FileFormatError(
                place, "a file stands where a folder is needed; name another folder with --out"
            )
    nearest = next(place for place in (target, *target.parents) if place.exists())
    if not os.access(nearest, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(nearest))
    return target
