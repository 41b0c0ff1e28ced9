"""Which cycles a mean is of: measured loads and estimated ones are never averaged together.

Angles are means of all cycles. Loads of a leg are means of the cycles in which a plate of its own measured the foot,
those of the trunk of the cycles in which every contact was measured; otherwise of those whose loads are
estimated well enough, and marked as estimated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.study.session.cycles import Key, SideCycles
from mbkf.study.session.means import Mean, mean_of


@dataclass(frozen=True)
class Chosen:
    """The cycles of a quantity, and the mean.

    Attributes:
        mean: The mean of the cycles that count; None: no such cycle.
        estimated: These are estimated, since no cycle is measured.
        counted: (K, 101) the cycles that count.
        others: (L, 101) estimated cycles beside measured ones: shown, never averaged.
        off_percent: Mean toe-off of the cycles that count; NaN without.
    """

    mean: Mean | None
    estimated: bool
    counted: Array
    others: Array
    off_percent: float


def chosen_curves(side: SideCycles, key: Key) -> Chosen:
    """The cycles of a quantity that count, and the others.

    Args:
        side: The cycles of a side.
        key: The quantity, one of ``side.curves``.
    """
    curves = side.curves[key]
    finite = np.asarray(np.isfinite(curves.values).all(axis=1))
    flags = [
        (c.body_measured, c.body_valid) if curves.midline else (c.measured, c.valid) for c in side.cycles
    ]
    measured, valid = np.array(flags, dtype=bool).reshape(-1, 2).T
    counts = finite & (measured & valid | (not key.is_load))
    others = finite & valid & ~measured & key.is_load
    estimated = not counts.any() and bool(others.any())
    if estimated:
        counts, others = others, counts
    return Chosen(
        _mean(side, key, counts),
        estimated,
        curves.values[counts],
        curves.values[others],
        float(np.mean([side.cycles[k].cycle.off_percent for k in np.flatnonzero(counts)]))
        if counts.any()
        else np.nan,
    )


def _mean(side: SideCycles, key: Key, counts: BoolArray) -> Mean | None:
    if not counts.any():
        return None
    curves = side.curves[key]
    names = [side.cycles[k].trial for k in np.flatnonzero(counts)]
    own = np.sqrt(np.maximum(curves.sd[counts] ** 2 - np.nan_to_num(curves.shift_sd[counts]) ** 2, 0.0))
    return mean_of(curves.values[counts], names, curves.shift_sd[counts], own, curves.change_sd[counts])
