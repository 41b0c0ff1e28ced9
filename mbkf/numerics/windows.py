"""Sliding windows over evenly spaced samples: lines and curvature, majority and dilation of yes-or-no sequences.

They agree with ``savgol_filter``, ``median_filter`` and ``binary_dilation`` of SciPy, whose packages take long to load.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from mbkf.conventions import Array, BoolArray

_LEAST_SPREAD = 0.2
"""Samples nearer together than this share of a window (standard deviation) say nothing of a slope."""


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

    def sums(series: Array, power: int) -> Array:
        return np.convolve(series, kernels[power])[half : half + len(series)]

    count, first, second = (sums(known.astype(float), power) for power in range(3))
    with np.errstate(invalid="ignore", divide="ignore"):
        middle = first / count
        variance = second / count - middle**2
    spread, around = variance > (_LEAST_SPREAD * width) ** 2, count > 0.0
    values, slopes = np.full(samples.shape, np.nan), np.full(samples.shape, np.nan)
    for series, value, slope in zip(samples.T, values.T, slopes.T, strict=True):
        shown = np.where(known, series, 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = sums(shown, 0) / count
            fitted = np.where(spread, (sums(shown, 1) / count - middle * mean) / variance, 0.0)
        slope[around] = fitted[around]
        value[around] = (mean - fitted * middle)[around]
    return values, slopes
