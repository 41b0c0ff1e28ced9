"""Order in which a session's trials are looked at: first one of each kind of name, then a second one of each.

Trials of the same movement are mostly called alike but for a number: walk1, walk2, squat1. So few of them have to be
read, and the order does not depend on that of the folder or list.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import zip_longest

MOST_TRIALS = 12
"""Greatest number of trials that are looked at."""


def rounds(names: Sequence[str]) -> list[list[str]]:
    """The names by rounds, :data:`MOST_TRIALS` in all at most.

    Args:
        names: Names of trials, each once.
    """
    alike: dict[str, list[str]] = {}
    for name in sorted(names, key=_by_numbers):
        alike.setdefault(re.sub(r"[\W\d_]+", "", name.casefold()), []).append(name)
    found, left = [], MOST_TRIALS
    for one in zip_longest(*(alike[kind] for kind in sorted(alike))):
        kept = [name for name in one if name is not None][:left]
        if kept:
            found.append(kept)
        left -= len(kept)
    return found


def _by_numbers(name: str) -> tuple[list[tuple[int, str]], str]:
    """Sorts walk2 before walk10."""
    parts = re.findall(r"\d+|[^\W\d_]+", name.casefold())
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts], name
