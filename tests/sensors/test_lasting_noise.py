"""Noise that stays: its white equivalent against simulated processes, and what it does to priors."""

import numpy as np
import pytest
from scipy.signal import lfilter

from mbkf.model.protocol import load_protocol
from mbkf.sensors.lasting_noise import prior_dilution, white_noise_m
from tests.motions import protocol_sensor, reference_model

DT, NOISE_M, CORRELATED_M, CORRELATION_S = 0.01, 0.020, 0.010, 0.3


def equivalent(frequency_hz=0.0, correlated_m=CORRELATED_M, correlation_s=CORRELATION_S):
    found = white_noise_m(
        np.array([NOISE_M]), np.array([correlated_m]), np.array([correlation_s]), DT, frequency_hz
    )
    return float(found[0])


def simulated(runs, frames):
    """(runs, frames) stationary noise, the slow part by its recursion."""
    rng = np.random.default_rng(5)
    rho = np.exp(-DT / CORRELATION_S)
    new = rng.normal(0.0, CORRELATED_M, (runs, frames))
    new[:, 1:] *= np.sqrt(1.0 - rho**2)
    slow = lfilter([1.0], [1.0, -rho], new, axis=1)
    return slow + rng.normal(0.0, np.sqrt(NOISE_M**2 - CORRELATED_M**2), (runs, frames))


def test_noise_that_does_not_stay_is_itself():
    assert equivalent(correlated_m=0.0) == pytest.approx(NOISE_M)
    assert equivalent(correlation_s=0.0) == pytest.approx(NOISE_M)
    assert equivalent(correlation_s=1e-6) == pytest.approx(NOISE_M)


def test_the_low_frequency_limit_is_the_known_one():
    slow = 1.0 / np.tanh(0.5 * DT / CORRELATION_S)
    assert equivalent() ** 2 == pytest.approx(NOISE_M**2 - CORRELATED_M**2 + slow * CORRELATED_M**2)
    assert slow == pytest.approx(2 * CORRELATION_S / DT, rel=1e-3)


def test_a_mean_of_many_frames_errs_as_stated():
    """The normalised squared error of the least-squares place of a point at rest is chi-square, one per run."""
    runs, frames = 2000, 3000
    error = simulated(runs, frames).mean(axis=1)
    spread = 3.3 * np.sqrt(2.0 / runs)
    assert np.mean(error**2) / (equivalent() ** 2 / frames) == pytest.approx(1.0, abs=spread + 0.02)
    assert np.mean(error**2) / (NOISE_M**2 / frames) > 10.0, "white noise of its spread would claim too much"


@pytest.mark.parametrize("frequency_hz", [0.5, 1.0, 4.0, 20.0])
def test_power_at_a_frequency(frequency_hz):
    runs, frames = 3000, 1000
    wave = np.exp(-2j * np.pi * frequency_hz * DT * np.arange(frames))
    power = np.mean(np.abs(simulated(runs, frames) @ wave) ** 2) / frames
    assert power == pytest.approx(equivalent(frequency_hz) ** 2, rel=4.0 / np.sqrt(runs) + 0.02)


@pytest.mark.parametrize(("name", "kept"), [("halpe26", True), ("opencap43", False)])
def test_a_trunk_keeps_its_prior_where_the_pelvis_shows_no_tilt(name, kept):
    """Hips and their middle lie on a line; iliac spines do not."""
    model = reference_model()
    sensor = protocol_sensor(model, name)[0]
    spread = np.full(len(load_protocol(name).markers), NOISE_M)
    factor = prior_dilution(sensor, 4.0 * spread, spread)
    trunk = model.joint("torso").v
    np.testing.assert_allclose(np.delete(factor, np.arange(model.nv)[trunk]), 4.0)
    np.testing.assert_allclose(factor[trunk], 1.0 if kept else 4.0)
