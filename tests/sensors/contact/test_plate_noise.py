"""Noise of plates: moments by their own readings, and in wrenches about the world's origin."""

import numpy as np
import pytest

from mbkf.sensors.contact.plate_noise import LEAST_FORCE_N, LEAST_MOMENT_NM, PlateNoise, spread_about_origin

ORIGINS_M = np.array([[2.0, 0.3, 0.0], [2.6, -0.3, 0.0]])
FORCE_N, MOMENT_NM, FRAMES = 0.5, 0.08, 400


def readings(force_n=FORCE_N, moment_nm=MOMENT_NM):
    """(T, 2, 6) about the world's origin: a load that swings slowly, with noise about each plate's own origin."""
    rng, t = np.random.default_rng(3), 0.01 * np.arange(FRAMES)
    force = force_n * rng.normal(size=(FRAMES, 2, 3))
    force[:, 0, 2] += 400.0 * (1.0 + np.sin(t))
    moment = moment_nm * rng.normal(size=(FRAMES, 2, 3)) + np.cross(ORIGINS_M, force)
    return np.concatenate([force, moment], axis=2)


def followed(wrenches):
    noise = PlateNoise.before(ORIGINS_M, 3.0, 1.0)
    for wrench in wrenches:
        noise = noise.after(wrench)
    return noise


def test_moments_have_a_noise_of_their_own_however_far_the_plate_is_from_the_world_s_origin():
    """Forces of 0.5 N at 2 m would look like moments of 1 N m; within a quarter, the level wanders by its step."""
    noise = followed(readings())
    assert noise.force.sd == pytest.approx(FORCE_N, rel=0.25)
    assert noise.moment.sd == pytest.approx(MOMENT_NM, rel=0.25)


def test_about_the_world_s_origin_forces_have_levers():
    """Of the second plate, which the left foot is nearer to: 0.3 m about x, 2.6 m about y, 2.62 m about z."""
    noise, soles = followed(readings()), np.array([[2.1, 0.1, 0.05], [2.5, -0.1, 0.05]])
    right, left = noise.on_feet(soles)
    F, M = noise.force.sd, noise.moment.sd
    np.testing.assert_allclose(left[:3], F)
    np.testing.assert_allclose(left[3:], np.hypot(M, F * np.array([0.3, 2.6, np.hypot(0.3, 2.6)])))
    np.testing.assert_allclose(right[4], np.hypot(M, 2.0 * F))


def test_the_spread_about_the_origin_is_that_of_the_moved_wrench():
    """Against the covariance of F and M + p × F with independent F and M."""
    p = np.array([0.7, -0.2, 0.4])
    across = np.cross(p, np.eye(3)).T
    covariance = 4.0 * across @ across.T + 0.25 * np.eye(3)
    found = spread_about_origin(2.0, 0.5, p[None])[0]
    np.testing.assert_allclose(found, [2.0, 2.0, 2.0, *np.sqrt(np.diag(covariance))])


def test_silent_plates_have_the_noise_of_their_digits_and_without_plates_the_usual_one_stays():
    silent = followed(np.zeros((FRAMES, 2, 6)))
    assert (silent.force.sd, silent.moment.sd) == (LEAST_FORCE_N, LEAST_MOMENT_NM)
    noise = PlateNoise.before(np.zeros((0, 3)), 3.0, 1.0).after(np.zeros((0, 6)))
    soles = np.array([[0.5, 0.1, 0.0], [0.5, -0.1, 0.0]])
    np.testing.assert_allclose(noise.on_feet(soles), spread_about_origin(3.0, 1.0, soles))
