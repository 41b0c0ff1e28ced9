"""The white-acceleration plant: its transition along the manifold and its noise in closed form."""

import numpy as np
import pytest

from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.model.human import HumanModel
from tests.motions import assert_near, moderate_pose, random_model, reference_model

DT = 0.01


@pytest.fixture
def rng():
    return np.random.default_rng(1)


def random_state(model, rng, speed=3.0):
    A = rng.normal(size=(2 * model.nv, 2 * model.nv))
    return KinematicState(moderate_pose(model, rng), speed * rng.normal(size=model.nv), A @ A.T)


def moved(model, state, step):
    """The state displaced by a tangent step of (q, v)."""
    return KinematicState(model.integrate(state.q, step[: model.nv]), state.v + step[model.nv :], state.P)


def test_transition_is_the_derivative_of_the_prediction(rng):
    model = random_model(rng)
    plant, state, h = WhiteAccelerationPlant(model, DT, model.acceleration_sd), random_state(model, rng), 1e-6
    phi = plant.transition(state)
    still = np.zeros_like(state.P)

    def predicted(step):
        return plant.predict(moved(model, KinematicState(state.q, state.v, still), step))

    centre, columns = predicted(np.zeros(2 * model.nv)), []
    for e in np.eye(2 * model.nv):
        ends = [predicted(s * h * e) for s in (1, -1)]
        q = [model.difference(centre.q, end.q) for end in ends]
        columns.append(np.concatenate([q[0] - q[1], ends[0].v - ends[1].v]) / (2 * h))
    assert_near(phi, np.stack(columns, axis=1), 1e-9)


def test_transition_of_resting_and_of_straight_moving_dofs_is_the_textbook_one(rng):
    """Φ = [[1, Δt], [0, 1]] per dof (thesis eq. 3.1), exact on translations and hinges whatever the speed."""
    model = reference_model()
    plant, nv = WhiteAccelerationPlant(model, DT, model.acceleration_sd), model.nv
    textbook = np.block([[np.eye(nv), DT * np.eye(nv)], [np.zeros((nv, nv)), np.eye(nv)]])
    at_rest = KinematicState(moderate_pose(model, rng), np.zeros(nv), np.eye(2 * nv))
    assert_near(plant.transition(at_rest), textbook, 1e-15)
    straight = np.r_[0:3, 9:11, [model.joint(f"{side}_toes").v.start for side in ("right", "left")]]
    v = np.zeros(nv)
    v[straight] = rng.normal(size=len(straight))
    phi, own = plant.transition(KinematicState(at_rest.q, v, np.eye(2 * nv))), np.r_[straight, nv + straight]
    assert_near(phi[np.ix_(own, own)], textbook[np.ix_(own, own)], 1e-15)


def test_noise_is_gamma_gamma_transposed(rng):
    """Q = Γ σ² Γᵀ with Γ = [Δt²/2, Δt] per dof and nothing between dofs (thesis eqs. 3.2, 3.3)."""
    model = reference_model()
    sd, nv = rng.uniform(1, 300, model.nv), model.nv
    state = KinematicState(moderate_pose(model, rng), np.zeros(nv), np.zeros((2 * nv, 2 * nv)))
    plant = WhiteAccelerationPlant(model, DT, sd)
    Q = plant.predict(state).P
    gamma = np.array([DT**2 / 2, DT])
    for dof in range(nv):
        own = np.ix_([dof, nv + dof], [dof, nv + dof])
        np.testing.assert_allclose(Q[own], sd[dof] ** 2 * np.outer(gamma, gamma), rtol=1e-14)
        Q[own] = 0.0
    assert not Q.any()


def test_covariance_is_carried_by_the_transition(rng):
    model = random_model(rng)
    plant, state = WhiteAccelerationPlant(model, DT, np.zeros(model.nv)), random_state(model, rng)
    phi = plant.transition(state)
    after = plant.predict(state)
    expected = phi @ state.P @ phi.T
    sd = np.sqrt(np.diag(expected))
    assert (np.abs(after.P - expected) <= 2e-15 * np.outer(sd, sd)).all()
    np.testing.assert_array_equal(after.v, state.v)
    assert_near(model.difference(state.q, after.q), state.v * DT, 1e-15)


def test_an_unobservable_dof_gets_no_noise(rng):
    model = reference_model()
    unobservable = np.arange(model.nv) % 3 == 0
    plant = WhiteAccelerationPlant(model, DT, np.where(unobservable, 0.0, model.acceleration_sd))
    state = KinematicState(model.neutral(), np.zeros(model.nv), np.zeros((2 * model.nv, 2 * model.nv)))
    P = plant.predict(state).P
    both = np.r_[unobservable, unobservable]
    assert not P[both].any()
    assert (np.diag(P)[~both] > 0).all()


def test_the_plant_knows_no_masses(rng):
    """A kinematic plant: a body ten times heavier moves and doubts alike."""
    body = reference_model().description
    light, heavy = (HumanModel(body, np.ones(18), mass) for mass in (8.0, 800.0))
    state = random_state(light, rng)
    after = []
    for model in (light, heavy):
        plant = WhiteAccelerationPlant(model, DT, model.acceleration_sd)
        after.append(plant.predict(state))
    np.testing.assert_array_equal(after[0].q, after[1].q)
    np.testing.assert_array_equal(after[0].P, after[1].P)


def test_playing_backwards_returns_to_the_start(rng):
    """Prediction, time reversal, prediction: the mean comes back."""
    model = random_model(rng)
    plant, state = WhiteAccelerationPlant(model, DT, model.acceleration_sd), random_state(model, rng)
    there = plant.predict(state).reversed_in_time()
    back = plant.predict(there).reversed_in_time()
    assert_near(model.difference(state.q, back.q), 0.0, 2e-15)
    np.testing.assert_array_equal(back.v, state.v)


def test_time_reversal_turns_velocities_and_their_covariance_with_positions(rng):
    model = reference_model()
    state, nv = random_state(model, rng), model.nv
    turned = state.reversed_in_time()
    np.testing.assert_array_equal(turned.v, -state.v)
    np.testing.assert_array_equal(turned.P[:nv, :nv], state.P[:nv, :nv])
    np.testing.assert_array_equal(turned.P[nv:, nv:], state.P[nv:, nv:])
    np.testing.assert_array_equal(turned.P[:nv, nv:], -state.P[:nv, nv:])
    np.testing.assert_array_equal(turned.reversed_in_time().P, state.P)
