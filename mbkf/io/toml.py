"""Files of plain entries in TOML: written from plain values, and read with each entry checked."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.atomic import write_text
from mbkf.io.plain_data import read_toml
from mbkf.io.utf8 import storable

T = TypeVar("T")

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SHOWN = 40


def write_toml(path: str | Path, comment: str, table: Mapping[str, object], *, edits: bool = False) -> None:
    """Writes a table as a file, whole or not at all; entries that are None are left out.

    Args:
        path: The file.
        comment: First line of the file.
        table: Texts, numbers, arrays, tables and lists of tables, in any depth.
        edits: The file is a user's own that is changed on purpose.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The file cannot be written.
    """
    write_text(path, toml_text(comment, table), edits=edits)


def toml_text(comment: str, table: Mapping[str, object]) -> str:
    """The text of a file that :func:`write_toml` writes."""
    return "\n".join([f"# {comment}", *_lines(table, "")]) + "\n"


def _lines(table: Mapping[str, object], place: str) -> Iterator[str]:
    """Lines of a table: its plain entries, then the tables in it under their own titles."""
    inner = {key: value for key, value in table.items() if _is_table(value)}
    for key, value in table.items():
        if value is not None and key not in inner:
            yield f"{_key(key)} = {_value(value)}"
    for key, value in inner.items():
        title = f"{place}{_key(key)}"
        one = isinstance(value, Mapping)
        for each in [value] if one else value:  # type: ignore[attr-defined]
            yield from ("", f"[{title}]" if one else f"[[{title}]]", *_lines(each, f"{title}."))


def _is_table(value: object) -> bool:
    listed = isinstance(value, list | tuple) and len(value) > 0
    return isinstance(value, Mapping) or (listed and all(isinstance(one, Mapping) for one in value))  # type: ignore[attr-defined]


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _text(name)


def _value(value: object) -> str:
    if isinstance(value, str):
        literal = "'''" not in value and value.replace("\n", "").replace("\t", "").isprintable()
        long = "\n" in value and literal and not value.endswith("'")
        return f"'''\n{value}'''" if long else _text(value)
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, int | np.integer):
        return str(value)
    if isinstance(value, Sequence | np.ndarray):
        rows = [_value(one) for one in value]
        nested = any(isinstance(one, Sequence | np.ndarray) and not isinstance(one, str) for one in value)
        return "[\n" + "".join(f"  {row},\n" for row in rows) + "]" if nested else f"[{', '.join(rows)}]"
    return repr(float(value))  # type: ignore[arg-type]


def _text(value: str) -> str:
    """A TOML basic string: JSON's, with DEL escaped, too."""
    return json.dumps(storable(value), ensure_ascii=False).replace("\x7f", "\\u007f")


@contextmanager
def one_line_errors(path: Path, kind: str, hint: str) -> Iterator[None]:
    """Turns the errors that a missing or damaged file causes into one line each.

    Args:
        path: The file.
        kind: The kind of file with its article, for messages.
        hint: The command that writes such files.

    Raises:
        FileFormatError: The file is missing, cannot be read, or lacks or misuses an entry.
        InvalidInput: A value in it is impossible; names the file.
    """
    try:
        yield
    except (FileNotFoundError, IsADirectoryError) as error:
        found = "no such file" if isinstance(error, FileNotFoundError) else "cannot be read, it is a folder"
        raise FileFormatError(path, f"{found}; {hint}") from error
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error
    except (OSError, UnicodeError) as error:
        raise FileFormatError(path, f"cannot be read ({error})") from error
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not {kind} ({error}); {hint}") from error


class Entries:
    """Entries of a table, each as it must be; an entry that is missing is None.

    Attributes:
        file: The file.
        where: Place of the table in it, for messages; ends with ": " where it is not empty.
        table: The entries.
    """

    def __init__(self, file: Path, table: Mapping[str, object], where: str = "") -> None:
        self.file, self.where, self.table = file, where, table

    @classmethod
    def of_file(cls, path: str | Path, kind: str, hint: str) -> Entries:
        """The entries of a file.

        Args:
            path: The file.
            kind: The kind of file with its article, for messages.
            hint: The command that writes such files.

        Raises:
            FileFormatError: The file is missing or damaged.
        """
        with one_line_errors(Path(path), kind, hint):
            return cls(Path(path), read_toml(Path(path), hint))

    def text(self, key: str, empty: bool = False) -> str | None:
        """A text, which may be empty only where asked for."""
        return self._checked(
            key, lambda value: value if isinstance(value, str) and (value or empty) else None, "a text"
        )

    def one_of(self, key: str, known: tuple[str, ...]) -> str | None:
        """One of the known words."""
        expected = f"one of {', '.join(known)}"
        return self._checked(key, lambda value: value if value in known else None, expected)

    def number(self, key: str, span: tuple[float, float] = (-math.inf, math.inf)) -> float | None:
        """A finite number in a span."""
        expected = "a number" if math.isinf(span[0]) else f"a number between {span[0]:g} and {span[1]:g}"
        return self._checked(key, lambda value: _number_in(value, *span), expected)

    def numbers(self, key: str, count: int, largest: float) -> Array | None:
        """(count,) numbers.

        Args:
            key: Name of the entry.
            count: Number of numbers.
            largest: Bound of their size.
        """

        def read(value: object) -> Array | None:
            listed = value if isinstance(value, list) else []
            found = [_number_in(one, -largest, largest) for one in listed]
            return None if len(found) != count or None in found else np.array(found, dtype=float)

        return self._checked(key, read, f"{count} numbers")

    def tables(self, key: str) -> dict[str, Entries]:
        """Tables of a table, by name; empty without a such entry."""
        found = self.table.get(key, {})
        if not isinstance(found, dict) or not all(isinstance(one, dict) for one in found.values()):
            raise FileFormatError(self.file, f"{self.where}{key} must hold tables, [{key}.NAME]")
        return {name: Entries(self.file, one, f"{key} {name}: ") for name, one in found.items()}

    def list_of_tables(self, key: str) -> list[Entries] | None:
        """Tables one after another."""
        found = self.table.get(key)
        if found is None:
            return None
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise FileFormatError(self.file, f"{self.where}{key} must be a list of tables, [[{key}]]")
        return [Entries(self.file, one, self.where) for one in found]

    def required(self, key: str, value: T | None) -> T:
        """A value that may not be missing.

        Raises:
            FileFormatError: It is.
        """
        if value is None:
            raise FileFormatError(self.file, f"{self.where}{key} is missing")
        return value

    def _checked(self, key: str, read: Callable[[object], T | None], expected: str) -> T | None:
        if key not in self.table:
            return None
        found = read(self.table[key])
        if found is None:
            value = str(self.table[key])
            shown = value if len(value) <= _SHOWN else value[:_SHOWN] + " …"
            raise FileFormatError(self.file, f"{self.where}{key} must be {expected}, got {shown}")
        return found


def _number_in(value: object, low: float, high: float) -> float | None:
    """A finite number between two others, None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if math.isfinite(value) and low <= value <= high else None
