"""Texts that stand in the scripts and pages of ``mbkf/viz/assets`` themselves, in one language."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import mbkf
from benchmarks.clinic.words.texts import FUNCTION_WORDS, texts_of

ASSETS = Path(mbkf.__file__).parent / "viz" / "assets"

_STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`|\'((?:[^\'\\\n]|\\.)*)\'')
_COMMENT = re.compile(r"(?<![:\"'])//[^\n]*|/\*[^*]*\*/")
_PHRASE = re.compile(r"[a-z]{2,} [a-z]{2,}", re.I)

NO_TEXTS = ("use strict", "mbkf language", "marker set done", "system-ui", "application/json")
"""Words of the language and names of browsers' stores and messages."""

SERVERS_WORDS = (
    "not in the set",
    "left out by hand",
    "not known which marker this is",
    "Following markers alone",
    "do not use",
)
"""Words that the server sends or stores, which the page looks up."""


def untranslated() -> tuple[int, list[str]]:
    """Number of texts that stand in assets, and those that a person reads in one language alone."""
    count, found = 0, []
    for path in sorted(ASSETS.iterdir()):
        if path.suffix == ".js":
            texts = list(_literals(_COMMENT.sub(" ", path.read_text(encoding="utf-8"))))
        elif path.suffix == ".html":
            texts = [
                one
                for one in texts_of(path.read_text(encoding="utf-8"))
                if "{{" not in one and one not in ("mbkf", "mbkf live")
            ]
        else:
            continue
        count += len(texts)
        found += [f"{path.name}: {one}" for one in texts if path.suffix == ".html" or _is_text(one)]
    return count, found


def _literals(script: str) -> Iterator[str]:
    for parts in _STRING.findall(script):
        yield next((one for one in parts if one), "")


def _is_text(literal: str) -> bool:
    if literal in SERVERS_WORDS or any(one in literal for one in NO_TEXTS):
        return False
    plain = re.sub(r"\$\{[^{}]*\}", " ", literal)
    if not _PHRASE.search(plain) or re.search(
        r"[{}<>=;#]|\.\w+ \w|^\w+-\w+$|px|\b(?:input|select|button|summary|tbody)\b", plain
    ):
        return False
    return (
        bool(FUNCTION_WORDS & set(plain.lower().split()))
        or plain[:1].isupper()
        or len(re.findall(r"[a-z]+", plain, re.I)) > 3
    )
