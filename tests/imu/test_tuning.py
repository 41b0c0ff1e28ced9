"""Gains from rest are the noise's; the search finds what follows the reference."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.imu.tuning import (
    GainComparison,
    reference_of,
    searched_gains,
    static_gains,
    still_stretch,
    swept_gains,
)
from mbkf.io.imu.readings import ImuReadings
from tests.imu.turning import RATE_HZ, turning


def resting(seconds=20.0, noise=0.01, slope=0.0, seed=0):
    rng = np.random.default_rng(seed)
    count = round(seconds * RATE_HZ)
    t = np.arange(count) / RATE_HZ
    gyro = rng.normal(0.0, noise, (count, 3)) + slope * t[:, None] + [0.01, 0.0, -0.01]
    force = np.tile([0.0, 0.0, 9.8], (count, 1)) + rng.normal(0.0, 0.02, (count, 3))
    return ImuReadings("a", t, force, gyro, None, RATE_HZ)


def test_gains_at_rest_are_those_of_madgwick():
    one = resting(noise=0.01, slope=2e-3)
    found = static_gains(one, 0, one.samples)
    assert found.gyro_noise_rad_s == pytest.approx(0.01, rel=0.03)
    assert found.gyro_drift_rad_s2 == pytest.approx(2e-3, rel=0.05)
    assert found.beta == pytest.approx(np.sqrt(0.75) * found.gyro_noise_rad_s)
    assert found.zeta == pytest.approx(np.sqrt(0.75) * found.gyro_drift_rad_s2)
    np.testing.assert_allclose(found.gyro_bias_rad_s, [0.03, 0.02, 0.01], atol=1e-3)
    with pytest.raises(InvalidInput, match="too few"):
        static_gains(one, 0, 5)


def test_the_longest_rest_is_found():
    made = turning(20.0, still_s=6.0)
    noise = np.random.default_rng(0).normal(0.0, 0.002, made.gyro.shape)
    first, last = still_stretch(made.readings(gyro=made.gyro + noise))
    assert first == 0
    assert 500 <= last <= 650
    busy = turning(10.0, still_s=-1.0)
    with pytest.raises(InvalidInput, match="never lies still"):
        still_stretch(busy.readings())


def test_the_search_beats_its_neighbours():
    made = turning(12.0, shake_mps2=2.0)
    gyro = made.gyro + np.random.default_rng(0).normal(0.0, 0.05, made.gyro.shape) + [0.03, -0.02, 0.02]
    one = made.readings(gyro=gyro)
    found = searched_gains(GainComparison(one, made.truth, "NWU"))
    best = min(error for _, _, error in found.trials)
    assert found.error.total == best
    assert 0.02 < found.settings.beta < 0.6
    assert best < min(error for beta, _, error in found.trials if beta < 0.01)


def test_a_sweep_tries_every_pair_from_the_start_it_is_given():
    made = turning(3.0, shake_mps2=2.0)
    compared = GainComparison(made.readings(), made.truth, "NWU")
    askew = np.array([0.0, 1.0, 0.0, 0.0])
    found = swept_gains(compared, (0.05, 0.4), (0.0, 0.02))
    assert [trial[:2] for trial in found.trials] == [(0.05, 0.0), (0.05, 0.02), (0.4, 0.0), (0.4, 0.02)]
    assert found.error.total == min(error for _, _, error in found.trials)
    lost = swept_gains(replace(compared, start=askew), (0.05,), (0.0,))
    assert lost.error.total > 5.0 * found.trials[0][2]
    with pytest.raises(InvalidInput, match="one beta"):
        swept_gains(compared, (), (0.0,))


def test_a_reference_without_samples_is_refused():
    made = turning(2.0)
    with pytest.raises(InvalidInput, match="no sample"):
        searched_gains(GainComparison(made.readings(), np.full_like(made.truth, np.nan), "NWU"))


def test_the_files_orientation_is_the_reference_where_its_world_is_known():
    made = turning(2.0)
    np.testing.assert_allclose(reference_of(made.readings(), "NWU"), made.truth, atol=1e-12)
    with pytest.raises(InvalidInput, match="no orientation"):
        reference_of(resting(2.0), "NWU")
