"""Noise by the readings themselves: white noise is found, what is read hardly changes it."""

import numpy as np
import pytest

from mbkf.sensors.white_noise import WhiteNoise

SAMPLES, LEAST = 300, 0.1


def followed(readings, start=3.0):
    """The noise found after readings (T, …)."""
    noise = WhiteNoise(start, LEAST)
    for now in readings:
        noise = noise.after(now)
    return noise.sd


@pytest.mark.parametrize("sigma", [0.3, 1.0, 5.0])
def test_white_noise_is_found(sigma):
    """Within a third: the level wanders by its step."""
    readings = sigma * np.random.default_rng(1).normal(size=(SAMPLES, 4, 3))
    assert abs(np.log(followed(readings) / sigma)) < np.log(4 / 3)


def test_noise_of_many_numbers_is_known_better():
    """The level's step counts less where a sample has many numbers: markers' by a few percent."""
    readings = np.random.default_rng(3).normal(size=(SAMPLES, 36, 3))
    assert abs(np.log(followed(readings))) < 0.1


def test_a_load_on_one_of_two_plates_hardly_counts():
    rng, t = np.random.default_rng(2), np.arange(SAMPLES)
    forces = 0.3 * rng.normal(size=(SAMPLES, 2, 3))
    forces[:, 0, 2] += 800.0 * np.abs(np.sin(0.05 * t))
    assert followed(forces) < 0.45


def test_what_moves_smoothly_is_no_noise():
    """A limb at 100 Hz that swings by 0.4 m every second, with noise of half a millimetre."""
    rng, t = np.random.default_rng(4), 0.01 * np.arange(SAMPLES)
    swing = 0.2 * np.sin(2.0 * np.pi * t)[:, None, None] * np.array([1.0, 0.3, 0.1])
    noise = WhiteNoise(1e-3, 1e-5)
    for now in swing + 5e-4 * rng.normal(size=(SAMPLES, 12, 3)):
        noise = noise.after(now)
    assert noise.sd == pytest.approx(5e-4, rel=0.2)


def test_before_it_is_known_four_samples_tell_it():
    readings = 2.0 * np.random.default_rng(5).normal(size=(4, 300, 3))
    assert followed(readings[:3], 0.0) == 0.0
    assert followed(readings, 0.0) == pytest.approx(2.0, rel=0.1)
    assert followed(np.full((6, 3, 3), np.nan), 0.0) == 0.0
    assert followed(np.zeros((6, 3, 3)), 0.0) == LEAST


def test_silent_readings_have_the_noise_of_their_digits_and_missing_ones_say_nothing():
    assert followed(np.zeros((SAMPLES, 1, 3))) == LEAST
    assert followed(np.full((SAMPLES, 1, 3), np.nan)) == 3.0
    assert followed(np.zeros((SAMPLES, 0, 3))) == 3.0
