"""The wrench that a motion asks for: against the exact one of a person who stands up, and whoever looks on."""

from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.sensors.supports.momentum import LEAST_WINDOW, WholeBody
from tests.supported import seat, seated

SHORT_S, LONG_S = 0.05, 0.25


@cache
def body():
    made = seated()
    return WholeBody.of(made.model, made.motion.q, made.motion.v)


def missing(given, window_s=SHORT_S, whole=None):
    return (whole or body()).missing_wrench(given, seated().motion.rate_hz, window_s)


def feet():
    return seated().motion.foot_wrench.sum(axis=1)


def about_the_centre(wrench, whole=None):
    moved = wrench.copy()
    moved[:, 3:] -= np.cross((whole or body()).centre_m, wrench[:, :3])
    return moved


@pytest.mark.parametrize("window_s", [SHORT_S, 0.1, LONG_S])
def test_nothing_is_missing_where_all_is_given(window_s):
    """Both sides are smoothed alike, so that hardly anything of the window stays: 0.1 % of body weight, and times m."""
    found = missing(feet() + seat(seated().motion), window_s)
    assert np.abs(found).max() < 1e-3 * seated().model.mass_kg * GRAVITY_M_S2


def test_what_is_withheld_is_missing():
    """The seat's wrench about the centre of mass, smoothed by the window; what is lost in it grows with its square."""
    true, errors = about_the_centre(seat(seated().motion)), []
    for window_s in (SHORT_S, 2 * SHORT_S):
        errors.append(np.sqrt(np.mean((missing(feet(), window_s) - true)[20:-20] ** 2, axis=0)))
    assert errors[0][:3].max() < 1.0
    assert errors[0][3:].max() < 0.2
    assert (errors[1][[0, 2]] > 2.0 * errors[0][[0, 2]]).all()


def test_without_any_plate_all_is_missing():
    found = missing(0.0 * feet(), LONG_S)
    true = about_the_centre(feet() + seat(seated().motion))
    assert np.sqrt(np.mean((found - true)[30:-30, :3] ** 2)) < 0.02 * np.abs(true[:, 2]).max()


def test_whoever_passes_by_sees_the_same_forces():
    """In a frame that moves steadily, plates and all."""
    m, speed = seated().motion, np.array([1.2, -0.4, 0.3])
    away = m.times_s[:, None] * speed
    q, v, given = m.q.copy(), m.v.copy(), feet().copy()
    q[:, :3] += away
    for t in range(len(q)):
        rotation = seated().model.placements(q[t])[0][1]
        v[t, :3] += rotation.T @ speed
    given[:, 3:] += np.cross(away, given[:, :3])
    whole = WholeBody.of(seated().model, q, v)
    np.testing.assert_allclose(whole.momentum[:, 3:], body().momentum[:, 3:], atol=1e-9)
    np.testing.assert_allclose(missing(given, whole=whole), missing(feet()), atol=1e-6)


def test_momentum_is_that_of_the_centre_of_mass():
    whole, rate = body(), seated().motion.rate_hz
    moved = np.gradient(whole.centre_m, axis=0)[1:-1] * rate * seated().model.mass_kg
    np.testing.assert_allclose(moved, whole.momentum[1:-1, :3], atol=0.05)
    assert whole.weight[2] == pytest.approx(-GRAVITY_M_S2 * seated().model.mass_kg)
    np.testing.assert_array_equal(whole.weight[[0, 1, 3, 4, 5]], 0.0)


def test_gaps_part_what_is_known():
    """Each run is as if it were alone; one shorter than the window says nothing."""
    m = seated().motion
    q = m.q.copy()
    q[60:63] = q[66:100] = np.nan
    whole = WholeBody.of(seated().model, q, m.v)
    found = missing(feet(), LONG_S, whole)
    assert np.isnan(found[60:100]).all()
    first = WholeBody.of(seated().model, m.q[:60], m.v[:60])
    np.testing.assert_allclose(found[:60], missing(feet()[:60], LONG_S, first), atol=1e-6)
    assert np.isfinite(found[100:]).all()


def test_a_window_has_a_least_number_of_frames():
    np.testing.assert_array_equal(
        missing(feet(), 0.0), missing(feet(), (LEAST_WINDOW - 1) / seated().motion.rate_hz)
    )
    few = slice(0, LEAST_WINDOW - 1)
    whole = WholeBody.of(seated().model, seated().motion.q[few], seated().motion.v[few])
    assert np.isnan(missing(feet()[few], 0.0, whole)).all()
