"""Registry of file formats: which reader takes a file, by its suffix and, where a suffix is shared, by its content.

Captures, ground reactions and inertial readings have a registry each, in :mod:`mbkf.io.capture` and
:mod:`mbkf.io.imu.files`. Readers of other installed packages (:mod:`mbkf.io.installed`) join them at the first look-up.
The lists of suffixes in messages and on the command line come from here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, TypeVar

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.installed import READERS, import_installed

FOLDER = "/"
"""Suffix under which a reader of whole folders is registered."""


@dataclass(frozen=True, kw_only=True)
class FileFormat:
    """A kind of file.

    Attributes:
        title: Its name, for people.
        suffixes: Lower-case endings with their dot, or :data:`FOLDER`.
        recognises: True for a file of such a suffix that is of this kind; None where the suffix decides.
    """

    title: str
    suffixes: tuple[str, ...]
    recognises: Callable[[Path], bool] | None = None


T = TypeVar("T")
Format = TypeVar("Format", bound=FileFormat)


class FormatRegistry(Generic[Format]):
    """The formats of one kind of content.

    Attributes:
        content: The content in the plural, for messages: "captures".
    """

    def __init__(self, content: str) -> None:
        self.content = content
        self._formats: list[Format] = []

    def __iter__(self) -> Iterator[Format]:
        import_installed(READERS)
        return iter(tuple(self._formats))

    def add(self, one: Format) -> None:
        """Registers a format.

        Raises:
            InvalidInput: A suffix is not one, or a format that is recognised by its suffix alone has it already.
        """
        for suffix in one.suffixes:
            if suffix != FOLDER and (not suffix.startswith(".") or suffix != suffix.lower()):
                raise InvalidInput(f"'{suffix}' is not a lower-case suffix such as '.c3d'")
            taken = next((o for o in self._formats if suffix in o.suffixes and o.recognises is None), None)
            if taken is not None and one.recognises is None:
                raise InvalidInput(
                    f"'{suffix}' files are read as {taken.title} already; give 'recognises' to distinguish them"
                )
        self._formats.append(one)

    def remove(self, one: Format) -> None:
        """Takes a format out again."""
        self._formats.remove(one)

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of files, in the order of registration."""
        return _suffixes(self)

    @property
    def suffixes_so_far(self) -> tuple[str, ...]:
        """Suffixes without those of installed readers that no look-up has asked for yet, for help texts."""
        return _suffixes(self._formats)

    def format_of(self, path: Path) -> Format:
        """The format of a file: one that recognises its content, else the one of its suffix.

        Raises:
            FileFormatError: No format has its suffix; lists those that are known.
        """
        formats = list(self)
        folders = any(FOLDER in one.suffixes for one in formats)
        suffix = FOLDER if folders and path.is_dir() else path.suffix.lower()
        own = [one for one in formats if suffix in one.suffixes]
        recognised = (one for one in own if one.recognises is not None and one.recognises(path))
        found = next(recognised, None) or next((one for one in own if one.recognises is None), None)
        if found is None:
            kind = f"'{path.suffix}' files" if path.suffix else "files without a suffix"
            reason = f"{kind} cannot be read as {self.content}; name a {either(self.suffixes)} file"
            raise FileFormatError(path, reason)
        return found


def _suffixes(formats: Iterable[FileFormat]) -> tuple[str, ...]:
    every = dict.fromkeys(suffix for one in formats for suffix in one.suffixes)
    return tuple(suffix for suffix in every if suffix != FOLDER)


def lazily(module: str, function: str) -> Callable[..., T]:
    """A function of a module in :mod:`mbkf.io` that is imported at its first call."""

    def call(*arguments: object) -> Any:
        return getattr(import_module(f"mbkf.io.{module}"), function)(*arguments)

    return call


def either(names: Iterable[str]) -> str:
    """Names as an alternative: ".c3d or .trc", ".csv, .tsv or .txt"."""
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
