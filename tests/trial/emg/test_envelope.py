"""The envelope: scipy's filters by hand, and the mean of a rectified sine."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from mbkf.trial.emg.envelope import band_passed, envelope, upper_hz
from mbkf.trial.emg.settings import EmgSettings

SETTINGS = EmgSettings()


def test_the_envelope_is_that_of_scipy_by_hand():
    x = np.random.default_rng(1).standard_normal(3000) + 2.0
    band = butter(2, [20.0, 450.0], "bandpass", fs=1500.0, output="sos")
    low = butter(2, 6.0, "lowpass", fs=1500.0, output="sos")
    by_hand = sosfiltfilt(low, np.abs(sosfiltfilt(band, x - x.mean())))
    np.testing.assert_allclose(envelope(x, 1500.0, SETTINGS), by_hand, atol=1e-12)


def test_a_sine_has_the_envelope_of_its_rectified_mean_whatever_its_offset():
    t = np.arange(4000) / 2000.0
    found = envelope(3.0 + 5.0 * np.sin(2.0 * np.pi * 97.3 * t), 2000.0, SETTINGS)
    assert found[1500:2500].mean() == pytest.approx(10.0 / np.pi, rel=1e-3)


def test_the_band_passes_its_middle_and_stops_below_without_a_lag():
    t = np.arange(4000) / 2000.0
    inside, below = np.sin(2.0 * np.pi * 100.0 * t), np.sin(2.0 * np.pi * 2.0 * t)
    found = band_passed(inside + below, 2000.0, 20.0, 450.0, 4)
    np.testing.assert_allclose(found[1000:3000], inside[1000:3000], atol=0.01)


def test_the_band_ends_below_half_the_rate():
    assert upper_hz(2000.0, SETTINGS) == 450.0 and upper_hz(600.0, SETTINGS) == pytest.approx(270.0)
