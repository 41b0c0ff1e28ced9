"""Affixes that software and laboratories add to the names of a whole set: subjects, studies, systems."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

_FIRST = re.compile(r"([^\s_.|/-]+)[\s_.|/-]+(?=.)")
_LAST = re.compile(r"(?<=.)[\s_.|/-]+([^\s_.|/-]+)$")
_FEW, _SHARE, _ROUNDS = 5, 0.1, 4


@dataclass(frozen=True)
class Core:
    """A name without the affixes that it shares with many others of its set.

    Attributes:
        name: The name in the capture.
        core: The name without its affixes.
        affixes: The affixes; names with the same ones belong together.
    """

    name: str
    core: str
    affixes: tuple[str, ...]


def without_affixes(names: Sequence[str], means: Callable[[str], bool]) -> list[Core]:
    """Names without the first and last words that many of them share and that mean no place.

    A word before a colon is always taken for a subject's name, a number in front for that of a session.

    Args:
        names: Names of the markers of one capture.
        means: True for a word that means a place or a side and must stay.
    """
    cores = []
    for name in names:
        subject, colon, rest = name.rpartition(":")
        cores.append(Core(name, rest, (subject,)) if colon and rest else Core(name, name, ()))
    for pattern in (_FIRST, _LAST):
        for _ in range(_ROUNDS):
            words = [_word(pattern, one.core) for one in cores]
            shared = {
                word
                for word in _shared(words, len(cores))
                if not means(word) or (word.isdigit() and pattern is _FIRST)
            }
            if not shared:
                break
            cores = [
                Core(one.name, pattern.sub("", one.core, count=1), (*one.affixes, word))
                if word in shared
                else one
                for one, word in zip(cores, words, strict=True)
            ]
    return cores


def _word(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.match(text) if pattern is _FIRST else pattern.search(text)
    return found.group(1) if found else ""


def _shared(words: Sequence[str], count: int) -> set[str]:
    """Words on many names of a set, or on all of a few."""
    counts = Counter(word for word in words if word)
    return {
        word
        for word, times in counts.items()
        if times >= 2 and (times == count or (times >= _FEW and times >= _SHARE * count))
    }
