"""Affixes that tell the markers of persons apart: ``LASI_A`` and ``LASI_B``, ``P1_LASI`` and ``P2_LASI``.

Where a name stands twice in a file, readers rename the second one: ``LASI``, ``LASI_2``.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.numerics.runs import spread_indices

Indices = NDArray[np.intp]

SIDES = frozenset(
    {"l", "r", "lt", "rt", "lft", "rgt", "left", "right", "li", "re", "links", "rechts"}
    | {"g", "d", "gauche", "droite", "droit", "s", "sx", "dx", "sinistra", "destra"}
    | {"i", "izq", "izquierda", "der", "derecha", "e"}
)
"""Words beside a name that state a side of the body: English, German, French, Italian, Spanish, Portuguese."""

MOSTLY, RARELY = 0.9, 0.1
"""Share of a person's names that have the person's affix at least, and of another person's at most."""

TWINS = 0.7
"""Least share of all names that occur with both affixes of a pair."""

NAMESAKES_M, NEAREST_SHARE = 0.35, 0.2
"""Least distance of markers of the same name, and the share of them that may lie nearer: hips and knees of one body are
0.1 to 0.4 m apart."""

LONGEST, MOST_TRIED, FRAMES = 16, 8, 60
"""Letters of an affix at most, pairs of affixes that are tried, and frames in which distances are looked at."""

SEPARATORS = " _-.:|/"
"""Characters between an affix and a name."""

_AGAIN = re.compile(r"_\d+$")


class Affix(NamedTuple):
    """Letters beside the names of one person's markers.

    Attributes:
        text: The letters; empty where they stand beside other persons' names only.
        before: True where they stand before the names.
    """

    text: str
    before: bool

    def on(self, name: str) -> bool:
        """True for a name that carries it and is longer."""
        carried = name.startswith(self.text) if self.before else name.endswith(self.text)
        return carried and len(name) > len(self.text)

    def base(self, name: str) -> str:
        """A name without the affix and its separators; as it is where it does not carry it."""
        if not self.text or not self.on(name):
            return name
        if self.before:
            return name[len(self.text) :].lstrip(SEPARATORS) or name
        return name[: -len(self.text)].rstrip(SEPARATORS) or name

    def cuts_numbers(self, names: Collection[str]) -> bool:
        """True where it ends within the numbers of most names: ``M0`` of ``M01``, ``M02``."""
        inside = [self.base(name)[0 if self.before else -1].isdigit() for name in names if self.on(name)]
        return self.text.strip(SEPARATORS) == self.text and 2 * sum(inside) > len(inside)

    @property
    def word(self) -> str:
        """The affix without separators."""
        return self.text.strip(SEPARATORS)


def own_affix(names: Sequence[str], others: Sequence[Collection[str]]) -> Affix:
    """The longest affix of most of a person's names that is rare among those of others; an empty one without such.

    Args:
        names: Names of the person's markers.
        others: Names of the markers of each other person.
    """
    for before in (True, False):
        for length in range(LONGEST, 0, -1):
            texts = Counter(
                name[:length] if before else name[-length:] for name in names if len(name) > length
            )
            text, count = texts.most_common(1)[0] if texts else ("", 0)
            affix = Affix(text, before)
            if count < MOSTLY * len(names) or affix.word.lower() in SIDES or affix.cuts_numbers(names):
                continue
            if all(sum(map(affix.on, other)) <= RARELY * len(other) for other in others):
                return affix
    return Affix("", True)


def without_number(name: str, own: Collection[str], others: Collection[str]) -> str:
    """A name without the number that a reader gave to its second occurrence, where the first is another person's.

    Args:
        name: The name.
        own: Names of the person's markers.
        others: Names of the others' markers.
    """
    first = _AGAIN.sub("", name)
    return first if first != name and first in others and first not in own else name


def twins(names: Sequence[str], positions_m: Array) -> tuple[Indices, Indices] | None:
    """Columns of markers whose names occur with two affixes, farther apart than those of one body; None without such.

    Args:
        names: (M,) names of the capture's markers.
        positions_m: (T, M, 3) their places; NaN where not seen.
    """
    column = {name: m for m, name in enumerate(names) if not name.startswith("*")}
    shown = positions_m[spread_indices(len(positions_m), FRAMES)]
    for one, other, bases in _pairs(tuple(column)):
        first, second = (np.array([column[_with(base, affix)] for base in bases]) for affix in (one, other))
        if _far_apart(shown, first, second):
            return first, second
    return None


def _with(base: str, affix: Affix) -> str:
    return affix.text + base if affix.before else base + affix.text


def _pairs(names: tuple[str, ...]) -> Iterator[tuple[Affix, Affix, list[str]]]:
    """Pairs of affixes and the names without them that occur with both, most names first, shorter affixes first."""
    found: dict[tuple[Affix, Affix], list[str]] = defaultdict(list)
    for before in (True, False):
        by_base: dict[str, list[Affix]] = defaultdict(list)
        for name in names:
            for length in range(min(len(name) - 1, LONGEST) + 1):
                cut = length if before else len(name) - length
                text, base = (name[:cut], name[cut:]) if before else (name[cut:], name[:cut])
                by_base[base].append(Affix(text, before))
        for base, affixes in by_base.items():
            for pair in combinations(sorted(affixes), 2):
                found[pair].append(base)
    often = [(pair, bases) for pair, bases in found.items() if 2 * len(bases) >= TWINS * len(names)]
    often.sort(key=lambda one: (-len(one[1]), sum(len(affix.text) for affix in one[0]), one[0]))
    for pair, bases in often[:MOST_TRIED]:
        sides = all(affix.word.lower() in SIDES for affix in pair)
        if not sides and not any(affix.text and affix.cuts_numbers(names) for affix in pair):
            yield *pair, bases


def _far_apart(shown: Array, one: Indices, other: Indices) -> bool:
    """True where markers of the same name lie farther apart than on one body, and nearest to their own set."""
    apart = np.linalg.norm(shown[:, one] - shown[:, other], axis=2)
    apart = apart[:, ~np.isnan(apart).all(axis=0)]
    if 2 * apart.shape[1] < len(one):
        return False
    if np.quantile(np.nanmedian(apart, axis=0), NEAREST_SHARE) < NAMESAKES_M:
        return False
    both = shown[:, np.concatenate([one, other])]
    between = np.linalg.norm(both[:, :, None] - both[:, None], axis=3)
    between[:, np.isnan(between).all(axis=0)] = np.inf
    usual = np.nanmedian(between, axis=0)
    np.fill_diagonal(usual, np.inf)
    first = np.arange(len(usual)) < len(one)
    return bool((first[usual.argmin(axis=1)] == first).mean() >= MOSTLY)
