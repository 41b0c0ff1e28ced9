"""Plain data from files, TOML and JSON: bounded in size, depth and numbers, whatever a file holds.

The parsers themselves are bounded in none of these: brackets in brackets end them with an error of their own, a key of
ten thousand parts takes them minutes, and a whole number of four hundred digits is one that no float holds.
"""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

from mbkf.conventions import JsonTable, TomlTable
from mbkf.io.files_read import SETTINGS_BYTES, read_bytes
from mbkf.io.toml_lines import mistake

MOST_PARTS = 32
"""Parts of the longest key between dots."""

MOST_INTEGER = 2**63
"""TOML promises whole numbers of 64 bits (TOML v1.0.0, section Integer); larger ones are damage."""

_LONG_KEY = re.compile(
    rf"(?<![\w-])(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}", re.ASCII
)
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def read_toml(path: Path) -> TomlTable:
    """The table of a TOML file in UTF-8, with or without a byte order mark.

    Raises:
        OSError: The file does not exist, or it cannot be read.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        ValueError: It is not in UTF-8, or as for :func:`parse_toml`.
    """
    return parse_toml(plain_text(path))


def plain_text(path: Path) -> str:
    """The text of a file in UTF-8, with or without a byte order mark.

    Raises:
        OSError: The file does not exist, or it cannot be read.
        FileFormatError: It is a folder, pipe, socket or device, or too large.
        ValueError: It is not in UTF-8.
    """
    content = read_bytes(path, SETTINGS_BYTES)
    if content.startswith(_UTF_16):
        raise UnicodeError("it is in UTF-16; save it in UTF-8")
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnicodeError(f"line {line} is not in UTF-8; save the file in UTF-8") from error


def parse_toml(text: str) -> TomlTable:
    """The table of a TOML text.

    Raises:
        TomlMistake: It is not TOML; with its line and the mend of a common mistake.
        ValueError: It is nested too deep, or holds a whole number of more than 64 bits.
    """
    long_key = _LONG_KEY.search(text)
    if long_key is not None:
        line = text.count("\n", 0, long_key.start()) + 1
        raise ValueError(f"a name of more than {MOST_PARTS} parts between dots (at line {line})")
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise mistake(text, error) from error
    except RecursionError as error:
        raise ValueError("nested too deep") from error
    _check_integers(table)
    return table


def parse_json(text: str | bytes) -> JsonTable:
    """The object that a JSON text holds.

    Raises:
        ValueError: It is not a JSON object, or nested too deep, or holds a whole number of more than 64 bits.
    """
    try:
        found = json.loads(text)
    except RecursionError as error:
        raise ValueError("nested too deep") from error
    if not isinstance(found, dict):
        raise ValueError("it holds no table of names and values")
    _check_integers(found)
    return found


def number_between(
    table: JsonTable, key: str, low: float, high: float, default: float | None = None
) -> float:
    """A number of a table that lies between two others.

    Args:
        table: The table.
        key: Its name.
        low: The smallest that is possible.
        high: The largest that is possible.
        default: Value of a missing entry; None for a required one.

    Raises:
        KeyError: A required entry is missing.
        ValueError: It is not a number, or lies elsewhere.
    """
    value = table[key] if default is None else table.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError(f"{key} must be a number between {low:g} and {high:g}, got {value!r}")
    return float(value)


def _check_integers(table: JsonTable) -> None:
    """Refuses whole numbers of more than 64 bits, at whatever depth they stand."""
    waiting: list[object] = [table]
    while waiting:
        one = waiting.pop()
        if isinstance(one, dict):
            waiting.extend(one.values())
        elif isinstance(one, list):
            waiting.extend(one)
        elif isinstance(one, int) and not -MOST_INTEGER <= one < MOST_INTEGER:
            raise ValueError("a whole number of more than 64 bits")
