"""Position from one inertial sensor by stable windows, gravity carried between them, and two integrations.

The algorithm of the stride-length study (docs/references.md, key ``stride``; here: the study), after Hemminki, Nurmi
and Tarkoma, *Gravity and linear acceleration estimation on mobile devices*, MobiQuitous 2014. Readings are cut into
windows of 10 samples at 50 Hz, and every window becomes one sample: the mean of its readings. Per window

    S = α_σ σ_a + α_μ Δμ_a + α_ω μ_ω                                                               (stride eq. 1)

with the spread σ_a of the specific force, the change Δμ_a of its mean since the window before, and the mean angular
velocity μ_ω, each as the length of its three axes. Where S < E_s the foot rests and the window is a key point:
gravity is the mean specific force and the velocity zero. Between two key points gravity is turned by the gyroscope from
either side and blended (stride eqs. 2–4). The readings are then turned level by gravity's direction, gravity is taken
off (stride eq. 5) and the rest is integrated twice (stride eq. 6).

The test of S departs from stride key points in prose, where S is to exceed E_s, and is that of the pseudocode. Three
choices differ by default; :func:`as_printed` gives the printed ones. The velocity is zero at key points, which departs
from stride eq. 6. The gyroscope's bias is its mean over the first rest, which departs from stride real signals, whose
first second may be in rest or not. The constant c, which the study leaves to its source, is half of the gap between two
key points, since for every other value the weight jumps at c: this departs from stride eq. 4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.frames import attitude, exponential, rotate
from mbkf.numerics.runs import runs

USUAL_WEIGHTS, NOISY_WEIGHTS = (0.1, 0.45, 0.45), (0.2, 0.4, 0.4)
"""α_σ, α_μ (s²/m) and α_ω (s/rad) as the study has them: in general, and for noise and drift together."""

BIAS_FROM = ("rest", "start")
"""Readings whose mean angular velocity is the gyroscope's bias: those of the first rest, or the first ones."""

_LOW_PASS_ORDER = 4

StabilityMeasure = Callable[[Array, Array, tuple[float, float, float]], Array]
"""Stability of windows: (K, N, 3) specific force, (K, N, 3) angular velocity and the three weights give (K,)."""


@dataclass(frozen=True)
class KeyPointSettings:
    """The study's numbers, and our choices where :func:`as_printed` has others.

    Attributes:
        rate_hz: Rate the readings are brought to.
        window: Samples per window.
        first: Sample at which the first window begins: the result depends much on where the windows fall.
        weights: α_σ, α_μ, α_ω.
        threshold: E_s.
        low_pass_hz: Corner of the accelerometer's low pass (Butterworth, no delay); None: no low pass.
        still_s: The mean angular velocity of the first rest, at most this long, is the gyroscope's bias; 0 leaves it.
        bias_from: "rest", or "start": the bias is the mean over the first ``still_s`` of the readings, as printed.
        zero_velocity: The velocity is zero at key points; False: stride eq. 6 as printed, which integrates over them.
        backwards: Gravity is carried from the key point after as well (stride eq. 3); False: from the one before alone.
        middle: Constant c of stride eq. 4 as a share of the gap between two key points.
        loss: α of stride eq. 2, the share of gravity lost per step from a key point; the study sets it by trial.
        by_sample: Carry gravity and integrate sample by sample between key windows, not window by window (ours).
    """

    rate_hz: float = 50.0
    window: int = 10
    first: int = 0
    weights: tuple[float, float, float] = USUAL_WEIGHTS
    threshold: float = 1.0
    low_pass_hz: float | None = 15.0
    still_s: float = 1.0
    bias_from: Literal["rest", "start"] = "rest"
    zero_velocity: bool = True
    backwards: bool = True
    middle: float = 0.5
    loss: float = 0.0
    by_sample: bool = False

    def __post_init__(self) -> None:
        if self.window < 2 or self.first < 0:
            raise InvalidInput(
                f"a window needs 2 samples or more and begins at 0 or later, got {self.window} from {self.first}"
            )
        if not (
            self.rate_hz > 0.0 and self.threshold > 0.0 and self.still_s >= 0.0 and 0.0 <= self.loss < 1.0
        ):
            raise InvalidInput("rate and threshold must be positive, the loss at least 0 and below 1")
        if self.bias_from not in BIAS_FROM:
            raise UnknownName("source of the gyroscope's bias", self.bias_from, BIAS_FROM)
        if not 0.0 < self.middle < 1.0:
            raise InvalidInput(
                f"the constant c must lie inside the gap, between 0 and 1, got {self.middle:g}"
            )
        if self.low_pass_hz is not None and not 0.0 < self.low_pass_hz < 0.5 * self.rate_hz:
            raise InvalidInput(
                f"the low pass must lie between 0 and half of {self.rate_hz:g} Hz, got {self.low_pass_hz:g} Hz"
            )


