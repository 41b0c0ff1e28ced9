"""Unfinished files and folders: held while their process lives, and swept by the next one if it was killed.

They are called ``.NAME-`` and 32 hexadecimal digits, beside their targets. The writing process holds a lock on them,
which the system releases when the process ends, however it ends.
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import time
import uuid
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

OLDEST_S = 86_400.0
"""Age at which an unfinished file is swept on systems without such locks."""

OF_A_WRITE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS}
"""Errors of writing: no space, no more of it for this user, too large a file, a broken disk, a read-only one."""

UNFINISHED = re.compile(r"\..*-[0-9a-f]{32}(\..*)?")
"""Names of unfinished files and folders."""

_held: set[Path] = set()
"""Unfinished files and folders of this process."""


@contextmanager
def unfinished(
    target: Path, within: Path | None = None, *, folder: bool = False, shown: Path | None = None
) -> Iterator[Path]:
    """An empty file or folder that is to take the target's place; it is removed at the end unless it was moved.

    It keeps the target's suffix, since some writers insist on theirs. Unfinished files of the same target that killed
    processes left behind are swept first.

    Args:
        target: The file or folder to write.
        within: Folder of the unfinished one; the target's by default.
        folder: Make a folder.
        shown: The place that errors name instead of the unfinished one; the target by default.

    Raises:
        OSError: It cannot be made.
    """
    place = target.parent if within is None else within
    sweep(target, place)
    while True:
        path = place / f".{target.stem}-{uuid.uuid4().hex}{target.suffix}"
        _held.add(path)  # before it is made, so that an interruption at any moment leaves none
        try:
            if folder:
                path.mkdir()
            else:
                path.touch(exist_ok=False)
        except OSError as error:
            _held.discard(path)
            _name_target(error, path, target if shown is None else shown)
            raise
        with ExitStack() as lock:
            with suppress(FileNotFoundError):
                lock.enter_context(locked(path, wait=True))
            if not path.exists():
                _held.discard(path)
                continue  # swept before the lock was ours
            try:
                yield path
            except OSError as error:
                _name_target(error, path, target if shown is None else shown)
                raise
            finally:
                _remove(path)
                _held.discard(path)
            return


@contextmanager
def errors_name(target: Path) -> Iterator[None]:
    """Lets errors of writing in the block name the file that is written, where the system names none."""
    try:
        yield
    except OSError as error:
        _name_target(error, target, target)
        raise


def _name_target(error: OSError, path: Path, target: Path) -> None:
    """Lets an error name the file that was to be written: readers know no unfinished one, and a write names no file."""
    if error.filename is None and error.errno in OF_A_WRITE:
        error.filename = str(target)
    elif isinstance(error.filename, str | bytes):
        name = Path(os.fsdecode(error.filename))
        if name.is_relative_to(path):
            error.filename, error.filename2 = str(target / name.relative_to(path)), None


def remove_held() -> None:
    """Removes all unfinished files and folders of this process, which is to end before it has finished them."""
    for path in tuple(_held):
        with suppress(OSError):
            _remove(path)


def sweep_folder(folder: Path) -> None:
    """Removes all unfinished files and folders that killed processes left in a folder itself, whatever their target."""
    _sweep(folder, UNFINISHED)


def sweep(target: Path, within: Path | None = None) -> None:
    """Removes unfinished files of a target that killed processes left ``within`` a folder, by default the target's."""
    name = re.compile(rf"\.{re.escape(target.stem)}-[0-9a-f]{{32}}{re.escape(target.suffix)}")
    _sweep(target.parent if within is None else within, name)


def _sweep(place: Path, name: re.Pattern[str]) -> None:
    with suppress(OSError):
        for path in place.iterdir():
            if name.fullmatch(path.name) and not path.is_symlink():
                _remove_if_left(path)


def _remove(path: Path) -> None:
    """Removes a file or folder, if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _remove_if_left(path: Path) -> None:
    with suppress(OSError), locked(path, wait=False) as ours:
        if ours or (ours is None and time.time() - path.stat().st_mtime > OLDEST_S):
            _remove(path)


@contextmanager
def locked(path: Path, wait: bool) -> Iterator[bool | None]:
    """Holds a lock on a file or folder that the system releases when this process ends, however it ends.

    Args:
        path: The file or folder.
        wait: Wait for another process that holds it.

    Yields:
        True for a lock that is ours; None where the system or its file system has no locks.

    Raises:
        OSError: The path is not there.
    """
    try:
        import fcntl
    except ImportError:  # not POSIX, where open files cannot be renamed either
        yield None
        return
    descriptor = os.open(path, os.O_RDONLY)
    try:
        ours: bool | None = True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            ours = False
        except OSError:
            ours = None
        yield ours
    finally:
        os.close(descriptor)
