"""The door of everything that is read: regular files of bounded size, remembered so that nothing is written over them.

A device never ends, a pipe waits for its writer, and a file of many gigabytes in the place of settings fills the
memory; all three are refused before a byte is read. The files that were read are remembered by device and inode, so
that a link, a relative path or another spelling of the name is the same file (:mod:`mbkf.io.written`).
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import BufferedReader
from pathlib import Path

from mbkf.errors import FileFormatError

SETTINGS_BYTES = 1 << 25
"""Size of the largest file of settings, persons, lists and numbers; those of a person have a hundredth of it."""

CAPTURE_BYTES = 1 << 34
"""Size of the largest capture or result, 16 GB: days of 100 markers at 100 Hz."""

PIECE_BYTES = 1 << 20
"""Size of a piece of a file that grows, or states no size."""

_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


class UnreadableFile(FileFormatError):
    """A file is no regular one, or too large to be read.

    Args:
        path: The file.
        found: The reason without advice.
        hint: Advice at the end of the message.

    Attributes:
        found: The reason without advice.
    """

    def __init__(self, path: Path, found: str, hint: str) -> None:
        self.found = found
        super().__init__(path, f"{found}; {hint}")


class FilesRead:
    """The files that one task read: a command, a request to a page, or a program that uses mbkf."""

    def __init__(self) -> None:
        self._by_node: dict[tuple[int, int], dict[Path, str]] = {}
        self._by_place: dict[Path, str] = {}
        self._own: dict[Path, tuple[int, ...]] = {}

    def add(self, path: Path) -> None:
        """Remembers a file, unless this task wrote it."""
        with suppress(OSError):
            place, state = place_of(path), path.stat()
            if place not in self._own:
                self._by_place.setdefault(place, str(path))
                self._by_node.setdefault((state.st_dev, state.st_ino), {})[place] = str(path)

    def name_of(self, path: Path) -> str | None:
        """The name under which a file was read; None for a file that was not.

        A removed file's inode may belong to a new one; so each place is looked at again.
        """
        try:
            place, state = place_of(path), path.stat()
        except OSError:
            return None
        if place in self._by_place:
            return self._by_place[place]
        for known, name in self._by_node.get((state.st_dev, state.st_ino), {}).items():
            with suppress(OSError):
                if os.path.samestat(known.stat(), state):
                    return name
        return None

    def wrote(self, path: Path) -> None:
        """Remembers that a file is this task's own, which it may read and replace."""
        with suppress(OSError):
            place = place_of(path)
            self._own[place] = _identity(place.stat())
            self._by_place.pop(place, None)

    def is_own(self, path: Path) -> bool:
        """True for a file that this task wrote and nobody changed since."""
        with suppress(OSError):
            place = place_of(path)
            return self._own.get(place) == _identity(place.stat())
        return False


def place_of(path: Path) -> Path:
    """The absolute path of a file behind all links; a link that leads to itself is its own place.

    Unlike ``Path.resolve``, which such a link ends with a RuntimeError before Python 3.13.
    """
    return Path(os.path.realpath(path))


def _identity(state: os.stat_result) -> tuple[int, ...]:
    return state.st_dev, state.st_ino, state.st_mtime_ns, state.st_size


_OF_PROCESS = [FilesRead()]
_TASK: ContextVar[FilesRead | None] = ContextVar("files read", default=None)


def files_read() -> FilesRead:
    """The files that the running task read."""
    return _TASK.get() or _OF_PROCESS[-1]


@contextmanager
def own_files_read(*, everywhere: bool = False) -> Iterator[FilesRead]:
    """Counts the files read in the block for themselves: a later task may replace them, as its own inputs allow.

    Args:
        everywhere: In all threads of the process, as for a command; else in the running one only, as for a request.
    """
    files = FilesRead()
    token = _TASK.set(None if everywhere else files)
    if everywhere:
        _OF_PROCESS.append(files)
    try:
        yield files
    finally:
        _TASK.reset(token)
        if everywhere:
            _OF_PROCESS.remove(files)


