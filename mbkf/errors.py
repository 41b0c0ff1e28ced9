"""Every error mbkf raises: one root, each with its evidence and a hint of what to do."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from pathlib import Path

MOST_LETTERS = 1000
"""Length of the longest text of an error; what a damaged file holds may be longer."""


class MbkfError(Exception):
    """Root of all errors of this package; its text is one line a person can act on."""

    def __str__(self) -> str:
        """The text: in one line, cut where it is long, letters that steer a terminal as their codes."""
        text = " ".join(super().__str__().splitlines())
        if len(text) > MOST_LETTERS:
            text = f"{text[: MOST_LETTERS // 2]} … {text[-MOST_LETTERS // 2 :]}"
        return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


class MbkfWarning(UserWarning):
    """A fault that ends nothing, such as an installed reader that cannot be loaded."""


class FileFormatError(MbkfError):
    """A file is missing, unreadable or not what its name promises.

    Attributes:
        path: The file.
        reason: What is wrong with it.
        line: Line of the fault, from 1; None where no line is to blame.
    """

    def __init__(self, path: str | Path, reason: str, line: int | None = None) -> None:
        self.path, self.reason, self.line = Path(path), reason, line
        where = f"{path}, line {line}" if line is not None else str(path)
        super().__init__(f"{where}: {reason}")


class ProtectedFile(MbkfError):
    """Writing would replace a file that was read, or one that mbkf did not write; nothing was changed.

    Attributes:
        path: The file.
        reason: Why it stays, and the remedy.
    """

    def __init__(self, path: str | Path, reason: str) -> None:
        self.path, self.reason = Path(path), reason
        super().__init__(f"{path}: {reason}")


class UnknownName(MbkfError):
    """A name (marker, segment, protocol, plate, option …) is not among the valid ones.

    Attributes:
        kind: What is named, as a noun: "marker", "segment", …
        name: The name that is not known.
        choices: The valid ones; the closest of them are part of the text.
        where: File or option in which the name stands; empty where it goes without saying.
    """

    def __init__(self, kind: str, name: str, choices: Iterable[str], where: str = "") -> None:
        self.kind, self.name, self.choices, self.where = kind, name, tuple(choices), where
        prefix = f"{where}: " if where else ""
        super().__init__(f"{prefix}unknown {kind} '{name}'; {suggestion(name, self.choices)}")


class UnknownEntry(FileFormatError, UnknownName):
    """A file holds an entry or column that files of its kind do not have."""

    def __init__(
        self, path: str | Path, kind: str, name: str, choices: Iterable[str], line: int | None = None
    ) -> None:
        """Names the closest of the entries that are possible.

        Args:
            path: The file.
            kind: Noun of the entry, such as "session entry".
            name: Its name in the file.
            choices: Names that are possible.
            line: Line of the entry, from 1; None where it is not known.
        """
        self.kind, self.name, self.choices, self.where = kind, name, tuple(choices), str(path)
        self.path, self.line = Path(path), line
        self.reason = f"unknown {kind} '{name}'; {suggestion(name, self.choices)}"
        MbkfError.__init__(self, f"{path}{'' if line is None else f', line {line}'}: {self.reason}")


_MEANT = {"weight": "mass", "gender": "sex", "person": "subject", "participant": "subject"}
"""Words that people write for others."""


def suggestion(name: str, choices: Iterable[str]) -> str:
    """The names closest to a wrong one, or the first of all: "did you mean mass_kg"."""
    folded: dict[str, str] = {}
    for choice in choices:
        folded.setdefault(_folded(choice), choice)
    close = difflib.get_close_matches(_folded(name), folded, n=3, cutoff=0.5)
    listed = [folded[one] for one in close] or list(folded.values())[:12]
    return f"{'did you mean' if close else 'known are'} {', '.join(listed)}"


def _folded(name: str) -> str:
    """A name without capitals, spaces and brackets, in the words of mbkf."""
    words = re.findall(r"[^\W_]+", name.casefold())
    return "_".join(_MEANT.get(word, word) for word in words)


class ShapeError(MbkfError):
    """An array does not have the documented shape.

    Attributes:
        name: The array.
        expected: Its documented shape.
        got: The shape it has.
    """

    def __init__(self, name: str, expected: str, got: tuple[int, ...]) -> None:
        self.name, self.expected, self.got = name, expected, got
        super().__init__(f"{name} must have shape {expected}, got {got}")


class InvalidInput(MbkfError):
    """A value is readable but cannot be right (negative mass, wrong unit, NaN force …)."""


class InvalidPacket(MbkfError):
    """A packet of a network stream does not fit its own lengths, or is not what its header states."""


class NotObservable(MbkfError):
    """The markers present do not determine the body, so nothing can be followed."""


class NotConverged(MbkfError):
    """An optimisation ended without reaching its tolerance."""


class MissingDependency(MbkfError):
    """A library that is not part of the plain installation is needed.

    Attributes:
        package: The library.
        needed_for: The capability that needs it.
        extra: Extra of mbkf that installs it.
    """

    def __init__(self, package: str, needed_for: str, extra: str) -> None:
        self.package, self.needed_for, self.extra = package, needed_for, extra
        super().__init__(
            f"{needed_for} needs the library '{package}'; install it with: pip install {package} "
            f"(in a clone of mbkf also: pip install '.[{extra}]')"
        )
