"""What a pendulum filter is given, what it gives back, and how the two are compared."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Protocol

import numpy as np

from benchmarks.double_pendulum.motions import (
    PendulumMotion,
    PendulumNoise,
    PendulumReadings,
    pendulum_motion,
    readings,
)
from benchmarks.double_pendulum.pendulum import PendulumShape
from benchmarks.thesis_report.delay import delay
from mbkf.conventions import Array, BoolArray

AFTER_GAP_S = 0.3
"""What counts as after a gap: as long again as the gap itself."""


@dataclass(frozen=True)
class Trial:
    """A true motion and one reading of it.

    Attributes:
        motion: The truth.
        read: What the sensors read.
        hidden: (T,) frames in which markers are lost.
    """

    motion: PendulumMotion
    read: PendulumReadings
    hidden: BoolArray

    @property
    def dt_s(self) -> float:
        """Time between frames."""
        return float(self.motion.times_s[1] - self.motion.times_s[0])


@dataclass(frozen=True)
class Recipe:
    """How trials are made: the same seed gives the same noise in every comparison.

    Attributes:
        motion: "sin" or "squat".
        shape: The true pendulum.
        noise: Of its sensors.
        lost_bar: 1 or 2 where that bar's markers are lost, 0 where none are.
        lost_s: The gaps, each from when to when; by default 300 ms at full speed.
    """

    motion: str = "sin"
    shape: PendulumShape = field(default_factory=PendulumShape)
    noise: PendulumNoise = field(default_factory=PendulumNoise)
    lost_bar: int = 0
    lost_s: tuple[tuple[float, float], ...] = ((0.85, 1.15),)

    def trial(self, seed: int) -> Trial:
        """The trial of a seed, always the same one."""
        return _made(self, seed)


@lru_cache(maxsize=4096)
def _made(recipe: Recipe, seed: int) -> Trial:
    motion = _motion(recipe.motion, recipe.shape)
    read = readings(motion, recipe.noise, np.random.default_rng(seed))
    hidden = np.zeros(len(motion.times_s), dtype=bool)
    if recipe.lost_bar:
        t = motion.times_s + 1e-9
        hidden = np.any([(t > first) & (t < last) for first, last in recipe.lost_s], axis=0)
        seen, bar = read.markers_m.copy(), recipe.lost_bar - 1
        seen[hidden, 4 * bar : 4 * bar + 4] = np.nan
        read = PendulumReadings(seen, read.efforts)
    return Trial(motion, read, hidden)


@lru_cache(maxsize=8)
def _motion(name: str, shape: PendulumShape) -> PendulumMotion:
    """The same truth for all seeds."""
    return pendulum_motion(name, shape)


@dataclass(frozen=True)
class Estimate:
    """What a filter makes of a trial.

    Attributes:
        q, v: (T, 4) z and ż.
        efforts: (T, 4) T_e.
        nis: (T,) normalised innovation squared, NaN where the filter gives none.
    """

    q: Array
    v: Array
    efforts: Array
    nis: Array


class Method(Protocol):
    """A filter with its settings; picklable, so that it can be sent to a worker."""

    def run(self, trial: Trial) -> Estimate:
        """Follows a trial from the truth of its first frame."""


@dataclass(frozen=True)
class Scores:
    """Errors of one estimate, or of many with one entry per seed.

    Attributes:
        position, velocity: RMS over the four components of z and ż and all frames, m and rad mixed as in the thesis.
        torque: RMS of τ_1, N m.
        delay_ms, torque_delay_ms: By how much the angular velocities, and τ_1, lag behind the truth.
        gap_angle: RMS error of the lost bar's angle while it is lost, rad; NaN where none is.
        torque_after: RMS error of τ_1 in the time after it, N m.
    """

    position: Array
    velocity: Array
    torque: Array
    delay_ms: Array
    torque_delay_ms: Array
    gap_angle: Array
    torque_after: Array

    @classmethod
    def joined(cls, parts: list[Scores]) -> Scores:
        """Scores of many seeds one after the other."""
        names = [item.name for item in fields(cls)]
        return cls(*(np.concatenate([np.atleast_1d(getattr(one, name)) for one in parts]) for name in names))


def score(trial: Trial, found: Estimate, lost_bar: int = 0) -> Scores:
    """Errors of an estimate against the truth; infinite for a filter that diverged.

    Args:
        trial: The trial with its truth.
        found: The estimate.
        lost_bar: Bar whose markers are lost, 0 for none.
    """
    truth, bar = trial.motion, 1 + max(lost_bar, 1)
    angle = found.q[:, bar] - truth.q[:, bar]
    torque = found.efforts[:, 0] - truth.efforts[:, 0]
    gap = trial.hidden
    after = np.zeros_like(gap)
    for end in np.flatnonzero(gap[:-1] & ~gap[1:]) + 1:
        after[end : end + round(AFTER_GAP_S / trial.dt_s)] = True
    return Scores(
        rms(found.q - truth.q),
        rms(found.v - truth.v),
        rms(torque),
        np.asarray(1e3 * delay(truth.times_s, truth.v[:, 2:], found.v[:, 2:])),
        np.asarray(1e3 * delay(truth.times_s, truth.efforts[:, :1], found.efforts[:, :1])),
        rms(angle[gap]),
        rms(torque[after]),
    )


def rms(error: Array) -> Array:
    """() root mean square; NaN of nothing, infinite where an error is no number."""
    if not error.size:
        return np.asarray(np.nan)
    if not np.isfinite(error).all():
        return np.asarray(np.inf)
    return np.asarray(np.sqrt(np.mean(error**2)))
