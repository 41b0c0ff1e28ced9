"""Sliding windows over evenly spaced samples: curvature of a curve, majority and dilation of yes-or-no sequences.

They agree with ``savgol_filter``, ``median_filter`` and ``binary_dilation`` of SciPy, whose packages take long to load.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from mbkf.conventions import Array, BoolArray


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


def majority(votes: BoolArray, window: int) -> BoolArray:
    """Whether most samples around each one are true: the running median of a yes-or-no sequence.

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
