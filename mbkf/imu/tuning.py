"""Gains of Madgwick's filter: from the noise of a sensor that lies still, or by search against a reference.

Departs from Madgwick eqs. 46 and 48, whose root covers the product, so that units do not agree. Departs from Madgwick
eqs. 45 and 47 as well: σ_ω is that about the slow drift, and σ_ω̇ the slope of a line through all samples.

Madgwick's β = √(3/4) σ_ω and ζ = √(3/4) σ_ω̇ count the gyroscope's errors at rest only. On moving sensors they are far
too small, since scale and alignment errors grow with the motion; the search measures by how much.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.imu.frames import FRAMES, change_frame
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import Orientation, OrientSettings, orientations
from mbkf.imu.orientation_error import OrientationError, orientation_error
from mbkf.io.imu.readings import ImuReadings

BETA_RANGE = (1e-3, 1.0)
ZETAS = (0.0, 3e-4, 1e-3, 3e-3, 1e-2)
"""Gains that the search tries."""

LEAST_STILL_S = 2.0
_BLOCK_S = 0.5
_STILL_RATE_SD = 0.02
_STILL_FORCE_SD = 0.15
_ROOT = float(np.sqrt(3.0 / 4.0))


@dataclass(frozen=True)
class StaticGains:
    """Gains from a sensor at rest.

    Attributes:
        beta, zeta: Gains by Madgwick's formulas.
        gyro_noise_rad_s: σ_ω, standard deviation of a sample about its slow drift, root mean square over axes.
        gyro_drift_rad_s2: σ_ω̇, slope of the mean reading, root mean square over axes.
        gyro_bias_rad_s: (3,) mean reading.
        from_s, to_s: The stretch.
    """

    beta: float
    zeta: float
    gyro_noise_rad_s: float
    gyro_drift_rad_s2: float
    gyro_bias_rad_s: Array
    from_s: float
    to_s: float


@dataclass(frozen=True)
class SearchedGains:
    """The best gains found, their error, and every trial (beta, zeta, total error in rad)."""

    settings: MadgwickSettings
    error: OrientationError
    trials: tuple[tuple[float, float, float], ...]


def still_stretch(one: ImuReadings) -> tuple[int, int]:
    """First and last sample + 1 of the longest time in which the sensor lies still.

    Raises:
        InvalidInput: It never does for two seconds.
    """
    block = max(2, round(_BLOCK_S * one.rate_hz))
    count = one.samples // block
    rates = one.angular_velocity_rad_s[: count * block].reshape(count, block, 3)
    force = one.specific_force_mps2[: count * block].reshape(count, block, 3)
    usual = np.nanmin(np.nanmedian(np.abs(rates.mean(axis=1)), axis=0)) if count else 0.0
    with np.errstate(invalid="ignore"):
        still = (rates.std(axis=1) < _STILL_RATE_SD).all(axis=1) & (force.std(axis=1) < _STILL_FORCE_SD).all(
            axis=1
        )
        still &= (np.abs(rates.mean(axis=1)) < usual + 0.1).all(axis=1)
    best, start = (0, 0), None
    for k, calm in enumerate([*still.tolist(), False]):
        if calm and start is None:
            start = k
        elif not calm and start is not None:
            best = max(best, (start, k), key=lambda run: run[1] - run[0])
            start = None
    if (best[1] - best[0]) * block < LEAST_STILL_S * one.rate_hz:
        raise InvalidInput(
            f"sensor {one.name}: it never lies still for {LEAST_STILL_S:g} s; record it on a table, or use --search"
        )
    return best[0] * block, best[1] * block


def static_gains(one: ImuReadings, first: int, last: int) -> StaticGains:
    """Gains from samples ``first`` to ``last`` of a sensor that lies still (Madgwick 2010, eqs. 50 and 51).

    Args:
        one: The sensor.
        first: First sample at rest.
        last: The sample after the last one at rest.

    Raises:
        InvalidInput: The stretch is too short.
    """
    rates = one.angular_velocity_rad_s[first:last]
    rates = rates[np.isfinite(rates).all(axis=1)]
    if len(rates) < 20:
        raise InvalidInput(
            f"sensor {one.name}: {len(rates)} samples at rest are too few; record some seconds"
        )
    time = np.arange(len(rates)) / one.rate_hz
    slope, level = np.polyfit(time, rates, 1)
    noise = float(np.sqrt(((rates - time[:, None] * slope - level) ** 2).mean()))
    drift = float(np.sqrt((slope**2).mean()))
    times = one.time_s
    return StaticGains(
        _ROOT * noise,
        _ROOT * drift,
        noise,
        drift,
        rates.mean(axis=0),
        float(times[first]),
        float(times[last - 1]),
    )


@dataclass(frozen=True)
class GainComparison:
    """A sensor and the reference that its courses with different gains are compared with.

    Attributes:
        one: Sensor.
        reference: (T, 4) orientations, NaN where unknown.
        frame: Its world: ENU, NED or NWU.
        counted: (T,) samples that count.
        magnetometer: Whether the field is used; without it headings are compared after one common turn.
        start: (4,) orientation at the first sample in ``frame``; by default that of a sensor at rest.
    """

    one: ImuReadings
    reference: Array
    frame: str
    counted: BoolArray | None = None
    magnetometer: bool = True
    start: Array | None = None

    def course(self, gains: MadgwickSettings) -> Orientation:
        """The sensor's course with these gains."""
        settings = OrientSettings("madgwick", self.magnetometer, gains)
        start = None if self.start is None else self.start[None]
        (course,) = orientations([self.one], frame=self.frame, settings=settings, start=start)
        return course

    def error(self, gains: MadgwickSettings) -> OrientationError:
        """Error of that course.

        Raises:
            InvalidInput: Nothing to compare with.
        """
        q = self.course(gains).quaternion
        error = orientation_error(
            q if self.magnetometer else _turned(q, self.reference), self.reference, self.counted
        )
        if not error.samples:
            raise InvalidInput(f"sensor {self.one.name}: the reference has no sample to compare with")
        return error


