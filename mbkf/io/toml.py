"""Files of plain entries in TOML: written from plain values, and read with each entry checked."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from mbkf.errors import FileFormatError, InvalidInput, UnknownEntry
from mbkf.io.atomic import write_text
from mbkf.io.fields import Field, Record, shown
from mbkf.io.files_read import UnreadableFile
from mbkf.io.plain_data import parse_toml, plain_text
from mbkf.io.toml_lines import Place, TomlMistake, line_of
from mbkf.io.utf8 import storable

T = TypeVar("T")

_BARE = re.compile(r"[A-Za-z0-9_-]+")


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
    except UnreadableFile as error:
        raise FileFormatError(path, f"{error.found}; {hint}") from error
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error
    except TomlMistake as error:
        raise FileFormatError(path, f"not {kind}: {error.reason}", error.line) from error
    except (OSError, UnicodeError) as error:
        raise FileFormatError(path, f"cannot be read ({error})") from error
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not {kind} ({error}); {hint}") from error


@dataclass(frozen=True)
class Origin:
    """Where a table was read from.

    Attributes:
        file: The file.
        text: Its text, in which the lines of errors are found; empty for a table of another origin.
        place: Way to the table in it.
        line: Line of the whole table, where it is a row of a list.
    """

    file: Path
    text: str = ""
    place: Place = ()
    line: int | None = None

    def line_of(self, key: str = "") -> int | None:
        """Line of an entry, else of the table; None where neither is found."""
        if not self.text:
            return self.line
        return line_of(self.text, (*self.place, key)) if key else line_of(self.text, self.place)


class Entries:
    """Entries of a table as its record declares them.

    Attributes:
        record: The declaration.
        table: The entries.
        origin: Where they were read.
        where: Place of the table for messages; ends with ": " where it is not empty.
    """

    def __init__(self, record: Record, table: Mapping[str, object], origin: Origin, where: str = "") -> None:
        """Takes a table.

        Raises:
            UnknownEntry: It has an entry that is not declared.
        """
        self.record, self.table, self.origin, self.where = record, table, origin, where
        for key in table:
            if key not in record.keys:
                raise UnknownEntry(origin.file, f"{record.name} entry", key, record.keys, origin.line_of(key))

    @classmethod
    def of_file(cls, record: Record, path: str | Path, kind: str, hint: str) -> Entries:
        """The entries of a file.

        Args:
            record: Their declaration.
            path: The file.
            kind: The kind of file with its article, for messages.
            hint: The command that writes such files.

        Raises:
            FileFormatError: The file is missing or damaged.
        """
        with one_line_errors(Path(path), kind, hint):
            text = plain_text(Path(path))
            table = parse_toml(text)
        return cls(record, table, Origin(Path(path), text))

    @property
    def file(self) -> Path:
        """The file."""
        return self.origin.file

    def get(self, field: Field[T]) -> T | None:
        """The value of an entry; None for a missing one.

        Raises:
            FileFormatError: It is not as declared, or is missing and required.
        """
        if field.key not in self.table:
            if field.required:
                raise self.fault(f"{field.key} is missing; it must be {field.expected}")
            return None
        value = self.table[field.key]
        found = field.parse(value)
        if found is None:
            reason = f"{field.key} must be {field.expected}, got {shown(value)}{field.mend(value)}"
            raise self.fault(reason, field.key)
        return found

    def need(self, field: Field[T]) -> T:
        """The value of a required entry.

        Raises:
            FileFormatError: It is missing or not as declared.
        """
        found = self.get(field)
        if found is None:
            raise self.fault(f"{field.key} is missing; it must be {field.expected}")
        return found

    def fault(self, reason: str, key: str = "") -> FileFormatError:
        """An error about an entry of this table, or about the table itself."""
        return FileFormatError(self.file, f"{self.where}{reason}", self.origin.line_of(key))

    def tables(self, field: Field[object], record: Record) -> dict[str, Entries]:
        """Tables of a table, by name; empty without such an entry."""
        found = self.table.get(field.key, {})
        if not isinstance(found, dict) or not all(isinstance(one, dict) for one in found.values()):
            raise self.fault(f"{field.key} must hold tables, [{field.key}.NAME]", field.key)
        return {
            name: Entries(record, one, self._inner(field.key, name), f"{field.key} {name}: ")
            for name, one in found.items()
        }

    def list_of_tables(self, field: Field[object], record: Record) -> list[Entries] | None:
        """Tables one after another; None without such an entry."""
        found = self.table.get(field.key)
        if found is None:
            return None
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise self.fault(f"{field.key} must be a list of tables, [[{field.key}]]", field.key)
        return [Entries(record, one, self._inner(field.key, n), self.where) for n, one in enumerate(found)]

    def table_of(self, field: Field[object], record: Record) -> Entries | None:
        """The one table under a key; None without such an entry."""
        found = self.table.get(field.key)
        if found is None:
            return None
        if not isinstance(found, dict):
            raise self.fault(f"{field.key} must be a table, [{field.key}]", field.key)
        return Entries(record, found, self._inner(field.key), f"{field.key}: ")

    def table_with_own(
        self, field: Field[object], record: Record
    ) -> tuple[Entries, Mapping[str, object]] | None:
        """The one table under a key, and apart the entries that its record does not declare; None without the table."""
        found = self.table.get(field.key)
        if found is None:
            return None
        if not isinstance(found, dict):
            raise self.fault(f"{field.key} must be a table, [{field.key}]", field.key)
        own = {key: value for key, value in found.items() if key not in record.keys}
        known = {key: value for key, value in found.items() if key in record.keys}
        return Entries(record, known, self._inner(field.key), f"{field.key}: "), own

    def each_table(self, field: Field[object], record: Record) -> list[Entries | FileFormatError]:
        """Tables one after another, where one that cannot be read costs only itself; empty without such an entry."""
        listed = self.table.get(field.key, [])
        found: list[Entries | FileFormatError] = []
        for n, one in enumerate(listed if isinstance(listed, list) else []):
            place = self._inner(field.key, n)
            try:
                if not isinstance(one, dict):
                    raise FileFormatError(self.file, f"{field.key} must hold tables, [[{field.key}]]")
                found.append(Entries(record, one, place, self.where))
            except FileFormatError as error:
                found.append(error)
        return found

    def by_name(self, field: Field[object], value: Field[T]) -> dict[str, T]:
        """A table of values under names that people choose; empty without such an entry.

        Args:
            field: The table.
            value: Declaration of each value; its key does not count.
        """
        found = self.table.get(field.key, {})
        if not isinstance(found, dict):
            raise self.fault(f"{field.key} must be a table, [{field.key}]", field.key)
        fields = {name: replace(value, key=name) for name in found}
        record = Record("value", tuple(fields.values()))
        entries = Entries(record, found, self._inner(field.key), f"{field.key}: ")
        return {name: entries.need(one) for name, one in fields.items()}

    def _inner(self, *keys: str | int) -> Origin:
        return replace(self.origin, place=(*self.origin.place, *keys))
