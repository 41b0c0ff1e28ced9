"""Contract of every plant, found by itself and tested alone: covariance, noise, memory, tangent space.

That its transition is the derivative of its motion, tests/test_jacobians.py checks.
"""

import copy

import numpy as np
import pytest

from mbkf.filters.torque.plant import TorquePlant
from mbkf.sensors.block import NO_DOFS, Notes
from tests.motions import worst
from tests.plant_contract import HELD, made, plant_classes

PLANTS = plant_classes()
each_plant = pytest.mark.parametrize("name", PLANTS)
pytestmark = pytest.mark.usefixtures("either_kernel")


def of(name, seed=0, hold=False):
    return made(PLANTS[name], np.random.default_rng(seed), hold)


def scaled(P, like):
    """A matrix by the standard deviations of a covariance."""
    sd = np.sqrt(np.diag(like))
    return P / sd / sd[:, None]


def with_covariance(plant, state, P):
    return plant.retract(state, np.zeros(len(P)), P)


def test_those_of_the_package_and_of_the_tests_are_found():
    assert {"WhiteAccelerationPlant", "SingerPlant", "TorquePlant", "Damped"} <= set(PLANTS)


@each_plant
def test_the_predicted_covariance_is_that_of_the_transition_and_a_noise(name):
    """Φ P Φᵀ + Q, with a Q that is the same whatever P was, symmetric and without a negative eigenvalue."""
    plant, state = of(name)
    noise, phi = plant.noise(plant.begin()), plant.transition(state)
    certain = with_covariance(plant, state, np.asfortranarray(np.zeros_like(state.P)))
    Q, found = plant.predict(certain, noise).P, plant.predict(state, noise).P
    assert worst(scaled(found - phi @ state.P @ phi.T - Q, found)) < 1e-11
    np.testing.assert_array_equal(found, found.T)
    np.testing.assert_array_equal(Q, Q.T)
    assert np.linalg.eigvalsh(Q).min() > -1e-12 * worst(Q)
    assert worst(Q) > 0.0
    if plant.layout.extras:
        own = plant.layout.extra
        np.testing.assert_allclose(np.diag(Q)[own], plant.layout.walk_variance(plant.dt_s))
    by_dofs = plant.dof_noise(noise)
    assert by_dofs is not None or name != "SingerPlant"
    if by_dofs is not None:
        G, stated = np.kron(by_dofs.share[:, None], np.diag(by_dofs.sd)), np.zeros_like(Q)
        stated[: len(G), : len(G)] = G @ G.T
        plant.add_walk(stated)
        assert worst(scaled(stated - Q, found)) < 1e-12


@each_plant
def test_the_predicted_mean_is_the_moved_one(name):
    plant, state = of(name)
    moved = plant.move(state)
    assert moved.P is state.P
    assert worst(plant.difference(moved, plant.predict(state, plant.noise(plant.begin())))) < 1e-12


@each_plant
def test_a_prediction_is_new_repeats_and_leaves_its_inputs_alone(name):
    plant, state = of(name)
    noise = plant.noise(plant.begin())
    kept = copy.deepcopy((state, noise))
    found = plant.predict(state, noise)
    assert found.P.flags.f_contiguous and not np.shares_memory(found.P, state.P)
    first = found.P.copy()
    found.P[:] += 1.0  # as blocks do that add noise
    np.testing.assert_array_equal(plant.predict(state, noise).P, first)
    for part in ("q", "v", "P"):
        np.testing.assert_array_equal(getattr(state, part), getattr(kept[0], part))
    np.testing.assert_array_equal(noise, kept[1])


@each_plant
def test_the_transition_of_a_step_is_that_of_its_beginning(name):
    """step_transition, in any form: as a matrix, and times a vector."""
    plant, state = of(name)
    predicted, N = plant.predict(state, plant.noise(plant.begin())), plant.layout.size
    step, phi = plant.step_transition(state, predicted), plant.transition(state)
    x = np.random.default_rng(1).normal(size=N)
    assert worst(step.matrix(N) - phi) <= 1e-13 * worst(phi)
    assert worst(step.forward(x) - phi @ x) <= 1e-12 * worst(phi) * worst(x)


@each_plant
def test_the_difference_undoes_a_retraction(name):
    plant, state = of(name)
    step = 0.1 * np.random.default_rng(1).normal(size=plant.layout.size)
    moved = plant.retract(state, step, 2.0 * state.P)
    np.testing.assert_allclose(plant.difference(state, moved), step, atol=1e-9)
    np.testing.assert_array_equal(moved.P, 2.0 * state.P)
    assert worst(plant.difference(state, state)) < 1e-15


@each_plant
def test_memory_follows_the_motion_and_is_replaced_not_written_into(name):
    plant, state = of(name)
    memory, notes = plant.begin(), Notes(unobserved=NO_DOFS)
    for _ in range(3):
        kept = copy.deepcopy(memory)
        after = plant.remember(state, notes, memory)
        assert np.array_equal(memory, kept) if memory is not None else kept is None
        P = plant.predict(state, plant.noise(after)).P
        assert np.isfinite(P).all() and np.linalg.eigvalsh(P).min() > 0.0
        memory = after


@pytest.mark.parametrize("name", [name for name in PLANTS if PLANTS[name] is not TorquePlant])
def test_held_dofs_gain_no_uncertainty(name):
    plant, state = of(name, hold=True)
    every, held = np.arange(plant.layout.size), plant.model.joint(HELD).v
    own = np.concatenate(
        [every[plant.layout[part]][held] for part in ("q", "v", "a") if part in plant.layout]
    )
    P = state.P.copy(order="F")
    P[own], P[:, own] = 0.0, 0.0
    found = plant.predict(with_covariance(plant, state, P), plant.noise(plant.begin())).P
    assert worst(found[own]) < 1e-15