def searched_gains(
    comparison: GainComparison, progress: Callable[[int, int], None] | None = None
) -> SearchedGains:
    """β (by Brent's method on its logarithm), then ζ, of least total error against a reference.

    Args:
        comparison: Sensor and reference.
        progress: Called with runs done and expected.

    Raises:
        InvalidInput: Nothing to compare with.
    """
    from scipy.optimize import minimize_scalar

    runs = _Runs(comparison, progress, 20 + len(ZETAS))
    low, high = np.log(BETA_RANGE)
    grid = np.exp(np.linspace(low, high, 8))
    best = int(np.argmin([runs.error(float(beta), 0.0) for beta in grid]))
    step = (high - low) / 7.0
    bounds = (max(low, np.log(grid[best]) - step), min(high, np.log(grid[best]) + step))
    minimize_scalar(
        lambda x: runs.error(float(np.exp(x)), 0.0), bounds=bounds, method="bounded", options={"maxiter": 12}
    )
    beta = runs.best()[0]
    for zeta in ZETAS[1:]:
        runs.error(beta, zeta)
    return runs.found()


def swept_gains(
    comparison: GainComparison,
    betas: Sequence[float],
    zetas: Sequence[float],
    progress: Callable[[int, int], None] | None = None,
) -> SearchedGains:
    """The gains of least total error among all pairs of given ones, as the source swept them.

    Args:
        comparison: Sensor and reference.
        betas: Gains β.
        zetas: Gains ζ.
        progress: Called with runs done and expected.

    Raises:
        InvalidInput: Nothing to compare with, no gains, or a negative one.
    """
    if not len(betas) or not len(zetas):
        raise InvalidInput("a sweep needs one beta and one zeta at least")
    runs = _Runs(comparison, progress, len(betas) * len(zetas))
    for beta in betas:
        for zeta in zetas:
            runs.error(float(beta), float(zeta))
    return runs.found()


@dataclass
class _Runs:
    """Runs of the filter with different gains."""

    comparison: GainComparison
    progress: Callable[[int, int], None] | None
    expected: int
    trials: dict[tuple[float, float], OrientationError] = field(default_factory=dict)

    def error(self, beta: float, zeta: float) -> float:
        """Total error with these gains, rad."""
        error = self.comparison.error(MadgwickSettings(beta, zeta))
        self.trials[beta, zeta] = error
        if self.progress is not None:
            self.progress(min(len(self.trials), self.expected), self.expected)
        return error.total

    def best(self) -> tuple[float, float]:
        """The gains of least error."""
        return min(self.trials, key=lambda gains: self.trials[gains].total)

    def found(self) -> SearchedGains:
        """The best gains and all that were tried."""
        best = self.best()
        trials = tuple((*gains, error.total) for gains, error in self.trials.items())
        return SearchedGains(MadgwickSettings(*best), self.trials[best], trials)


def _turned(q: Array, reference: Array) -> Array:
    """The estimate turned about the vertical so that it starts with the reference's heading."""
    from mbkf.imu.frames import conjugate, multiply

    there = np.flatnonzero(np.isfinite(q).all(axis=1) & np.isfinite(reference).all(axis=1))
    if not len(there):
        return q
    off = multiply(reference[there[0]], conjugate(q[there[0]]))
    turn = np.array([0.0, 0.0, off[2], off[3]])
    return multiply(turn / np.sqrt((turn * turn).sum()), q)


def reference_of(one: ImuReadings, frame: str) -> Array:
    """(T, 4) the orientation a file brings, in ``frame``.

    Raises:
        InvalidInput: The file has no reference orientations, or not in a known world.
    """
    if one.orientation is None:
        raise InvalidInput(f"sensor {one.name}: the file brings no orientation; use --against smooth")
    known = [name for name in FRAMES if name in one.frame]
    if len(known) != 1:
        raise InvalidInput(
            f"sensor {one.name}: the world of the file's orientation is not known ({one.frame})"
        )
    return change_frame(one.orientation, known[0], frame)
