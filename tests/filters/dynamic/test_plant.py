"""The Singer plant: its noise by quadrature, its limits in closed form, prediction as Φ P Φᵀ + Q.

That its transition is the derivative of its prediction, tests/test_jacobians.py checks.
"""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.filters.dynamic.plant import DynamicState, SingerSettings
from tests.dynamics import DT, random_state, singer
from tests.motions import assert_near, random_model, reference_model, worst

MODEL = reference_model()
NV = MODEL.nv
N = 3 * NV + 12


def plant_of(decay_s, dt_s=DT, model=MODEL):
    return singer(model, settings=SingerSettings(decay_s=decay_s), dt_s=dt_s)


def rates(decay_s):
    return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / decay_s]])


def whole_noise(plant):
    """(N, N) Q of all states."""
    Q = np.zeros((N, N))
    variance = np.diag(plant.acceleration_sd**2)
    Q[: 3 * NV, : 3 * NV] = np.kron(plant.covariance, variance)
    return Q


def straight(plant):
    """(3, 3) Φ of a dof whose manifold is flat."""
    return np.array([[1.0, plant.dt_s, plant.c2], [0.0, 1.0, plant.c1], [0.0, 0.0, plant.rho]])


decays = pytest.mark.parametrize("decay_s", [0.003, 0.05, 0.4, 5.0])


@decays
def test_factors_are_those_of_the_linear_equation(decay_s):
    """exp(F Δt) for ȧ = −a/T."""
    assert_near(straight(plant_of(decay_s)), scipy.linalg.expm(DT * rates(decay_s)), 1e-13)


@decays
def test_noise_is_the_integral(decay_s):
    """∫ e^(Fs) G Gᵀ e^(Fᵀs) ds with 2/T on the acceleration, by adaptive quadrature."""
    F = rates(decay_s)

    def density(s):
        column = scipy.linalg.expm(F * s)[:, 2]
        return np.outer(column, column) * 2.0 / decay_s

    numeric, _ = scipy.integrate.quad_vec(density, 0.0, DT, epsrel=1e-12, epsabs=0.0)
    np.testing.assert_allclose(plant_of(decay_s).covariance, numeric, rtol=1e-8)


@given(st.floats(0.01, 1.0), st.floats(1e-3, 0.1))
@settings(max_examples=25, deadline=None)
def test_two_half_steps_are_one(decay_s, dt_s):
    whole, half = plant_of(decay_s, dt_s), plant_of(decay_s, 0.5 * dt_s)
    phi = straight(half)
    np.testing.assert_allclose(phi @ phi, straight(whole), rtol=1e-8, atol=1e-15)
    size = np.sqrt(np.diag(whole.covariance))
    difference = phi @ half.covariance @ phi.T + half.covariance - whole.covariance
    assert worst(difference / size[:, None] / size) < 1e-6


@decays
def test_noise_keeps_the_acceleration_stationary(decay_s):
    plant = plant_of(decay_s)
    assert plant.rho**2 + plant.covariance[2, 2] == pytest.approx(1.0, rel=1e-12)
    assert np.linalg.eigvalsh(plant.covariance).min() > -1e-18


def test_a_slow_decay_is_the_constant_acceleration_plant():
    """T → ∞ with jerk density 2 σ²/T = 1: Φ with Δt²/2, Q of white jerk."""
    T, dt = 200.0, 0.1
    plant = plant_of(T, dt)
    assert_near(straight(plant), [[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]], 1e-3)
    white_jerk = np.array(
        [
            [dt**5 / 20, dt**4 / 8, dt**3 / 6],
            [dt**4 / 8, dt**3 / 3, dt**2 / 2],
            [dt**3 / 6, dt**2 / 2, dt],
        ]
    )
    np.testing.assert_allclose(plant.covariance * T / 2.0, white_jerk, rtol=2e-3)


def test_a_quick_decay_tends_to_the_white_acceleration_plant():
    """T → 0 with 2 σ² T = 1: accelerations are forgotten, velocities wander; the error shrinks with T."""
    dt = 0.1
    white = np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
    plants = [plant_of(T, dt) for T in (dt / 10, dt / 20)]
    errors = [
        worst(plant.covariance[:2, :2] / (2.0 * plant.settings.decay_s) / white - 1.0) for plant in plants
    ]
    assert errors[1] < 0.6 * errors[0] < 0.2
    assert plants[1].rho < 1e-8
    assert plants[1].covariance[2, 2] == pytest.approx(1.0, rel=1e-6)
    assert plants[1].c1 == pytest.approx(plants[1].settings.decay_s, rel=1e-6)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("seed", range(3))
def test_covariance_is_carried_and_gains_the_noise(seed, order):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    plant, state = plant_of(0.05, model=model), random_state(model, rng)
    state = DynamicState(state.q, state.v, state.a, state.w, np.array(state.P, order=order))
    before = state.P.copy()
    phi, found = plant.transition(state), plant.predict(state)
    expected = phi @ before @ phi.T + whole_noise(plant)
    scale = np.sqrt(np.diag(expected))
    assert worst((found.P - expected) / scale[:, None] / scale) < 1e-13
    np.testing.assert_array_equal(found.P, found.P.T)
    np.testing.assert_array_equal(state.P, before)
    assert found.P.flags.f_contiguous and not np.shares_memory(found.P, state.P)


def test_mean_follows_its_accelerations():
    rng = np.random.default_rng(5)
    plant, s = plant_of(0.05), random_state(MODEL, rng)
    found = plant.predict(s)
    assert_near(MODEL.difference(s.q, found.q), plant.dt_s * s.v + plant.c2 * s.a, 1e-12)
    assert_near(found.v, s.v + plant.c1 * s.a, 1e-12)
    assert_near(found.a, plant.rho * s.a, 1e-12)
    np.testing.assert_array_equal(found.w, s.w)


def test_a_dof_without_acceleration_stays_as_well_known_as_it_is():
    still = np.arange(NV) == 40
    plant = singer(MODEL, held=still, settings=SingerSettings(decay_s=0.05))
    s = random_state(MODEL, np.random.default_rng(6))
    own = np.array([40, NV + 40, 2 * NV + 40])
    phi = plant.transition(s)
    assert_near(
        plant.predict(s).P[np.ix_(own, own)], (phi @ s.P @ phi.T)[np.ix_(own, own)], 1e-12 * worst(s.P)
    )


def test_a_busy_joint_s_noise_follows_its_acceleration_up_to_its_share_of_the_table():
    """The pelvis's translation, which gravity and the ground move together, is bounded sooner than all else."""
    s = SingerSettings(quiet_share=0.1, activity_gain=6.0, busy_shares=(2.0, 8.0))
    plant = singer(MODEL, settings=s)
    table = MODEL.movement_sd
    assert_near(plant.noise(np.zeros(NV)), 0.1 * table, 1e-12)
    assert_near(plant.noise((0.1 * table) ** 2), np.hypot(0.1, 0.6) * table, 1e-12)
    most = np.r_[np.full(3, 2.0), np.full(NV - 3, 8.0)]
    assert_near(plant.noise((100.0 * table) ** 2), most * table, 1e-12)
