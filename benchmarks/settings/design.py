"""Combinations of choices: all of them, or a few that show every pair of choices together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, product

Choices = tuple[str, ...]
"""A word for each factor, in their order."""

FACTORS: Mapping[str, Choices] = {
    "integrator": ("FE", "HE", "TF", "TN", "RK4"),
    "propagation": ("first", "second", "exponential"),
    "covariance": ("series", "van_loan"),
    "complete": ("true", "false"),
    "noise": ("stable", "density", "per frame"),
    "plates": ("sensors", "inputs"),
}
"""Choices of every factor; of noise: mbkf's own, and the thesis's table in both readings."""

BASE: Choices = ("FE", "second", "series", "true", "per frame", "sensors")
"""The combination whose factors are changed one by one. F is complete: a simplified one of plain coordinates has
F³ = 0, so that second order and exponential are the same."""


def every_combination(leaving_out: str = "") -> list[Choices]:
    """The full product, without one choice if so asked."""
    return [one for one in product(*FACTORS.values()) if leaving_out not in one]


def every_pair() -> list[Choices]:
    """Combinations, chosen one by one, each to show the most pairs of choices that no earlier one shows."""
    left, chosen = set().union(*map(_pairs, every_combination())), []
    while left:
        best = max(every_combination(), key=lambda one: len(left & _pairs(one)))
        chosen.append(best)
        left -= _pairs(best)
    return chosen


def single_changes(leaving_out: str = "") -> Iterator[Choices]:
    """The base with another choice of one factor, without one choice if so asked."""
    for k, words in enumerate(FACTORS.values()):
        for word in words:
            if word not in (BASE[k], leaving_out):
                yield (*BASE[:k], word, *BASE[k + 1 :])


def _pairs(one: Choices) -> set[tuple[int, str, int, str]]:
    return {(i, one[i], j, one[j]) for i, j in combinations(range(len(one)), 2)}
