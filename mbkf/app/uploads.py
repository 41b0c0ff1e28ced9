"""Files that are dropped on the page: their names, their places in the page's folder, and their content as one."""

from __future__ import annotations

import errno
import filecmp
import os
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from mbkf.app.failures import CONFLICT, Refused
from mbkf.errors import InvalidInput
from mbkf.io.atomic import flush
from mbkf.io.files_read import place_of
from mbkf.io.leftovers import sweep_folder, unfinished
from mbkf.study.batch.plan import FORBIDDEN

RESULTS = "results"
"""Folder of the results in the page's folder."""

MOST_DEEP = 4
"""Most levels of folders that dropped files may bring."""

MOST_BYTES = 200
"""Longest name of a file or folder; file systems hold 255 bytes, of which an unfinished file needs 34."""

SHOWN = 80

_placing = threading.Lock()


@contextmanager
def putting(root: Path, name: str, size: int | None = None) -> Iterator[BinaryIO]:
    """Opens a file for the content of one that is dropped on the page; it appears when the block ends.

    A file that is there already is never replaced: the same content is taken as put, another one is refused.

    Args:
        root: The page's folder.
        name: Path of the file in the folder, with slashes; missing folders are made.
        size: Its size, bytes; None where not known.

    Yields:
        The open file.

    Raises:
        InvalidInput: The path is not possible, or leads out of the folder.
        Refused: A file of this name with another content is there.
        OSError: The file cannot be written.
    """
    target = target_of(root, name)
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    if size is not None:
        if target.is_file() and target.stat().st_size != size:
            raise _taken(name)
        if shutil.disk_usage(target.parent).free < size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target))
    sweep_folder(target.parent)  # parts of any file that a killed page left
    with unfinished(target) as partial:
        with partial.open("wb") as file:
            yield file
        flush(partial)
        with _placing:
            if not target.exists():
                partial.replace(target)
            elif not filecmp.cmp(partial, target, shallow=False):
                raise _taken(name)


def target_of(root: Path, name: str) -> Path:
    """The place of a file or folder of a name in the page's folder.

    Raises:
        InvalidInput: The path is not possible, or leads out of the folder.
    """
    shown = f"'{name[:SHOWN]}'"
    try:
        parts, sizes = PurePosixPath(name).parts, [len(part.encode()) for part in PurePosixPath(name).parts]
    except UnicodeEncodeError as error:
        raise InvalidInput("the file's name holds half of a letter; rename the file") from error
    if not 1 <= len(parts) <= MOST_DEEP + 1 or any(_is_bad(part) for part in parts):
        raise InvalidInput(f"{shown} cannot be a file here; rename the file")
    if max(sizes) > MOST_BYTES:
        raise InvalidInput(
            f"{shown}: a name of {max(sizes)} bytes is too long, at most {MOST_BYTES} are possible; rename the file"
        )
    if parts[0] == RESULTS:
        raise InvalidInput(f"{shown} would lie among the results; rename the folder '{RESULTS}'")
    target = root.joinpath(*parts)
    if not place_of(target.parent).is_relative_to(place_of(root)):
        raise InvalidInput(f"{shown} leads out of the folder")
    return target


def _is_bad(part: str) -> bool:
    return part in {".", "..", ""} or part.startswith(".") or FORBIDDEN.search(part) is not None


def _taken(name: str) -> Refused:
    return Refused(
        CONFLICT,
        f"'{name[:SHOWN]}' is here already with another content; rename the file, or remove the one here",
    )