def check_regular(path: str | Path, most_bytes: int = CAPTURE_BYTES, hint: str = "name a file") -> Path:
    """Makes sure that a file can be read, and remembers it; returns its path.

    Args:
        path: The file.
        most_bytes: Size of the largest that is possible.
        hint: Advice at the end of the messages.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        OSError: Its folder cannot be read.
    """
    file = Path(path)
    state = file.stat()
    kind = kind_of(state.st_mode)
    if kind:
        raise UnreadableFile(file, f"cannot be read, it is {kind}", hint)
    if state.st_size > most_bytes:
        raise _too_large(file, most_bytes, hint)
    files_read().add(file)
    return file


def check_input(path: str | Path, hint: str, most_bytes: int = CAPTURE_BYTES) -> Path:
    """Makes sure that a file of a user is there and can be read, and remembers it; returns its path.

    Args:
        path: The file.
        hint: Advice at the end of the messages: "name a TRC file".
        most_bytes: Size of the largest that is possible.

    Raises:
        FileFormatError: It does not exist, is a folder, pipe, socket or device, or is too large.
        OSError: Its folder cannot be read.
    """
    try:
        return check_regular(path, most_bytes, hint)
    except (FileNotFoundError, NotADirectoryError) as error:
        raise FileFormatError(path, f"no such file; {hint}") from error


def kind_of(mode: int) -> str:
    """The kind of a thing that is no regular file, with its article: "a pipe"; empty for a file."""
    return next((kind for matches, kind in _KINDS if matches(mode)), "")


def read_bytes(path: str | Path, most_bytes: int = CAPTURE_BYTES, hint: str = "name a file") -> bytes:
    """The content of a file.

    Args:
        path: The file.
        most_bytes: Size of the largest that is possible.
        hint: Advice at the end of the messages.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        OSError: It cannot be read.
    """
    with opened(path, most_bytes, hint) as file:
        # Python allocates all that a read asks for: the stated size first, since files of /proc state none.
        content = file.read(min(os.fstat(file.fileno()).st_size, most_bytes) + 1)
        while content and len(content) <= most_bytes and (more := file.read(PIECE_BYTES)):
            content += more
    if len(content) > most_bytes:
        raise _too_large(Path(path), most_bytes, hint)
    return content


def read_text(path: str | Path, most_bytes: int = CAPTURE_BYTES, *, errors: str = "strict") -> str:
    """The text of a file in UTF-8, with or without a byte order mark; line ends are newlines.

    Args:
        path: The file.
        most_bytes: Size of the largest that is possible.
        errors: Treatment of bytes that are no UTF-8, as for ``bytes.decode``.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        UnicodeDecodeError: It is not UTF-8, and ``errors`` is "strict".
        OSError: It cannot be read.
    """
    text = read_bytes(path, most_bytes).decode("utf-8-sig", errors)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_state(path: Path) -> str:
    """The text of a file of mbkf's own work, such as the record of a batch, which the same task replaces.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        UnicodeDecodeError: It is not UTF-8.
        OSError: It cannot be read.
    """
    with own_files_read():
        return read_text(path, SETTINGS_BYTES)


def read_state_bytes(path: Path) -> bytes:
    """The content of such a file, or of a user's own that is edited on purpose.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        OSError: It cannot be read.
    """
    with own_files_read():
        return read_bytes(path, SETTINGS_BYTES)


@contextmanager
def opened(
    path: str | Path, most_bytes: int = CAPTURE_BYTES, hint: str = "name a file"
) -> Iterator[BufferedReader]:
    """Opens a file to read its bytes.

    Args:
        path: The file.
        most_bytes: Size of the largest that is possible.
        hint: Advice at the end of the messages.

    Raises:
        FileNotFoundError: It does not exist.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        OSError: It cannot be read.
    """
    with check_regular(path, most_bytes, hint).open("rb") as file:
        yield file


def _too_large(path: Path, most_bytes: int, hint: str) -> UnreadableFile:
    return UnreadableFile(path, f"is larger than {most_bytes >> 20} MB, the most that is read", hint)
