"""Plates' noise by the readings themselves: white noise is found, loads hardly change it."""

import numpy as np
import pytest

from mbkf.sensors.contact.plate_noise import LEAST_N, PlateNoise

FRAMES = 300


def followed(forces, start_n=3.0):
    """The noise found after readings (T, K, 3) without moments."""
    noise = PlateNoise(start_n)
    for force in forces:
        noise = noise.after(np.hstack([force, np.zeros_like(force)]))
    return noise.force_n


@pytest.mark.parametrize("sigma", [0.3, 1.0, 5.0])
def test_white_noise_is_found(sigma):
    """Within a third: the level wanders by its step."""
    forces = sigma * np.random.default_rng(1).normal(size=(FRAMES, 4, 3))
    assert abs(np.log(followed(forces) / sigma)) < np.log(4 / 3)


def test_a_load_on_one_of_two_plates_hardly_counts():
    rng, t = np.random.default_rng(2), np.arange(FRAMES)
    forces = 0.3 * rng.normal(size=(FRAMES, 2, 3))
    forces[:, 0, 2] += 800.0 * np.abs(np.sin(0.05 * t))
    assert followed(forces) < 0.45


def test_silent_plates_have_the_noise_of_their_digits_and_missing_ones_say_nothing():
    assert followed(np.zeros((FRAMES, 1, 3))) == LEAST_N
    assert followed(np.full((FRAMES, 1, 3), np.nan)) == 3.0
    assert followed(np.zeros((FRAMES, 0, 3))) == 3.0
