"""The envelope of an electromyogram: offset removed, band-passed, rectified, low-passed, all without a lag."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.trial.emg.settings import EmgSettings

NYQUIST_SHARE = 0.45
"""Largest corner of a filter, as a share of the sample rate."""


def upper_hz(rate_hz: float, settings: EmgSettings) -> float:
    """Upper end of the band at a sample rate."""
    return min(settings.high_hz, NYQUIST_SHARE * rate_hz)


def band_passed(values: Array, rate_hz: float, low_hz: float, high_hz: float, order: int) -> Array:
    """(S,) a signal without its offset in a band: a Butterworth filter forwards and backwards.

    Args:
        values: (S,) samples.
        rate_hz: Sample rate.
        low_hz: Lower end of the band.
        high_hz: Upper end.
        order: Order of the band-pass, an even number.
    """
    from scipy.signal import butter, sosfiltfilt

    sections = butter(order // 2, [low_hz, high_hz], "bandpass", fs=rate_hz, output="sos")
    return np.asarray(sosfiltfilt(sections, values - values.mean()))


def envelope(values: Array, rate_hz: float, settings: EmgSettings) -> Array:
    """(S,) the linear envelope (D. A. Winter, Biomechanics and Motor Control of Human Movement, 2009, section 10.2.3).

    Args:
        values: (S,) samples.
        rate_hz: Sample rate.
        settings: Band and corner.
    """
    from scipy.signal import butter, sosfiltfilt

    inside = band_passed(values, rate_hz, settings.low_hz, upper_hz(rate_hz, settings), settings.order)
    sections = butter(settings.envelope_order, settings.envelope_hz, fs=rate_hz, output="sos")
    return np.asarray(sosfiltfilt(sections, np.abs(inside)))
