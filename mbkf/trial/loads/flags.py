"""Windows in which motion and contacts contradict each other, and the frames of these that a force acts in.

Bounds are shares of body weight. They were set in a study on the shared adult and child and on public captures, and not
changed on the sixty clean trials of `python -m benchmarks loads`: one of these is accused, the others reach 6.4 % over
0.5 s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.runs import runs
from mbkf.numerics.windows import bridged
from mbkf.trial.loads.balance import LoadBalance, Means


class Limit(NamedTuple):
    """Largest share of body weight that the mean force of a clean trial reaches over a duration."""

    duration_s: float
    share: float


LIMITS = (Limit(1.0, 0.05), Limit(0.5, 0.08))
"""A mean force above one of these is unexplained."""

EDGE_S, EDGE_SHARE = 0.1, 0.04
"""Within such windows a force acts from the first to the last frame in which its mean over the duration exceeds the
share of body weight."""

JOINED_S = 0.25
"""Stretches of the same direction less than this apart are one."""

READ_SHARE = 0.005
"""Plates that never read more horizontal force than this share of body weight measure the vertical one alone."""

Force = Callable[[Means], Array]
"""Mean missing force (n, 3) of windows; another one than of the balance as it is where a cause is tried."""


@dataclass(frozen=True)
class Contradictions:
    """A balance with its windows, made once for all causes that are tried.

    Attributes:
        balance: Positions and contacts.
    """

    balance: LoadBalance

    @cached_property
    def windows(self) -> tuple[Means, ...]:
        """The windows of each of :data:`LIMITS`."""
        return tuple(self.balance.means(limit.duration_s) for limit in LIMITS)

    @cached_property
    def edges(self) -> Means:
        """The windows in which beginning and end of a force are looked for."""
        return self.balance.means(EDGE_S)

    @cached_property
    def axes(self) -> tuple[int, ...]:
        """World axes that are judged."""
        level = np.abs(self.balance.feet_n[..., :2]).max(initial=0.0)
        return (2, 0, 1) if level > READ_SHARE * self.balance.weight_n else (2,)

    def missing(self, means: Means) -> Array:
        """(n, 3) missing force of windows as the balance is."""
        return means.missing(self.balance.mass_kg)

    def exceeded(self, force: Force, mass_kg: float | None = None) -> bool:
        """True where any window's force is above its limit.

        Args:
            force: Mean missing force of windows.
            mass_kg: Body mass; by default that of the balance.
        """
        weight_n = self.balance.weight_n * (1.0 if mass_kg is None else mass_kg / self.balance.mass_kg)
        return any(
            bool((np.abs(force(means)[means.judged][:, self.axes]) > limit.share * weight_n).any())
            for limit, means in zip(LIMITS, self.windows, strict=True)
        )

    def acting(self) -> dict[tuple[int, int], BoolArray]:
        """(T,) frames by axis and sign in which a force acts along it."""
        balance, found = self.balance, {}
        course = balance.course(self.edges, self.missing(self.edges))
        acts = {
            (axis, sign): np.nan_to_num(sign * course[:, axis]) > EDGE_SHARE * balance.weight_n
            for axis in self.axes
            for sign in (1, -1)
        }
        for (axis, sign), begun in acts.items():
            above = np.zeros(len(balance.judged), dtype=bool)
            for limit, means in zip(LIMITS, self.windows, strict=True):
                size = np.nan_to_num(sign * self.missing(means)[:, axis])
                above |= balance.covered(size > limit.share * balance.weight_n, means.frames)
            found[axis, sign] = _narrowed(above, begun, round(0.5 * JOINED_S * balance.rate_hz))
        return found


def _narrowed(above: BoolArray, begun: BoolArray, gap: int) -> BoolArray:
    """(T,) stretches of ``above`` (T,) from the first to the last frame of ``begun`` (T,), and short gaps between."""
    found = np.zeros(len(above), dtype=bool)
    for first, after in runs(above):
        inside = first + np.flatnonzero(begun[first:after])
        if len(inside):
            found[inside[0] : inside[-1] + 1] = True
    return bridged(found, gap) if found.any() else found
