"""Search for the maximum of a function that is slow, slightly rough, and only known inside a box.

One coordinate after the other is tried on both sides, and where a parabola through the three values peaks; steps
shrink where that no longer helps. No derivatives, no randomness, never more calls than allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array

SHRINK = 0.4
"""Factor of a step that its coordinate did not use."""


@dataclass(frozen=True)
class Maximum:
    """Where a search ended.

    Attributes:
        x: (n,) best point.
        value: The function there.
        calls: How often it was called.
        settled: Whether all steps had become as small as asked for before the calls were used up.
    """

    x: Array
    value: float
    calls: int
    settled: bool


def maximise(
    function: Callable[[Array], float],
    start: Array,
    low: Array,
    high: Array,
    *,
    step: float = 0.7,
    tolerance: float = 0.05,
    calls: int = 60,
) -> Maximum:
    """The largest value found of a function of a few variables in a box; never below that at the start.

    Args:
        function: To maximise; −inf or NaN where it has no value.
        start: (n,) first point.
        low: (n,) least coordinates.
        high: (n,) greatest coordinates.
        step: First step of every coordinate.
        tolerance: A coordinate with a smaller step is left alone.
        calls: Most calls of the function.
    """
    search = _Search(function, low, high, calls)
    x = np.clip(start, low, high)
    best = search.value(x)
    steps = np.full(len(x), step)
    while search.left and (steps > tolerance).any():
        for i in np.flatnonzero(steps > tolerance):
            moved, best = search.along(x, best, int(i), float(steps[i]))
            x[i] += moved
            if abs(moved) < 0.5 * steps[i]:
                steps[i] *= SHRINK
    return Maximum(x, best, search.used, bool((steps <= tolerance).all()))


class _Search:
    """The function, its box and the evaluations left."""

    def __init__(self, function: Callable[[Array], float], low: Array, high: Array, calls: int) -> None:
        self._function, self._low, self._high, self._calls = function, low, high, calls
        self.used = 0

    @property
    def left(self) -> int:
        return self._calls - self.used

    def value(self, x: Array) -> float:
        """The function, −inf where it is not a number."""
        self.used += 1
        value = float(self._function(x.copy()))
        return value if value == value else -math.inf  # noqa: PLR0124, NaN

    def along(self, x: Array, here: float, i: int, h: float) -> tuple[float, float]:
        """Step along a coordinate, and the value there."""
        known = {0.0: here}
        for d in (h, -h):
            self._try(known, x, i, d)
        if h in known and -h in known:
            bend = 2.0 * here - known[h] - known[-h]
            if math.isfinite(bend) and bend > 0.0:
                peak = 0.5 * h * (known[h] - known[-h]) / bend
                self._try(known, x, i, min(max(peak, -2.0 * h), 2.0 * h))
        best = max(known, key=lambda d: known[d])
        return best, known[best]

    def _try(self, known: dict[float, float], x: Array, i: int, d: float) -> None:
        d = float(min(max(d, self._low[i] - x[i]), self._high[i] - x[i]))
        if self.left and all(abs(d - other) > 1e-3 for other in known):
            there = x.copy()
            there[i] += d
            known[d] = self.value(there)
