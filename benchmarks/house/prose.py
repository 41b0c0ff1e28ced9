"""Share of docstrings and messages that open with a word, or hold a phrase, that costs a reader a second reading."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from benchmarks.house.sources import tree_of

HARD = re.compile(r"^(?:What|Whether|How|They|None)\b|\btold of\b|\bis no\b")
MOST_HARD = 0.01
"""Largest share of hard texts in the package."""
FEWEST_WORDS = 4
"""Strings of fewer words are names, units and keys."""


class Text(NamedTuple):
    """A docstring (of a definition or of an attribute) or another string of several words, in one line."""

    path: Path
    text: str


def hard_to_read(paths: Iterable[Path]) -> float:
    """Share of hard texts in source files."""
    found = [is_hard(one.text) for one in texts_of(paths)]
    return sum(found) / max(len(found), 1)


def is_hard(text: str) -> bool:
    """True for a text that matches :data:`HARD`."""
    return bool(HARD.search(text))


def texts_of(paths: Iterable[Path]) -> list[Text]:
    """All docstrings and messages of source files."""
    return [Text(path, " ".join(text.split())) for path in paths for text in _texts(tree_of(path))]


def _texts(tree: ast.Module) -> Iterator[str]:
    inner: set[int] = set()
    docstrings: set[int] = set()
    for node in ast.walk(tree):  # a parent comes before its children
        if isinstance(node, ast.Expr):
            docstrings.add(id(node.value))
        if isinstance(node, ast.JoinedStr):
            inner |= {id(part) for part in ast.walk(node) if part is not node}
        if id(node) in inner or not isinstance(node, ast.Constant | ast.JoinedStr):
            continue
        text = _text(node)
        if (id(node) in docstrings and text) or len(text.split()) >= FEWEST_WORDS:
            yield text


def _text(node: ast.Constant | ast.JoinedStr) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "…" for part in node.values)
    return node.value if isinstance(node.value, str) else ""
