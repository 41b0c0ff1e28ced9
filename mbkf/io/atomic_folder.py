"""Replacing a folder, or files beside each other, as one: a reader sees the old files or the new, and not some of each.

The new folder is made beside the old one, gets the files that only the old one has, and the two exchange their names
in one step of the system. Where that cannot be done (the folder is a mounted disk or the current one, or the system
lacks such a step) its files are replaced one by one; a number in each of them then shows a reader whether they were
written together (:mod:`mbkf.io.results_folder`).
"""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial as partial_of
from pathlib import Path

from mbkf.io.atomic import check_folder, flush
from mbkf.io.files_read import files_read, place_of
from mbkf.io.leftovers import unfinished
from mbkf.io.written import check_replaceable, form_of

_AT_FDCWD = -100
_EXCHANGE = 2
"""Linux's RENAME_EXCHANGE of renameat2, and macOS's RENAME_SWAP of renamex_np."""


@contextmanager
def replacing_folder(folder: str | Path, last: str | None = None) -> Iterator[Path]:
    """A new, empty folder whose files take the place of those of ``folder`` when the block ends without an error.

    It holds files and no folders. Other files and folders of an existing folder stay. Unfinished folders of killed
    processes are swept. ``last`` is the file that marks the others as whole, written last where they cannot be replaced
    as one.

    Raises:
        FileFormatError: A file stands where a folder is needed, or a folder where a file is.
        ProtectedFile: A file that would be replaced was read, or mbkf did not write it.
        OSError: The folder cannot be made or written to.
    """
    target = place_of(check_folder(folder))
    as_one = _can_be_renamed(target)
    place = target.parent if as_one else target
    place.mkdir(parents=True, exist_ok=True)
    with unfinished(target, place, folder=True) as partial:
        yield partial
        files = [path.name for path in partial.iterdir() if path.is_file()]
        check_folder(target, files)
        _finish(partial, target, files)
        if not target.exists():
            partial.rename(target)
        elif not as_one or not _exchanged(target, partial):
            _take_places(partial, target, sorted(files, key=lambda name: name == last))
        for name in files:
            files_read().wrote(target / name)


@contextmanager
def replacing_beside(path: str | Path) -> Iterator[Path]:
    """A new, empty folder whose files take the places of those beside ``path`` when the block ends without an error.

    For files that belong together: all of them take their places, or all earlier ones stay. It holds files and no
    folders.

    Args:
        path: The first of the files; the folder for all of them is made where missing.

    Raises:
        FileFormatError: A file stands where a folder is needed, or a folder where a file is.
        ProtectedFile: A file that would be replaced was read, or mbkf did not write it.
        OSError: The folder cannot be made or written to.
    """
    first = Path(path)
    place = check_folder(first.parent)
    place.mkdir(parents=True, exist_ok=True)
    with unfinished(place / first.stem, folder=True, shown=place) as partial:
        yield partial
        files = sorted(path.name for path in partial.iterdir() if path.is_file())
        check_folder(place, files)
        _finish(partial, place, files)
        _take_places(partial, place, files)
        for name in files:
            files_read().wrote(place / name)


def _finish(partial: Path, target: Path, files: Sequence[str]) -> None:
    """Makes sure that files may take their places, and that they are on the disk."""
    for name in files:
        check_replaceable(target / name, form=form_of(partial / name))
        flush(partial / name)


def _take_places(partial: Path, target: Path, files: Sequence[str]) -> None:
    """Moves files into a folder one by one; if one cannot be moved, those before it are moved back."""
    with ExitStack() as back:
        for name in files:
            back.callback(_take_place(partial / name, target / name))
        back.pop_all()


def _take_place(new: Path, target: Path) -> Callable[[], object]:
    """Moves a file to its place, and returns the way back; where the system cannot exchange names, there is none."""
    there = os.path.lexists(target)
    if not there:
        with suppress(OSError):
            os.link(new, target)  # in contrast to a renaming, it replaces nothing
            return target.unlink
    check_replaceable(target, form=form_of(new))
    if _exchange(new, target):
        return partial_of(_exchange, new, target)
    new.replace(target)
    return _stays if there else target.unlink


def _stays() -> None:
    """The earlier file is lost, and the new one stays."""


def _can_be_renamed(target: Path) -> bool:
    """True unless a folder is a mount or the current one, or its parent is read-only."""
    if not target.exists():
        return True
    with suppress(OSError):
        if Path.cwd().is_relative_to(target):
            return False
    return not target.is_mount() and os.access(target.parent, os.W_OK)


def _exchanged(target: Path, partial: Path) -> bool:
    """Exchanges a finished folder with an old one, whose other files it gets; false if the system cannot."""
    written = frozenset(path.name for path in partial.iterdir())
    for old in target.iterdir():
        new = partial / old.name
        if new.exists() or new.is_symlink():
            continue
        if old.is_dir() and not old.is_symlink():
            shutil.copytree(old, new, symlinks=True, copy_function=_linked)
        else:
            _linked(old, new)
    shutil.copymode(target, partial)
    if not _exchange(target, partial):
        return False
    _keep_latecomers(partial, target, written)
    return True


def _keep_latecomers(old: Path, new: Path, written: frozenset[str]) -> None:
    """Moves files into the new folder that others put into the old one while the two were exchanged."""
    for folder, _, names in os.walk(old):
        for name in names:
            place = Path(folder, name)
            beside = new / place.relative_to(old)
            if str(place.relative_to(old)) in written or (os.path.lexists(beside) and _same(place, beside)):
                continue
            with suppress(OSError):
                beside.parent.mkdir(parents=True, exist_ok=True)
                place.replace(beside)


def _same(first: Path, second: Path) -> bool:
    """True for two names of one file, and for a copy, which has size and time of its original."""
    a, b = first.lstat(), second.lstat()
    return os.path.samestat(a, b) or (a.st_size, a.st_mtime_ns) == (b.st_size, b.st_mtime_ns)


def _linked(old: str | Path, new: str | Path) -> str:
    """Another name of the same file, or a copy where the file system has only one name for each."""
    try:
        os.link(old, new, follow_symlinks=False)
    except OSError:
        shutil.copy2(old, new, follow_symlinks=False)
    return str(new)


def _exchange(first: Path, second: Path) -> bool:
    """Exchanges the names of two folders; false if the system cannot."""
    a, b = os.fsencode(first), os.fsencode(second)
    try:
        library = ctypes.CDLL(None, use_errno=True)
        if sys.platform == "darwin":
            return library.renamex_np(a, b, _EXCHANGE) == 0
        return library.renameat2(_AT_FDCWD, a, _AT_FDCWD, b, _EXCHANGE) == 0
    except (OSError, AttributeError, TypeError):  # no such library, or no such step in it
        return False