def as_printed(weights: tuple[float, float, float] = NOISY_WEIGHTS) -> KeyPointSettings:
    """The study's numbers and equations as printed: its first second for the bias, stride eq. 6 for the position.

    Args:
        weights: α_σ, α_μ, α_ω; the study takes :data:`NOISY_WEIGHTS` for real readings.
    """
    return KeyPointSettings(weights=weights, bias_from="start", zero_velocity=False)


@dataclass(frozen=True)
class KeyPointPath:
    """Path of the sensor at K windows, or as many samples as they hold where it goes sample by sample.

    Attributes:
        time_s: (K,) middle of each window, or the time of each sample.
        position_m, velocity_m_s: (K, 3) level axes of the first key point, z up.
        still: (K,) key points.
        stability: (number of windows,) S.
    """

    time_s: Array
    position_m: Array
    velocity_m_s: Array
    still: BoolArray
    stability: Array


def follow_key_points(
    specific_force_mps2: Array,
    angular_velocity_rad_s: Array,
    rate_hz: float,
    settings: KeyPointSettings,
    *,
    start_s: float = 0.0,
    measure: StabilityMeasure | None = None,
) -> KeyPointPath:
    """Runs the algorithm.

    Args:
        specific_force_mps2: (T, 3) sensor axes, without gaps.
        angular_velocity_rad_s: (T, 3) sensor axes, without gaps.
        rate_hz: Sample rate; other rates than the settings' are brought to it.
        settings: Windows and weights.
        start_s: Time of the first sample.
        measure: Stability of windows, small where the foot rests; :func:`stability` when None.

    Raises:
        InvalidInput: Key points are missing, or every window is incomplete.
    """
    f, w = prepared(specific_force_mps2, angular_velocity_rad_s, rate_hz, settings)
    N = settings.window
    K = (len(f) - settings.first) // N
    if K < 2:
        raise InvalidInput(f"{len(f)} samples at {settings.rate_hz:g} Hz hold less than two windows of {N}")
    f, w = (x[settings.first : settings.first + K * N] for x in (f, w))
    windows = f.reshape(K, N, 3)
    unsteadiness = (measure or stability)(windows, w.reshape(K, N, 3), settings.weights)
    key = unsteadiness < settings.threshold
    if not key.any():
        raise InvalidInput(
            f"no window is stable (least S is {unsteadiness.min():.2f}, bound {settings.threshold:g}); "
            "check rate and units"
        )
    w = w - _bias(w, np.repeat(key, N), settings)
    step = 1.0 / settings.rate_hz
    time: Array = start_s + step * np.arange(settings.first, settings.first + K * N, dtype=float)
    means = windows.mean(axis=1)
    gravity = np.where(key[:, None], means, np.nan)
    if settings.by_sample:
        key, gravity = np.repeat(key, N), np.repeat(gravity, N, axis=0)
    else:
        f, w = means, w.reshape(K, N, 3).mean(axis=1)
        time, step = time.reshape(K, N).mean(axis=1), N * step
    gravity = _between_key_points(gravity, key, step * w, settings)
    linear = rotate(attitude(gravity), f - gravity)
    velocity, position = _integrated(linear, key & settings.zero_velocity, step)
    return KeyPointPath(time, position, velocity, key, unsteadiness)


def prepared(f: Array, w: Array, rate_hz: float, settings: KeyPointSettings) -> tuple[Array, Array]:
    """Both readings at the settings' rate, the specific force low-passed.

    Args:
        f: (T, 3) specific force, m/s².
        w: (T, 3) angular velocity, rad/s.
        rate_hz: Their sample rate.
        settings: Wanted rate and low pass.

    Raises:
        InvalidInput: The readings are slower than the low pass needs, or too few for it.
    """
    if settings.low_pass_hz is not None:
        f = _low_passed(f, settings.low_pass_hz, rate_hz)
    if abs(rate_hz - settings.rate_hz) > 1e-6 * settings.rate_hz:
        if rate_hz > settings.rate_hz:
            w = _low_passed(w, 0.4 * settings.rate_hz, rate_hz)
        old = np.arange(len(f)) / rate_hz
        new = np.arange(int(old[-1] * settings.rate_hz) + 1) / settings.rate_hz
        f, w = (np.stack([np.interp(new, old, axis) for axis in x.T], axis=1) for x in (f, w))
    return f, w


