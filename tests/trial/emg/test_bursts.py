"""Bursts: the thresholds' probabilities, known begins and ends, and noise alone."""

from math import comb, exp

import numpy as np
import pytest

from mbkf.trial.emg.bursts import bursts, noise_variance, threshold
from mbkf.trial.emg.settings import EmgSettings
from tests.trial.emg.trains import train

SETTINGS = EmgSettings()


@pytest.mark.parametrize(("pairs", "needed", "false_alarm"), [(5, 3, 1e-4), (5, 1, 0.05)])
def test_the_threshold_gives_the_false_alarms_that_are_set(pairs, needed, false_alarm):
    p = exp(-0.5 * threshold(EmgSettings(pairs=pairs, needed=needed, false_alarm=false_alarm)))
    found = sum(comb(pairs, k) * p**k * (1.0 - p) ** (pairs - k) for k in range(needed, pairs + 1))
    assert found == pytest.approx(false_alarm, rel=1e-6)


@pytest.mark.parametrize("rate_hz", [1000.0, 1500.0, 2000.0])
def test_bursts_of_a_train_are_found_within_ten_milliseconds(rate_hz):
    signal, true_s = train(rate_hz, 16.0, seed=3)
    found_s = bursts(signal, rate_hz, SETTINGS)
    np.testing.assert_allclose(found_s, true_s, atol=0.010)


def test_noise_alone_has_no_burst_and_silence_no_noise():
    noise = np.random.default_rng(4).standard_normal(6000)
    assert len(bursts(noise, 1500.0, SETTINGS)) == 0
    assert len(bursts(np.zeros(6000), 1500.0, SETTINGS)) == 0


def test_the_noise_is_that_of_the_quiet_part():
    rng = np.random.default_rng(5)
    samples = 2.0 * rng.standard_normal(20000)
    samples[10000:] *= 10.0
    assert noise_variance(samples, 100, 0.1) == pytest.approx(4.0, rel=0.1)
    assert noise_variance(samples[:50], 100, 0.1) == 0.0


def test_a_pause_shorter_than_the_shortest_belongs_to_the_burst():
    signal, _ = train(2000.0, 20.0, 6, ((1.0, 1.3), (1.315, 1.6), (2.5, 2.51)), 4.0)
    found = bursts(signal, 2000.0, SETTINGS)
    np.testing.assert_allclose(found, [[1.0, 1.6]], atol=0.010)
