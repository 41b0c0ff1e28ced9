"""Likelier causes of a contradiction than a load: a wrong mass, unequal clocks, a foot beside its plate.

Each is tried by what it would change; it is the cause if nothing is left unexplained then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.unexplained import Cause
from mbkf.numerics.runs import runs
from mbkf.trial.loads.balance import LoadBalance, Means
from mbkf.trial.loads.flags import Contradictions

MASS_RANGE = (0.5, 2.0)
"""Range of the plates' mass over the stated one that is taken for a wrong mass."""

THROUGHOUT = 0.6
"""Least share of the judged frames that a wrong mass contradicts."""

SHIFT_S = 0.2
"""Largest difference of clocks that is tried."""

STANCE_S = 0.1
"""Least duration of a stance."""

STANCE_SHARE, BESIDE_SHARE = 0.8, 0.7
"""A foot beside its plate stands during this share of the load, and in less than that share of the judged frames."""

GAIN_RANGE = (0.15, 6.0)
"""Range of a foot's required force over the measured one that is taken for a foot beside its plate."""

FEET: tuple[Cause, Cause] = ("right_foot", "left_foot")


class Found(NamedTuple):
    """The cause of a load, empty for the load itself, and the hint on it."""

    cause: Cause
    hint: str


LOAD = Found(
    "",
    "no contact that was found gives it (a seat, hand, harness or carried load?); loads are not to be used there",
)


def causes(trial: Contradictions, stretches: Sequence[tuple[int, int]]) -> list[Found]:
    """The cause of each contradiction.

    Args:
        trial: The trial.
        stretches: First frame and the frame after the last of each.
    """
    common = _mass(trial, stretches) or _clock(trial)
    if common is not None:
        return [common] * len(stretches)
    return [_foot(trial, one) or LOAD for one in stretches]


def _mass(trial: Contradictions, stretches: Sequence[tuple[int, int]]) -> Found | None:
    """A mass with which nothing is left, where one contradicts most of the trial."""
    balance, half = trial.balance, trial.windows[-1]
    spoilt = sum(after - first for first, after in stretches)
    if spoilt < THROUGHOUT * balance.judged.sum():
        return None
    given = half.feet.sum(axis=1) + half.others
    required, given = half.required[half.judged, 2], given[half.judged, 2]
    mass_kg = float(required @ given / (required @ required))
    least, most = (share * balance.mass_kg for share in MASS_RANGE)
    if not least < mass_kg < most or trial.exceeded(lambda means: means.missing(mass_kg), mass_kg):
        return None
    more = mass_kg - balance.mass_kg
    other = f", or {more:.1f} kg are carried" if more > 0.0 else ""
    return Found(
        "mass",
        f"the forces are those of {mass_kg:.1f} kg throughout, the subject has {balance.mass_kg:.1f} kg: scale with "
        f"--mass {mass_kg:.1f}{other}; loads are not to be used",
    )


def _clock(trial: Contradictions) -> Found | None:
    """The least shift of the contacts' forces with which nothing is left."""
    balance = trial.balance
    for frames in range(1, round(SHIFT_S * balance.rate_hz) + 1):
        for later in (frames, -frames):
            shifted = Contradictions(_earlier(balance, later))
            if not shifted.balance.judged.any() or shifted.exceeded(shifted.missing):
                continue
            much = 1e3 * frames / balance.rate_hz
            late = "late" if later > 0 else "early"
            return Found(
                "clock",
                f"with the plates {much:.0f} ms {'earlier' if later > 0 else 'later'} nothing is left: their clock is "
                f"{late}; loads are not to be used",
            )
    return None


def _earlier(balance: LoadBalance, frames: int) -> LoadBalance:
    """The balance with forces so many frames earlier."""
    come = np.roll(balance.judged, -frames)
    come[len(come) - frames if frames > 0 else 0 : len(come) if frames > 0 else -frames] = False
    return replace(
        balance,
        feet_n=np.roll(balance.feet_n, -frames, axis=0),
        others_n=np.roll(balance.others_n, -frames, axis=0),
        judged=balance.judged & come,
    )


def _foot(trial: Contradictions, stretch: tuple[int, int]) -> Found | None:
    """A gain of one foot's force in the stance that a contradiction lies in, with which nothing is left there."""
    balance, (first, after) = trial.balance, stretch
    for foot, cause in enumerate(FEET):
        for begin, end in stances(balance.feet_n[:, foot], balance.rate_hz, STANCE_S):
            shared = min(after, end) - max(first, begin)
            brief = balance.judged[begin:end].sum() < BESIDE_SHARE * balance.judged.sum()
            if brief and shared >= STANCE_SHARE * (after - first):
                gain = _gain(trial, foot, (begin, end))
                if gain is not None:
                    return Found(
                        cause,
                        f"it acts while the {cause.replace('_', ' ')} is on a plate, and goes with {gain:.1f} times "
                        "the force that this plate reads: the foot stands partly beside it, or its scale is wrong; "
                        "loads are not to be used there",
                    )
    return None


def _gain(trial: Contradictions, foot: int, stance: tuple[int, int]) -> float | None:
    """Required over measured force of a foot in a stance; None where something is left in its frames with it."""
    balance, (begin, end) = trial.balance, stance
    feet = np.zeros_like(balance.feet_n)
    feet[begin:end, foot] = balance.feet_n[begin:end, foot]
    alone = Contradictions(replace(balance, feet_n=feet))
    half, own = trial.windows[-1], alone.windows[-1].feet.sum(axis=1)
    touched = half.judged & _touching(half, stance)
    if not touched.any():
        return None
    lacks, gives = trial.missing(half)[touched, 2], own[touched, 2]
    more = float(lacks @ gives / max(gives @ gives, 1e-9))
    if not GAIN_RANGE[0] < 1.0 + more < GAIN_RANGE[1]:
        return None
    sums = {
        means.frames: one.feet.sum(axis=1) for means, one in zip(trial.windows, alone.windows, strict=True)
    }

    def left(means: Means) -> Array:
        lacking = trial.missing(means) - more * sums[means.frames]
        return np.where(_touching(means, stance)[:, None], lacking, 0.0)

    return None if trial.exceeded(left) else 1.0 + more


def _touching(means: Means, stance: tuple[int, int]) -> BoolArray:
    """(n,) windows that hold frames of a stance."""
    begins = np.arange(len(means.judged))
    return np.asarray((begins < stance[1]) & (begins + means.frames > stance[0]))


def stances(force_n: Array, rate_hz: float, least_s: float) -> Iterator[tuple[int, int]]:
    """First frame and the frame after the last of each loading of a foot.

    Args:
        force_n: (T, 3) its force.
        rate_hz: Frame rate.
        least_s: Least duration.
    """
    return ((a, b) for a, b in runs(np.asarray(force_n.any(axis=1))) if b - a >= least_s * rate_hz)
