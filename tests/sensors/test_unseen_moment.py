"""The moment of what is not seen: stationary without readings, and told where Newton's law is given one."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.layout import UNSEEN_MOMENT
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.newton_euler import NewtonEulerLaw, NewtonEulerSettings
from mbkf.sensors.unseen_moment import UnseenMoment, UnseenMomentSettings
from tests.dynamics import DT, prepared_at, random_state, singer, standing
from tests.motions import reference_model

MODEL = reference_model()
SETTINGS = UnseenMomentSettings(40.0, 2.0)


def bound(block):
    plant = singer(MODEL, block.states())
    block.bind(plant.layout, plant.model)
    return plant


@pytest.mark.parametrize("dt_s", [0.005, 0.01, 0.02])
def test_a_random_walk_and_the_reading_of_its_decay_stand_at_the_stated_spread(dt_s):
    block = UnseenMoment(dt_s, SETTINGS)
    (state,) = block.states()
    assert state.start_sd[0] == SETTINGS.unseen_moment_nm
    bound(block)
    at = prepared_at(block, replace(random_state(MODEL, np.random.default_rng(0)), extra=np.zeros(3)))
    information = (block.linearise(at, True).jacobian ** 2)[0, 0]
    variance = 1.0
    for _ in range(5000):
        variance = 1.0 / (1.0 / (variance + state.walk_sd[0] ** 2 * dt_s) + information)
    assert variance**0.5 == pytest.approx(SETTINGS.unseen_moment_nm, rel=0.01)


def test_its_correlation_fades_with_the_stated_memory():
    """The gain of the reading takes the state back by the share exp(-dt / tau) of every frame."""
    block = UnseenMoment(DT, SETTINGS)
    bound(block)
    state = replace(random_state(MODEL, np.random.default_rng(0)), extra=np.full(3, 10.0))
    rows = block.linearise(prepared_at(block, state), True)
    moved = SETTINGS.unseen_moment_nm**2 * rows.jacobian.T @ rows.innovation
    np.testing.assert_allclose(moved / -10.0, 2.0 * DT / SETTINGS.unseen_memory_s, rtol=1e-9)


def test_newton_s_law_counts_it_in_the_root_s_axes():
    block = UnseenMoment(DT, SETTINGS)
    plant = bound(block)
    law = NewtonEulerLaw(NewtonEuler(MODEL), NewtonEulerSettings(2.0, 0.5))
    law.bind(plant.layout, plant.model)
    state = random_state(MODEL, np.random.default_rng(0), standing(MODEL))
    without, given = (
        law.prepare(replace(state, extra=m), None) for m in (np.zeros(3), np.array([5.0, -3.0, 2.0]))
    )
    np.testing.assert_allclose(given.innovation - without.innovation, [0, 0, 0, -10.0, 6.0, -4.0], atol=1e-9)
    rows = given.jacobian[:, plant.layout[UNSEEN_MOMENT]]
    np.testing.assert_array_equal(rows, np.vstack([np.zeros((3, 3)), 2.0 * np.eye(3)]))


def test_a_body_that_leans_for_long_shows_it():
    """The posterior of a constant residual tends to it as frames go by."""
    dt, residual, sd = 0.01, 30.0, 200.0
    block = UnseenMoment(dt, UnseenMomentSettings(50.0, 2.0))
    (state,) = block.states()
    bound(block)
    at = prepared_at(block, replace(random_state(MODEL, np.random.default_rng(0)), extra=np.zeros(3)))
    decay = (block.linearise(at, True).jacobian ** 2)[0, 0]
    mean, variance = 0.0, state.start_sd[0] ** 2
    for _ in range(1000):
        variance += state.walk_sd[0] ** 2 * dt
        information = 1.0 / variance + decay + sd**-2
        mean = (mean / variance + residual / sd**2) / information
        variance = 1.0 / information
    assert 0.4 * residual < mean < residual
