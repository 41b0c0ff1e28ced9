"""Plate readings brought to the frames of the markers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.io.records import PlateReadings

WHOLE = 1e-6
"""Times this close to a sample, in samples, are that sample's: frames' times are only known to rounding."""


@dataclass(frozen=True)
class FrameLoads:
    """Mean reading of one plate per marker frame.

    Attributes:
        force_n: (T, 3) mean force on the body in N, world axes; NaN where the plate was not recorded.
        moment_nm: (T, 3) mean moment about the plate's origin in N m.
    """

    force_n: Array
    moment_nm: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "force_n", read_only(self.force_n))
        object.__setattr__(self, "moment_nm", read_only(self.moment_nm))


def average_over_frames(plate: PlateReadings, frame_times_s: Array, rate_hz: float) -> FrameLoads:
    """Mean force and moment over each frame, from half a frame before its time to half a frame after.

    The readings are joined by straight lines, f(t), and the mean is ∫ f dt / Δt over the part of the window
    inside the recording, so that rates need not divide each other and no half sample of delay arises.

    Args:
        plate: Readings at any rate.
        frame_times_s: (T,) times of the frames in s.
        rate_hz: Frame rate in Hz.

    Returns:
        Mean readings; NaN for frames more than half a sample outside the recording.
    """
    times = np.asarray(frame_times_s, dtype=np.float64)
    samples = np.hstack([plate.force_n, plate.moment_nm])
    if not len(samples):
        empty = np.full((len(times), 3), np.nan)
        return FrameLoads(empty, empty)
    last = len(samples) - 1
    position = (times - plate.start_time_s) * plate.rate_hz  # in samples
    half = 0.5 * plate.rate_hz / rate_hz
    low, high = (np.clip(end, 0.0, last) for end in window_ends(position, half))
    width = (high - low)[:, None]
    area = integrals_between(samples, low, high, 2.0 * half)
    single = samples[np.clip(np.round(position), 0, last).astype(int)]
    means = np.where(width > 1e-9, area / np.maximum(width, 1e-9), single)
    inside = (position >= -0.5) & (position <= last + 0.5)
    means = np.where(inside[:, None], means, np.nan)
    return FrameLoads(means[:, :3], means[:, 3:])


def window_ends(position: Array | float, half: float) -> tuple[Array, Array]:
    """Begin and end of the windows around positions (T,), or one, in samples; rounded to a sample very near.

    Else a live stream would wait for a sample that counts for nothing, or get other numbers without it.
    """
    ends = np.array([position - half, position + half])
    whole = np.rint(ends)
    low, high = np.where(np.abs(ends - whole) < WHOLE, whole, ends)
    return low, high


def window_of(position: float, half: float) -> tuple[float, float]:
    """:func:`window_ends` of a single window: a stream asks for one with each frame."""
    low, high = (
        float(whole) if abs(end - (whole := round(end))) < WHOLE else end
        for end in (position - half, position + half)
    )
    return low, high


def integrals_between(samples: Array, low: Array, high: Array, span: float) -> Array:
    """(T, n) integrals, per sample interval, of samples joined by straight lines: Σ f_k ∫ h(x − k) dx with hats h.

    Only samples inside a window count, and always in the same order, so that a live stream that keeps few of them
    finds the very same numbers as a whole trial does.

    Args:
        samples: (S, n) readings.
        low: (T,) begin of the windows, in samples.
        high: (T,) their end.
        span: Length of the longest window.
    """
    places = np.floor(low).astype(int) + np.arange(int(np.ceil(span)) + 2)[:, None]
    weights = _hat_until(high - places) - _hat_until(low - places)
    total = np.zeros((len(low), samples.shape[1]))
    for k, weight in zip(places, weights, strict=True):
        counted = weight > 0.0
        if counted.all():  # all but the outermost samples of a window
            total += weight[:, None] * samples.take(k, axis=0)
        else:
            total[counted] += weight[counted, None] * samples[k[counted]]
    return total


@lru_cache(maxsize=256)
def window_weights(low: float, high: float) -> Array:
    """(n, 1) weights of the first n samples in the integral of one window that begins before sample 1.

    The weighted sum of the samples, row after row, is the number of :func:`integrals_between`. Windows of a stream's
    frames recur, so weights are kept.
    """
    places = np.arange(int(np.ceil(high)) + 1.0)
    return np.asarray(_hat_until(high - places) - _hat_until(low - places))[:, None]


def _hat_until(x: Array) -> Array:
    """Integral from −1 to x of the hat 1 − |x|."""
    x = np.minimum(np.maximum(x, -1.0), 1.0)
    return np.where(x < 0.0, 0.5 * (1.0 + x) ** 2, 1.0 - 0.5 * (1.0 - x) ** 2)