def stability(force_windows: Array, rate_windows: Array, weights: tuple[float, float, float]) -> Array:
    """(K,) stability S of windows (stride eq. 1); small is stable.

    Args:
        force_windows: (K, N, 3) specific force, m/s².
        rate_windows: (K, N, 3) angular velocity, rad/s.
        weights: α_σ, α_μ and α_ω.
    """
    spread = np.linalg.norm(force_windows.std(axis=1), axis=1)
    change = np.linalg.norm(np.diff(force_windows.mean(axis=1), axis=0), axis=1)
    turning = np.linalg.norm(rate_windows.mean(axis=1), axis=1)
    sigma, mu, omega = weights
    total: Array = sigma * spread + mu * np.concatenate([[0.0], change]) + omega * turning
    return total


def blend_weight(x: Array, middle: float = 0.5) -> Array:
    """Weight W of the gravity carried backwards (stride eq. 4), at x from 0 (key point before) to 1 (after).

    2x² before ``middle`` (the constant c) and 1 − 2(1 − x)² after it: each side weighs most near its own key point.
    """
    return np.where(x < middle, 2.0 * x**2, 1.0 - 2.0 * (1.0 - x) ** 2)


def _low_passed(x: Array, corner_hz: float, rate_hz: float) -> Array:
    from scipy.signal import butter, sosfiltfilt

    least = 4 * _LOW_PASS_ORDER
    if corner_hz >= 0.5 * rate_hz or len(x) < least:
        raise InvalidInput(
            f"a low pass at {corner_hz:g} Hz needs more than {2 * corner_hz:g} Hz and {least} samples, "
            f"got {len(x)} at {rate_hz:g} Hz"
        )
    passed: Array = sosfiltfilt(butter(_LOW_PASS_ORDER, corner_hz, fs=rate_hz, output="sos"), x, axis=0)
    return passed


def _bias(w: Array, key: BoolArray, settings: KeyPointSettings) -> Array:
    """(3,) mean angular velocity (T, 3) of the first rest, or of the first readings."""
    if settings.still_s == 0.0:
        return np.zeros(3)
    start, stop = runs(key)[0] if settings.bias_from == "rest" else (0, len(w))
    size = max(1, round(settings.still_s * settings.rate_hz))
    mean: Array = w[start : min(stop, start + size)].mean(axis=0)
    return mean


def _between_key_points(gravity: Array, key: BoolArray, angle: Array, settings: KeyPointSettings) -> Array:
    """(K, 3) gravity in the sensor's axes everywhere, from that at key points (stride eqs. 2–4).

    Args:
        gravity: (K, 3) at key points.
        key: (K,) key points.
        angle: (K, 3) rotation of the sensor during each step, rad.
        settings: Loss α and constant c.
    """
    found, loss = gravity.copy(), settings.loss
    # A vector fixed in the world turns against the sensor; a step reaches from middle to middle of two windows.
    halfway = exponential(-0.5 * (angle[1:] + angle[:-1]))
    back = halfway * np.array([-1.0, -1.0, -1.0, 1.0])
    for start, stop in runs(~key):
        forwards, backwards = found.copy(), found.copy()
        if start > 0:
            for k in range(start, stop):
                forwards[k] = (1.0 - loss) * rotate(halfway[k - 1], forwards[k - 1])
        if stop < len(key):
            for k in range(stop - 1, start - 1, -1):
                backwards[k] = (1.0 - loss) * rotate(back[k], backwards[k + 1])
        inside = slice(start, stop)
        if start == 0 or stop == len(key) or not settings.backwards:
            found[inside] = (backwards if start == 0 else forwards)[inside]
            continue
        W = blend_weight(np.arange(1, stop - start + 1) / (stop - start + 1), settings.middle)[:, None]
        found[inside] = (1.0 - W) * forwards[inside] + W * backwards[inside]
    return found


def _integrated(acceleration: Array, held: BoolArray, step_s: float) -> tuple[Array, Array]:
    """Velocity (K, 3), zero where held, and position (K, 3) by the trapezoidal rule (stride eq. 6)."""
    velocity = np.zeros_like(acceleration)
    for k in range(1, len(held)):
        if not held[k]:
            velocity[k] = velocity[k - 1] + 0.5 * step_s * (acceleration[k - 1] + acceleration[k])
    position = np.zeros_like(velocity)
    position[1:] = np.cumsum(0.5 * step_s * (velocity[1:] + velocity[:-1]), axis=0)
    return velocity, position
