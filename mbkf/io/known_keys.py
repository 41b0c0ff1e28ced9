"""Keys of the nested tables of a file: one that is not known is refused with its line and the nearest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from mbkf.conventions import TomlTable
from mbkf.errors import UnknownEntry
from mbkf.io.toml_lines import Place, line_of

Known = Mapping[str, tuple[str, ...]]
"""Keys of each table, which is named by the keys that lead to it with dots between them; "" is the file itself."""


def refuse_unknown(
    table: TomlTable, known: Known, path: Path, text: str = "", remarks: tuple[str, ...] = ()
) -> None:
    """Refuses a key that no table of the file has.

    Args:
        table: The file's table.
        known: The keys of its tables; a table that is not listed may have any.
        path: The file, for the message.
        text: Its text, for the line.
        remarks: Endings of keys that hold remarks of the author.

    Raises:
        UnknownEntry: It has such a key.
    """
    for name, place, one in _tables(table, "", ()):
        for key in one:
            keys = known.get(name)
            if keys is not None and key not in keys and not key.endswith(remarks):
                kind = f"{name} entry" if name else "entry"
                line = line_of(text, (*place, key)) if text else None
                raise UnknownEntry(path, kind, key, keys, line)


def _tables(table: TomlTable, name: str, place: Place) -> Iterator[tuple[str, Place, TomlTable]]:
    """All tables of a table, itself first, each with its name and its way."""
    yield name, place, table
    for key, value in table.items():
        inner = f"{name}.{key}" if name else key
        if isinstance(value, dict):
            yield from _tables(value, inner, (*place, key))
        elif isinstance(value, list):
            for n, one in enumerate(value):
                if isinstance(one, dict):
                    yield from _tables(one, inner, (*place, key, n))
