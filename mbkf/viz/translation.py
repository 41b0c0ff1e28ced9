"""A page or plain data in one language: texts of the library that stand in it are said in its words.

Elements with ``translate="no"`` stay as they are: names of persons, trials and files.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape, unescape

from mbkf.viz.sentences import said

SPOKEN = ("title", "aria-label", "placeholder", "alt")
"""Attributes that a person reads or hears."""

_TAG = re.compile(r"(<!--.*?-->|<[^<>]*>)", re.S)
_NAME = re.compile(r"</?([\w-]+)")
_ATTRIBUTE = re.compile(rf'(?<=\s)({"|".join(SPOKEN)})="([^"]*)"')
_KEPT = re.compile(r"""\stranslate=["']no["']""")
_CODE = ("script", "style", "code")
_EMPTY = ("br", "img", "input", "meta", "link", "hr")


def translated(html: str, language: str) -> str:
    """HTML with every text in the words of a language.

    Args:
        html: Of a page, or of a part of it.
        language: Code of the language.
    """
    return "".join(_translated(html, language))


def _translated(html: str, language: str) -> Iterator[str]:
    kept: list[str] = []  # open elements from the outermost that is left alone
    for k, piece in enumerate(_TAG.split(html)):
        if k % 2:
            yield piece if kept else _ATTRIBUTE.sub(lambda found: _attribute(found, language), piece)
            _follow(kept, piece)
        elif kept or not piece.strip():
            yield piece
        else:
            text = piece.strip()
            before, after = piece[: piece.index(text)], piece[piece.index(text) + len(text) :]
            yield before + escape(said(unescape(text), language)) + after


def _attribute(found: re.Match[str], language: str) -> str:
    return f'{found[1]}="{escape(said(unescape(found[2]), language))}"'


def _follow(kept: list[str], tag: str) -> None:
    """Keeps count of the elements inside one that is left alone."""
    named = _NAME.match(tag)
    if named is None or tag.endswith("/>") or named[1] in _EMPTY:
        return
    if tag.startswith("</"):
        if kept and kept[-1] == named[1]:
            kept.pop()
    elif kept or named[1] in _CODE or _KEPT.search(tag):
        kept.append(named[1])


def translated_data(data: object, language: str, names: frozenset[str]) -> object:
    """Plain data in which the texts of some entries are in the words of a language.

    Args:
        data: Tables, lists, texts and numbers.
        language: Code of the language.
        names: Entries whose texts, or texts in lists, are said.
    """
    if isinstance(data, dict):
        return {
            name: _all_said(value, language) if name in names else translated_data(value, language, names)
            for name, value in data.items()
        }
    if isinstance(data, list | tuple):
        return [translated_data(one, language, names) for one in data]
    return data


def _all_said(value: object, language: str) -> object:
    if isinstance(value, str):
        return said(value, language)
    if isinstance(value, list | tuple):
        return [_all_said(one, language) for one in value]
    return value
