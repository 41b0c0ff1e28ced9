"""Gyroscopes that clip softly: readings gather just below a limit that they never pass, without being equal.

Found by two signs together: the histogram of an axis has its last bin far fuller than those before it, and another axis
or side ends at the same size, or gravity, turned into a fixed frame by the gyroscope, stays longer where these readings
are taken for larger ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.imu.turned_force import mean_force
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.runs import runs

LEAST_LIMIT_RAD_S = 1.7
"""No gyroscope on the market has a smaller range."""

_PLATEAU, _BEFORE = 0.985, 0.955
_LEAST_SAMPLES, _FULLER = 20, 8.0
"""The readings above the first share of the limit, and how many times as many they are as those between the shares,
for a bin of the same width. On sound public recordings (BROAD, qmt, gaitmap) it is at most 4."""

_SAME_LIMIT = 0.01
"""Relative difference of two limits of one range: readings gather in the last hundredth below it."""

_SCALES = (1.25, 1.5, 2.0, 2.5)
_BETTER = 0.03
_WINDOW_S, _MOST_WINDOWS = 2.0, 40


@dataclass(frozen=True)
class SoftLimit:
    """A limit of one axis on one side.

    Attributes:
        axis: 0, 1 or 2.
        limit_rad_s: The largest reading, with its sign.
        reached: (T,) samples at the limit.
    """

    axis: int
    limit_rad_s: float
    reached: BoolArray


def soft_limits(one: ImuReadings) -> tuple[SoftLimit, ...]:
    """The limits at which a gyroscope clips softly.

    Two full last bins at one size are a range. A single one may be a steady turn: gravity judges it, both sides of an
    axis together.
    """
    rates = one.angular_velocity_rad_s
    sides = [_plateau(rates[:, axis], axis, sign) for axis in range(3) for sign in (1.0, -1.0)]
    full = [side for side in sides if side is not None]
    found: list[SoftLimit] = []
    for axis in range(3):
        own = [side for side in full if side.axis == axis]
        if any(_has_twin(side, full) for side in own) or (
            own and _gravity_turns_more(one, axis, np.any([side.reached for side in own], axis=0))
        ):
            found += own
    return tuple(found)


def _has_twin(side: SoftLimit, others: Sequence[SoftLimit]) -> bool:
    """True where another axis or side ends at the same size."""
    sizes = [abs(other.limit_rad_s) for other in others if other is not side]
    return any(abs(size / abs(side.limit_rad_s) - 1.0) < _SAME_LIMIT for size in sizes)


def missing_turn_variance(one: ImuReadings) -> Array | None:
    """(T, 3) variance of the turn that a clipped gyroscope misses in each sample, rad²; None where it does not clip.

    A peak that rises to the limit at a slope s, and is above it for a time t, is about a parabola: its mean excess is
    s t / 6. All samples of a peak miss alike, so that each of n counts n times.
    """
    limits = soft_limits(one)
    if not limits:
        return None
    found, dt = np.zeros((one.samples, 3)), 1.0 / one.rate_hz
    for limit in limits:
        steps = np.abs(np.diff(np.nan_to_num(one.angular_velocity_rad_s[:, limit.axis]))) / dt
        for first, stop in runs(limit.reached):
            outside = steps[[max(first - 2, 0), min(stop, len(steps) - 1)]]  # the step at the limit is cut
            missed = outside.mean() * (stop - first) * dt / 6.0
            found[first:stop, limit.axis] = (missed * dt) ** 2 * (stop - first)
    return found


def _plateau(series: Array, axis: int, sign: float) -> SoftLimit | None:
    """A limit by the histogram alone."""
    values = np.nan_to_num(sign * series)
    top = float(values.max(initial=0.0))
    reached = np.asarray(values > _PLATEAU * top)
    before = int(((values > _BEFORE * top) & ~reached).sum())
    count, width = int(reached.sum()), (1.0 - _PLATEAU) / (_PLATEAU - _BEFORE)
    if top < LEAST_LIMIT_RAD_S or count < _LEAST_SAMPLES or count < _FULLER * max(1.0, width * before):
        return None
    return SoftLimit(axis, sign * top, reached)


def _gravity_turns_more(one: ImuReadings, axis: int, reached: BoolArray) -> bool:
    """True where the mean force over some seconds is nearer to 1 g with larger rates at the limit."""
    length = max(2, round(_WINDOW_S * one.rate_hz))
    starts = np.arange(0, one.samples - length + 1, max(1, length // 2))
    at = starts[:, None] + np.arange(length)
    both = np.hstack([one.specific_force_mps2, one.angular_velocity_rad_s])
    whole = np.asarray(np.isfinite(both).all(axis=1))
    counts = reached[at].sum(axis=1) * whole[at].all(axis=1)
    at = at[np.argsort(counts)[-_MOST_WINDOWS:]]
    at = at[reached[at].any(axis=1) & whole[at].all(axis=1)]
    if not len(at):
        return False
    force, rates, full = one.specific_force_mps2[at], one.angular_velocity_rad_s[at], reached[at]
    off = []
    for scale in (1.0, *_SCALES):
        scaled = rates.copy()
        scaled[..., axis] *= np.where(full, scale, 1.0)
        off.append(abs(mean_force(scaled / one.rate_hz, force) / GRAVITY_M_S2 - 1.0))
    return off[0] - min(off[1:]) > _BETTER
