"""The door of everything that is written: a reader sees the old file or the whole new one, and no input is lost.

A wrong place is refused early: :func:`check_folder` and :func:`check_file`.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, TextIO

from mbkf.errors import FileFormatError
from mbkf.io.files_read import files_read
from mbkf.io.leftovers import unfinished
from mbkf.io.utf8 import encoded
from mbkf.io.written import check_replaceable, form_of


@contextmanager
def replacing(path: str | Path, *, edits: bool = False) -> Iterator[Path]:
    """An empty temporary file beside ``path`` that takes its place when the block ends without an error.

    Missing folders are made. The temporary name keeps the suffix, since some writers insist on theirs. The file is on
    the disk before it takes its place, so that a power cut leaves the old one or the new one.

    Args:
        path: The file.
        edits: It is one of the user's own that this change is meant for (:func:`check_replaceable`).

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The folder cannot be made or written to.
    """
    target = Path(path)
    check_replaceable(target, edits=edits)
    target.parent.mkdir(parents=True, exist_ok=True)
    with unfinished(target) as temporary:
        yield temporary
        flush(temporary)
        _take_place(temporary, target, edits)


def _take_place(temporary: Path, target: Path, edits: bool) -> None:
    """Gives a finished file its name; a file that came into being meanwhile is looked at like any other."""
    if not os.path.lexists(target):
        try:
            os.link(temporary, target)  # in contrast to a renaming, it replaces nothing
        except OSError:
            pass  # a file has come into being, or the file system has one name for each
        else:
            files_read().wrote(target)
            return
    check_replaceable(target, edits=edits, form=form_of(temporary))
    temporary.replace(target)
    files_read().wrote(target)


def write_text(path: str | Path, text: str, *, edits: bool = False) -> None:
    """Writes a text file in UTF-8, whole or not at all; letters that UTF-8 lacks become their codes.

    Args:
        path: The file.
        text: Its content.
        edits: As for :func:`replacing`.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The file cannot be written.
    """
    with replacing(path, edits=edits) as partial:
        partial.write_bytes(encoded(text))


@contextmanager
def replacing_text(path: str | Path) -> Iterator[TextIO]:
    """As :func:`replacing`, with the temporary file open for text, as :func:`write_text` writes it.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The file cannot be written.
    """
    unstorable = "backslashreplace"
    with (
        replacing(path) as partial,
        partial.open("w", encoding="utf-8", errors=unstorable, newline="\n") as file,
    ):
        yield file


def new_file(path: str | Path) -> BinaryIO:
    """Opens a file that grows while it can be read already, such as a log; whatever stands there is checked first.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: It cannot be written.
    """
    target = Path(path)
    check_replaceable(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    file = target.open("wb", buffering=0)
    files_read().wrote(target)
    return file


def remove_file(path: str | Path) -> None:
    """Removes an earlier output, which is not to stay beside new ones; a file that is missing passes.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: It cannot be removed.
    """
    check_replaceable(path)
    Path(path).unlink(missing_ok=True)


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


def check_file(path: str | Path, *, edits: bool = False, form: str | None = None) -> Path:
    """The absolute path of a file that can be written, in a folder that can be made. Commands call it before long work.

    Args:
        path: The file.
        edits: As for :func:`replacing`.
        form: The format to be written, as for :func:`check_replaceable`.

    Raises:
        FileFormatError: A folder stands there, or a file in the place of its folder.
        ProtectedFile: The file was read, or mbkf did not write it.
        PermissionError: Its folder may not be written to, or not be made.
    """
    target = Path(path)
    if target.is_dir():
        raise FileFormatError(target, "is a folder; name a file for --out")
    check_replaceable(target, edits=edits, form=form)
    return check_folder(target.parent) / target.name


def check_folder(folder: str | Path, files: Sequence[str] = ()) -> Path:
    """The absolute path of a folder that can be written to, with files of these names in it.

    Commands call it before long work, to fail early. Nothing is made, so that a command that fails later leaves no
    empty folder behind.

    Raises:
        FileFormatError: A file stands there or on the way, or a folder in the place of a file.
        ProtectedFile: One of the files was read, or mbkf did not write it.
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
        check_replaceable(place)
    nearest = next(place for place in (target, *target.parents) if place.exists())
    if not os.access(nearest, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(nearest))
    return target
