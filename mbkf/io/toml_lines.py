"""Lines of entries in a TOML text, and mistakes of syntax in the words of the person who made them.

The standard parser keeps no lines. Those of an error are found anew, by the titles and keys as they stand in the text.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass

Place = tuple[str | int, ...]
"""Way to an entry: keys, and after that of a list of tables the number of the table, from 0."""

LONGEST_LINE = 500
"""Length of the longest line that is searched for a common mistake; a person's line is shorter."""

# Patterns as texts, since few files have a mistake, and compiling all takes longer than reading one.
_TITLE = r"\s*(\[\[?)(.+?)\]\]?\s*(?:#.*)?"
_ENTRY = (
    r"\s*((?:[\w-]+|\"(?:[^\"\\]|\\.)*\"|'[^']*')(?:\s*\.\s*(?:[\w-]+|\"(?:[^\"\\]|\\.)*\"|'[^']*'))*)\s*="
)
_PART = r"[\w-]+|\"(?:[^\"\\]|\\.)*\"|'[^']*'"
_LONG = r"'''|\"\"\""
_AT_LINE = r" \(at (?:line (\d+), column \d+|end of document)\)$"

_DECIMAL_COMMA = r"(\s*[\w.\"'-]+\s*=\s*)([+-]?\d+),(\d+)\s*(?:#.*)?"
_UNIT = r"(\s*[\w.\"'-]+\s*=\s*[+-]?\d+(?:\.\d+)?)\s*([A-Za-z]+)\s*(?:#.*)?"
_BARE_TEXT = r"(\s*[\w.\"'-]+\s*=\s*)([^\W\d][^\"'#=]*?)\s*(?:#.*)?"
_COLON = r"\s*([\w-]+)\s*:\s*(.*)"
_CURLY = "[\u2018\u2019\u201a\u201c\u201d\u201e\u00ab\u00bb]"
_SPACED_KEY = r"\s*([A-Za-z_]\w*(?:\s+\(?\w+\)?)+)\s*="


class TomlMistake(ValueError):
    """A text that is no TOML.

    Attributes:
        reason: The line and its mistake.
        line: Number of the line, from 1.
    """

    def __init__(self, reason: str, line: int) -> None:
        self.reason, self.line = reason, line
        super().__init__(f"line {line}, {reason}")


@dataclass
class _Course:
    """Tables that the lines before have opened, and how often each list of tables was."""

    table: Place
    counts: dict[Place, int]


def line_of(text: str, place: Place) -> int | None:
    """Number of the line, from 1, on which an entry or the title of a table stands; None where it is not found."""
    return next((line for line, here in _places(text) if here[: len(place)] == place), None)


def mistake(text: str, error: tomllib.TOMLDecodeError) -> TomlMistake:
    """An error of the parser with its line and, where the mistake is a common one, its mend."""
    match = re.search(_AT_LINE, str(error))
    lines = text.split("\n")
    number = int(match[1]) if match is not None and match[1] else max(len(lines), 1)
    line = lines[number - 1].strip() if number <= len(lines) else ""
    reason = str(error)[: match.start()] if match is not None else str(error)
    advice = _advice(line, reason) if len(line) <= LONGEST_LINE else ""
    said = f"'{line[:60]}': {advice or reason[:120]}" if line else reason[:120]
    return TomlMistake(said, number)


def _advice(line: str, reason: str) -> str:
    """The mend of a common mistake; empty for others."""
    if match := re.fullmatch(_DECIMAL_COMMA, line):
        return f"decimals have a point, write {match[1].strip()} {match[2]}.{match[3]}"
    if match := re.fullmatch(_UNIT, line):
        return f"a number stands without its unit, write {match[1].strip()}"
    if re.search(_CURLY, line):
        return 'quotation marks must be straight, write " instead of curly ones'
    if match := re.match(_SPACED_KEY, line):
        return f"an entry's name has no spaces; '{match[1]}' must be one of the entries of the documentation"
    if match := re.fullmatch(_COLON, line):
        return f"an entry has an equals sign, write {match[1]} = …"
    if match := re.fullmatch(_BARE_TEXT, line):
        return f'a text stands in quotation marks, write {match[1].strip()} "{match[2]}"'
    if "overwrite" in reason or "declare" in reason:
        return "this entry stands above already; keep one of them"
    if "\\" in line and ("scape" in reason or "hex" in reason):
        return "a backslash is not possible in a text, write / instead"
    return ""


def _places(text: str) -> Iterator[tuple[int, Place]]:
    """Lines with the way to the entry or table that stands on each."""
    course, closing = _Course((), {}), ""
    for number, line in enumerate(text.split("\n"), start=1):
        if closing:
            closing = "" if line.count(closing) % 2 else closing
            continue
        title, entry = re.fullmatch(_TITLE, line), re.match(_ENTRY, line)
        if entry is not None:
            yield number, (*course.table, *_parts(entry[1]))
        elif title is not None:
            _open(course, _parts(title[2]), title[1] == "[[")
            yield number, course.table
        opened = re.search(_LONG, line)
        if opened is not None and line.count(opened[0]) % 2:
            closing = opened[0]


def _open(course: _Course, keys: tuple[str, ...], listed: bool) -> None:
    """Goes into the table of a title."""
    place: Place = ()
    for depth, key in enumerate(keys):
        place = (*place, key)
        if depth == len(keys) - 1 and listed:
            course.counts[place] = course.counts.get(place, -1) + 1
        if place in course.counts:
            place = (*place, course.counts[place])
    course.table = place


def _parts(keys: str) -> tuple[str, ...]:
    """The keys of a dotted key, without quotation marks."""
    return tuple(part[1:-1] if part[0] in "\"'" else part for part in re.findall(_PART, keys))
