"""The Singer plant: one trajectory within the frame, its limits in closed form, prediction as Φ P Φᵀ + Q.

That its transition is the derivative of its prediction, tests/test_jacobians.py checks.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from mbkf.filters.dynamic.plant import SingerSettings
from mbkf.sensors.block import Notes
from tests.dynamics import DT, random_state, singer
from tests.motions import assert_near, random_model, reference_model, worst

MODEL = reference_model()
NV = MODEL.nv


def plant_of(decay_s, dt_s=DT, model=MODEL):
    return singer(model, settings=SingerSettings(decay_s=decay_s), dt_s=dt_s)


def rates(decay_s):
    return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / decay_s]])


def whole_noise(plant):
    """(N, N) Q of all states: that of the motion, and the walk of added states."""
    Q, moving = np.zeros((plant.layout.size, plant.layout.size)), slice(3 * plant.model.nv)
    Q[moving, moving] = np.kron(plant.covariance, np.diag(plant.acceleration_sd**2))
    for extra in plant.layout.extras:
        own = plant.layout[extra.name]
        Q[own, own] = np.diag(extra.walk_sd**2 * plant.dt_s)
    return Q


def straight(plant):
    """(3, 3) Φ of a dof whose manifold is flat."""
    return np.array([[1.0, plant.dt_s, plant.c2], [0.0, 1.0, plant.c1], [0.0, 0.0, plant.rho]])


def driven(plant):
    """(3,) change of (q, v, a) by one standard deviation of the noise."""
    return np.sqrt(np.diag(plant.covariance))


decays = pytest.mark.parametrize("decay_s", [0.003, 0.05, 0.4, 5.0])


@decays
def test_positions_and_velocities_are_integrals_of_the_acceleration(decay_s):
    """Whatever is drawn, a runs straight from a to a' within the frame, and v' and q' are its integrals."""
    plant, rng = plant_of(decay_s), np.random.default_rng(0)
    for before, noise in zip(rng.normal(size=(5, 3)), rng.normal(size=5), strict=True):
        after = straight(plant) @ before + driven(plant) * noise
        a = Polynomial([before[2], (after[2] - before[2]) / DT])
        v = a.integ(k=before[1])
        assert_near(after, [v.integ(k=before[0])(DT), v(DT), a(DT)], 1e-13)


@decays
def test_one_noise_moves_all_three(decay_s):
    """Q is of rank one: no noise parts v from the trapezoid of a, nor q from the integral of both."""
    plant = plant_of(decay_s)
    assert_near(plant.covariance, np.outer(driven(plant), driven(plant)), 1e-15)
    for apart in ([0.0, 1.0, -DT / 2.0], [1.0, 0.0, -(DT**2) / 6.0]):
        size = np.abs(apart) @ driven(plant)
        assert np.abs(apart @ plant.covariance @ apart) < 1e-15 * size**2


@decays
def test_the_acceleration_is_stationary(decay_s):
    """It keeps its variance, and decays in T."""
    plant = plant_of(decay_s)
    assert plant.rho == pytest.approx(np.exp(-DT / decay_s), rel=1e-12)
    assert plant.rho**2 + plant.covariance[2, 2] == pytest.approx(1.0, rel=1e-12)


@decays
def test_white_jerk_is_the_integral_of_the_linear_equation(decay_s):
    """exp(F Δt), and ∫ e^(Fs) G Gᵀ e^(Fᵀs) ds with 2/T on the acceleration, by adaptive quadrature."""
    plant = singer(MODEL, settings=SingerSettings(decay_s=decay_s, constant_jerk=False))
    F = rates(decay_s)

    def density(s):
        column = scipy.linalg.expm(F * s)[:, 2]
        return np.outer(column, column) * 2.0 / decay_s

    numeric, _ = scipy.integrate.quad_vec(density, 0.0, DT, epsrel=1e-12, epsabs=0.0)
    np.testing.assert_allclose(plant.covariance, numeric, rtol=1e-8)
    assert_near(straight(plant), scipy.linalg.expm(DT * F), 1e-13)


@given(st.floats(0.05, 1.0))
@settings(max_examples=25, deadline=None)
def test_short_steps_tend_to_the_linear_equation(decay_s):
    """exp(F Δt) of ȧ = −a/T: half the step leaves an eighth of the error of v and a sixteenth of that of q."""
    errors = []
    for dt_s in (0.1 * decay_s, 0.05 * decay_s):
        exact = scipy.linalg.expm(dt_s * rates(decay_s))
        errors.append((straight(plant_of(decay_s, dt_s)) - exact)[:2, 2])
    np.testing.assert_allclose(errors[1] / errors[0], [1.0 / 16.0, 1.0 / 8.0], rtol=0.1)


def test_a_slow_decay_is_the_constant_acceleration_plant():
    """T → ∞ with jerk density 2 σ²/T = 1: Φ with Δt²/2, Q of a jerk that is constant within the frame."""
    T, dt = 200.0, 0.1
    plant = plant_of(T, dt)
    assert_near(straight(plant), [[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]], 1e-3)
    jerk = np.array([dt**3 / 6, dt**2 / 2, dt])
    np.testing.assert_allclose(plant.covariance * T / 2.0, np.outer(jerk, jerk) / dt, rtol=2e-3)


def test_a_quick_decay_draws_accelerations_anew():
    """T → 0: in n frames the velocity wanders by the trapezoids of independent accelerations, (n − 1/2) σ² Δt²."""
    plant, n = plant_of(1e-4, 0.1), 20
    assert plant.rho < 1e-8
    assert plant.covariance[2, 2] == pytest.approx(1.0, rel=1e-12)
    P, phi = np.diag([0.0, 0.0, 1.0]), straight(plant)
    for _ in range(n):
        P = phi @ P @ phi.T + plant.covariance
    # of the first and the last acceleration half a frame counts
    assert P[1, 1] == pytest.approx((n - 0.5) * 0.1**2, rel=1e-9)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("seed", range(3))
def test_covariance_is_carried_and_gains_the_noise(seed, order):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    plant, state = plant_of(0.05, model=model), random_state(model, rng)
    state = replace(state, P=np.array(state.P, order=order))
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
    np.testing.assert_array_equal(found.extra, s.extra)


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


@pytest.mark.usefixtures("either_kernel")
def test_recent_activity_is_a_running_mean_square():
    """Dofs that nothing observes have the table's."""
    plant, notes = singer(MODEL, settings=SingerSettings(activity_memory_s=0.05)), Notes()
    s = random_state(MODEL, np.random.default_rng(7))
    now = s.a**2 + (5.0 * s.v) ** 2
    assert_near(plant.remember(s, notes, None), now, 1e-12 * worst(now))
    before = np.linspace(0.0, 9.0, NV)
    after = before + (1.0 - np.exp(-DT / 0.05)) * (now - before)
    assert_near(plant.remember(s, notes, before), after, 1e-12 * worst(after))
    notes.unobserved = np.array([8])
    assert_near(plant.remember(s, notes, None)[8], (MODEL.movement_sd[8] / 6.0) ** 2, 1e-12)


def test_the_kernel_moves_a_state_as_the_reference_does():
    state = random_state(MODEL, np.random.default_rng(8))
    step = np.random.default_rng(9).normal(size=len(state.P))
    flat = SimpleNamespace(tree=None, integrate=MODEL.integrate)
    found, expected = (state.retracted(model, step, state.P) for model in (MODEL, flat))
    for name in ("q", "v", "a", "w", "extra"):
        assert_near(getattr(found, name), getattr(expected, name), 1e-13 * worst(getattr(expected, name)))
