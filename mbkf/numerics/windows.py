"""Sliding windows over evenly spaced samples: lines and curvature, majority and dilation of yes-or-no sequences.

They agree with ``savgol_filter``, ``median_filter`` and ``binary_dilation`` of SciPy, whose packages take long to load.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from mbkf.conventions import Array, BoolArray

_LEAST_SPREAD = 0.2
"""Samples nearer together than this share of a window (standard deviation) say nothing of a slope."""

_BLOCK = 20_000
"""Samples whose lines are fitted together, so that memory does not grow with the series."""


def second_derivative(samples: Array, window: int, dt: float) -> Array:
    """Second derivative of the parabola that fits the samples around each one best (Savitzky and Golay 1964).

    Near either end, where no whole window surrounds a sample, it is that of the outermost window.

    Args:
        samples: (T,) values, at least one window of them.
        window: Samples in a window, odd and at least three.
        dt: Time between samples.

    Returns:
        (T,) second derivative.
    """
    half = window // 2
    squares = np.arange(-half, half + 1) ** 2.0
    centred = squares - squares.mean()
    weights = 2.0 * centred / (centred @ centred) / dt**2
    return np.pad(np.correlate(samples, weights, "valid"), half, mode="edge")


def slopes(samples: Array, window: int, dt: float) -> Array:
    """First derivative of the parabolas that fit the samples around each one best (Savitzky and Golay 1964).

    Near either end, where no whole window surrounds a sample, it is that of the outermost window.

    Args:
        samples: (T, k) values, at least one window of them.
        window: Samples in a window, odd and at least three.
        dt: Time between samples.

    Returns:
        (T, k) first derivative.
    """
    half = window // 2
    steps = np.arange(-half, half + 1)
    weights = steps / (steps @ steps) / dt
    columns = [np.correlate(column, weights, "valid") for column in samples.T]
    return np.pad(np.array(columns).T, ((half, half), (0, 0)), mode="edge")


def majority(votes: BoolArray, window: int) -> BoolArray:
    """True where most samples around are true: the running median of a yes-or-no sequence.

    Args:
        votes: (T,) sequence, not empty; its ends are continued by their outermost samples.
        window: Samples in a window, odd.

    Returns:
        (T,) majority of each window.
    """
    around = sliding_window_view(np.pad(votes, window // 2, mode="edge"), window)
    return np.asarray(2 * around.sum(axis=1) > window)


def dilated(mask: BoolArray, samples: int) -> BoolArray:
    """(T,) whether a mask (T,) is true anywhere within so many samples."""
    counts = np.cumsum(np.pad(mask, (samples + 1, samples)))
    return np.asarray(counts[2 * samples + 1 :] > counts[: len(mask)])


def bridged(mask: BoolArray, samples: int) -> BoolArray:
    """(T,) a mask (T,) across whose gaps of up to twice so many samples runs of True go on."""
    return ~dilated(~dilated(mask, samples), samples)


def local_lines(samples: Array, known: BoolArray, dt: float, width: float) -> tuple[Array, Array]:
    """Value and slope at each sample of the straight line that fits the known ones around it best.

    The weights are Gaussian, so that what swings faster than the window is wide goes out of both. Where no other known
    sample is near, the slope is 0 and the value the mean.

    Args:
        samples: (T, C) values of C series.
        known: (T,) which of them to use.
        dt: Time between samples.
        width: Standard deviation of the weights, in the same unit.

    Returns:
        (T, C) values and (T, C) slopes; NaN where no sample is known within three widths.
    """
    half = max(1, round(3.0 * width / dt))
    lag = np.arange(-half, half + 1) * dt
    kernels = [np.exp(-0.5 * (lag / width) ** 2) * (-lag) ** power for power in range(3)]
    values, slopes = np.empty(samples.shape), np.empty(samples.shape)
    for begin in range(0, len(samples), _BLOCK):
        own, first = slice(begin, begin + _BLOCK), max(0, begin - half)
        read, inner = slice(first, begin + _BLOCK + half), slice(begin - first, begin - first + _BLOCK)
        found = _lines(samples[read], known[read], kernels, (_LEAST_SPREAD * width) ** 2)
        values[own], slopes[own] = (one[inner] for one in found)
    return values, slopes


def _lines(
    samples: Array, known: BoolArray, kernels: list[Array], least_variance: float
) -> tuple[Array, Array]:
    """Values and slopes of all samples' lines.

    Args:
        samples: (T, C) values.
        known: (T,) which of them to use.
        kernels: Weights times powers 0, 1 and 2 of the lag.
        least_variance: Of the lags of known samples; below it a line has no slope.
    """
    half = len(kernels[0]) // 2

    def sums(series: Array, power: int) -> Array:
        return np.convolve(series, kernels[power])[half : half + len(series)]

    count, first, second = (sums(known.astype(float), power) for power in range(3))
    shown = np.where(known[:, None], samples, 0.0)
    total, moment = (np.column_stack([sums(series, power) for series in shown.T]) for power in range(2))
    with np.errstate(invalid="ignore", divide="ignore"):
        mean, middle = total / count[:, None], first / count
        variance = second / count - middle**2
        slope = (moment / count[:, None] - middle[:, None] * mean) / variance[:, None]
    slope = np.where((variance > least_variance)[:, None], slope, 0.0)
    value = mean - slope * middle[:, None]
    around = (count > 0.0)[:, None]
    return np.where(around, value, np.nan), np.where(around, slope, np.nan)
