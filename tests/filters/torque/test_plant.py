"""The torque plant: F along the manifold, the linear case against the exact Kalman filter, sub-steps."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from benchmarks.double_pendulum.forced_bodies import WithIdleStates
from mbkf.filters.torque.integrators import INTEGRATORS, Motion
from mbkf.filters.torque.noise import ForceNoise
from mbkf.filters.torque.plant import ForcedState, Scheme, TorquePlant
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.model.human_dynamics import FORCE_STATES, HumanDynamics
from mbkf.numerics.discretisation import COVARIANCES, PROPAGATIONS
from mbkf.numerics.kalman import correct, information
from tests.forced_bodies import Cart, DampedPendulum
from tests.motions import assert_near, moderate_pose, random_model, worst

DT = 0.01


def density_of(body, forces=4.0):
    n = 2 * body.nv + body.nu
    density = np.zeros((n, n))
    density[2 * body.nv :, 2 * body.nv :] = forces * np.eye(body.nu)
    return density


def plant_of(body, **scheme):
    return TorquePlant(body, DT, lambda _: density_of(body), Scheme(**scheme))


def corrected(plant, prior, readings):
    found = correct(prior.P, readings)
    return plant.retract(prior, found.step, found.covariance)


def loaded_body(force_state, seed=3):
    """The whole body moving under torques and reactions."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    body = HumanDynamics(model, force_state=force_state)
    q, v = moderate_pose(model, rng), 2.0 * rng.normal(size=model.nv)
    a = np.where(body.kinematic, 0.0, 5.0 * rng.normal(size=model.nv))
    wrench = rng.normal(size=(2, 6)) * np.array([50.0, 50.0, 300.0, 30.0, 30.0, 10.0])
    return body, Motion(q, v), body.forces(q, v, a, wrench)


def flow_derivative(body, now, u, h, eps=1e-6):
    """(2 nv, n) derivative of an exact step of length h by (q, v, u), by central differences."""
    nv, centre = body.nv, INTEGRATORS["RK4"](body, now, u, h)
    columns = []
    for e in np.eye(2 * nv + body.nu):
        scale = eps * np.where(np.arange(len(e)) < 2 * nv, 1.0, 100.0) @ e
        ends = [
            INTEGRATORS["RK4"](
                body,
                Motion(body.integrate(now.q, s * scale * e[:nv]), now.v + s * scale * e[nv : 2 * nv]),
                u + s * scale * e[2 * nv :],
                h,
            )
            for s in (1.0, -1.0)
        ]
        q = [body.difference(centre.q, end.q) for end in ends]
        columns.append(np.concatenate([q[0] - q[1], ends[0].v - ends[1].v]) / (2.0 * scale))
    return np.stack(columns, axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("force_state", FORCE_STATES)
def test_sensitivity_is_the_rate_of_errors_along_the_manifold(force_state):
    body, now, u = loaded_body(force_state)
    F = plant_of(body).sensitivity(now.v, body.linearise(now.q, now.v, u))

    def rate(h):
        forth, back = (flow_derivative(body, now, u, s * h) for s in (1.0, -1.0))
        return (forth - back) / (2.0 * h)

    numeric = (4.0 * rate(1e-4) - rate(2e-4)) / 3.0
    scale = np.maximum(np.abs(F[: 2 * body.nv]).max(axis=1, keepdims=True), 1.0)
    assert worst((numeric - F[: 2 * body.nv]) / scale) < 1e-5
    assert not F[2 * body.nv :].any()


def test_exact_propagation_is_the_derivative_of_a_step():
    """With F averaged over the step, exp(F Δt) is Φ to second order in Δt."""
    body, now, u = loaded_body("inertial")
    state = ForcedState(now.q, now.v, u, np.zeros((2 * body.nv + body.nu,) * 2))
    errors = []
    for dt in (0.008, 0.004):
        plant = TorquePlant(body, dt, lambda _: density_of(body), Scheme("RK4", mean_slope=True))
        phi = plant.predict(state).phi[: 2 * body.nv]
        numeric = flow_derivative(body, now, u, dt)
        scale = np.maximum(np.abs(numeric).max(axis=1, keepdims=True), 1.0)
        errors.append(worst((phi - numeric) / scale))
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 4.0


def test_simplified_sensitivity_keeps_only_what_forces_do():
    """Thesis eq. 4.15; the turning of the tangent space is kinematics and stays."""
    body, now, u = loaded_body("torque")
    nv, slope = body.nv, body.linearise(now.q, now.v, u)
    F = plant_of(body, complete=False).sensitivity(now.v, slope)
    np.testing.assert_array_equal(F[:nv, :nv], body.transport(now.v))
    np.testing.assert_array_equal(F[:nv, nv : 2 * nv], np.eye(nv))
    np.testing.assert_array_equal(F[nv : 2 * nv, 2 * nv :], slope.by_u)
    assert not F[nv : 2 * nv, : 2 * nv].any()
    pendulum = DampedPendulum()
    F = plant_of(pendulum, complete=False).sensitivity(
        np.array([2.0]), pendulum.linearise(np.array([0.4]), np.array([2.0]), np.array([1.0]))
    )
    np.testing.assert_array_equal(F, [[0, 1, 0], [0, 0, 1], [0, 0, 0]])


def cart_matrices(noise=4.0):
    """Φ and Q of two carts in closed form."""
    m, one, none = np.diag(1 / Cart.mass), np.eye(2), np.zeros((2, 2))
    phi = np.block([[one, DT * one, DT**2 / 2 * m], [none, one, DT * m], [none, none, one]])
    gain = np.vstack([m * DT**2 / 2, m * DT, one])
    powers = [np.vstack([m, none, none]) / 2, np.vstack([none, m, none]), np.vstack([none, none, one])]
    noise_matrix = sum(
        powers[i] @ powers[j].T * DT ** (5 - i - j) / (5 - i - j) for i in range(3) for j in range(3)
    )
    assert gain.shape == (6, 2)
    return phi, noise * noise_matrix


@pytest.mark.parametrize("name", ["HE", "TF", "TN", "RK4"])
def test_linear_body_is_the_exact_kalman_filter(name):
    """Constant forces, no stiffness: every integrator above Euler and the exponential are exact."""
    rng, body = np.random.default_rng(4), Cart()
    plant, (phi, noise) = plant_of(body, integrator=name), cart_matrices()
    A = rng.normal(size=(6, 6))
    x, P = rng.normal(size=6), A @ A.T
    state = ForcedState(x[:2], x[2:4], x[4:], P)
    H, sd = rng.normal(size=(4, 6)), np.array([0.1, 0.2, 0.05, 1.0])
    for _ in range(20):
        x, P = phi @ x, phi @ P @ phi.T + noise
        y = rng.normal(size=4)
        K = np.linalg.solve(H @ P @ H.T + np.diag(sd**2), H @ P).T
        x, P = x + K @ (y - H @ x), (np.eye(6) - K @ H) @ P
        prior = plant.predict(state)
        seen = np.concatenate([prior.q, prior.v, prior.u])
        state = corrected(plant, prior, information(y - H @ seen, H, sd))
    assert_near(np.concatenate([state.q, state.v, state.u]), x, 1e-9)
    assert_near(state.P, P, 1e-9)


@pytest.mark.parametrize("covariance", COVARIANCES)
@pytest.mark.parametrize("propagation", PROPAGATIONS)
def test_sub_steps_compose(propagation, covariance):
    """Many sub-steps of any scheme come to the exact one; for the linear body Van Loan needs only one."""
    body = Cart()
    state = ForcedState(np.ones(2), np.ones(2), np.ones(2), np.eye(6))
    exact = plant_of(body, integrator="TN").predict(state)
    found = plant_of(body, integrator="TN", propagation=propagation, covariance=covariance, substeps=40)
    fine = found.predict(state)
    coarse = replace(found.scheme, substeps=1)
    rough = TorquePlant(body, DT, found.density, coarse).predict(state)
    assert worst(fine.phi - exact.phi) <= worst(rough.phi - exact.phi) / 30 + 1e-13
    assert worst(fine.P - exact.P) <= worst(rough.P - exact.P) / 30 + 1e-12


@pytest.mark.parametrize("substeps", [1, 3])
def test_fading_states_settle_at_their_stationary_spread(substeps):
    """An idle state with drift −λ is a Gauss–Markov process: mean e^(−λt), variance σ²/2λ; the body feels nothing."""
    rate, noise, body = 4.0, 3.0, WithIdleStates(DampedPendulum(), 1)
    density = np.diag([0.0, 0.0, 0.0, noise**2])
    scheme = Scheme("TN", substeps=substeps)
    plant = TorquePlant(body, DT, lambda _: density, scheme, np.diag([0.0, -rate]))
    state = ForcedState(
        np.array([0.3]), np.array([0.5]), np.array([2.0, 5.0]), np.diag([1e-4, 1e-4, 1.0, 0.0])
    )
    alone = TorquePlant(DampedPendulum(), DT, lambda _: np.zeros((3, 3)), scheme)
    other = ForcedState(state.q, state.v, state.u[:1], state.P[:3, :3])
    for _ in range(200):
        state, other = plant.predict(state), alone.predict(other)
    assert state.u[0] == 2.0
    assert state.u[1] == pytest.approx(5.0 * np.exp(-rate * 200 * DT), rel=1e-9)
    assert state.P[3, 3] == pytest.approx(noise**2 / (2 * rate), rel=1e-6)
    assert_near(np.concatenate([state.q, state.v]), np.concatenate([other.q, other.v]), 1e-12)
    assert_near(state.P[:3, :3], other.P, 1e-9)


def test_prediction_keeps_forces_and_returns_its_transition():
    body, now, u = loaded_body("inertial")
    A = 1e-3 * np.random.default_rng(5).normal(size=(2 * body.nv + body.nu,) * 2)
    state = ForcedState(now.q, now.v, u, A @ A.T)
    found = plant_of(body).predict(state)
    np.testing.assert_array_equal(found.u, u)
    added = found.P - found.phi @ state.P @ found.phi.T
    assert np.linalg.eigvalsh(0.5 * (added + added.T)).min() > -1e-9 * worst(added)
    np.testing.assert_array_equal(found.P, found.P.T)


@pytest.mark.slow
def test_covariance_is_what_the_errors_are():
    """A pendulum whose torque really wanders: mean squared normalised error near 3, its dimension."""
    rng, body, force_sd, angle_sd = np.random.default_rng(6), DampedPendulum(), 8.0, 0.01
    plant = TorquePlant(body, DT, lambda _: np.diag([0.0, 0.0, force_sd**2]), Scheme("RK4", mean_slope=True))
    P, H, fine, nees = np.diag([0.01, 0.3, 2.0]) ** 2, np.array([[1.0, 0.0, 0.0]]), 10, []
    for _ in range(12):
        x = np.array([0.5, 0.0, 4.0])
        start = x + np.sqrt(np.diag(P)) * rng.normal(size=3)
        state = ForcedState(start[:1], start[1:2], start[2:], P)
        for _ in range(60):
            for _ in range(fine):
                moved = INTEGRATORS["RK4"](body, Motion(x[:1], x[1:2]), x[2:], DT / fine)
                wander = force_sd * np.sqrt(DT / fine) * rng.normal()
                x = np.array([moved.q[0], moved.v[0], x[2] + wander])
            prior = plant.predict(state)
            y = x[:1] + angle_sd * rng.normal(size=1) - prior.q
            state = corrected(plant, prior, information(y, H, np.array([angle_sd])))
            error = x - np.concatenate([state.q, state.v, state.u])
            nees.append(error @ np.linalg.solve(state.P, error))
    assert np.mean(nees) == pytest.approx(3.0, abs=0.6)


def test_a_state_and_its_tangent_vector():
    """Difference undoes retraction; wrenches are the end of the forces."""
    body, now, u = loaded_body("inertial")
    plant, nv = TorquePlant(body, DT, lambda _: density_of(body), Scheme(), wrenches=True), body.nv
    state = ForcedState(now.q, now.v, u, np.eye(plant.layout.size))
    step = 0.1 * np.random.default_rng(7).normal(size=plant.layout.size)
    moved = plant.retract(state, step, 2.0 * state.P)
    assert_near(plant.difference(state, moved), step, 1e-9)
    np.testing.assert_array_equal(moved.P, 2.0 * state.P)
    layout = plant.layout
    assert (layout.q, layout.v, layout["u"]) == (slice(0, nv), slice(nv, 2 * nv), slice(2 * nv, layout.size))
    assert layout.wrench == slice(layout.size - 12, layout.size)
    assert "wrench" not in plant_of(Cart()).layout


def test_the_transition_is_that_of_the_prediction():
    body, now, u = loaded_body("inertial")
    state = ForcedState(now.q, now.v, u, np.eye(2 * body.nv + body.nu))
    plant = plant_of(body)
    np.testing.assert_array_equal(
        plant.transition(state), plant.predict(state, plant.noise(plant.begin())).phi
    )


SCHEMES = [
    (integrator, propagation, covariance, complete)
    for integrator, (propagation, covariance), complete in product(
        ("FE", "TN"), product(PROPAGATIONS, COVARIANCES), (True, False)
    )
] + [(name, "second", "series", False) for name in ("HE", "TF", "RK4")]


@pytest.mark.parametrize("force_state", FORCE_STATES)
def test_blocks_and_the_kernel_predict_what_the_textbook_s_form_does(force_state):
    """Every scheme, with noise as the filter has it; entries of P against the deviations of both."""
    body, now, u = loaded_body(force_state)
    plain = HumanDynamics(body.model, force_state=force_state)
    plain.compiled = None
    noises = [ForceNoise(one, DT, TorqueSettings(force_state=force_state)) for one in (body, plain)]
    A = 1e-2 * np.random.default_rng(5).normal(size=(2 * body.nv + body.nu,) * 2)
    state = ForcedState(now.q, now.v, u, A @ A.T)
    for integrator, propagation, covariance, complete in SCHEMES:
        scheme = Scheme(
            integrator, propagation, covariance, complete, mean_slope=integrator == "TN", substeps=2
        )
        found, expected = (
            TorquePlant(one, DT, noise, scheme).predict(state)
            for one, noise in zip((body, plain), noises, strict=True)
        )
        assert_near(found.q, expected.q, 1e-11)
        assert worst(found.v - expected.v) < 1e-10 * worst(expected.v)
        scale = np.maximum(np.abs(expected.phi).max(axis=1, keepdims=True), 1.0)
        assert worst((found.phi - expected.phi) / scale) < 1e-10
        sd = np.sqrt(np.diag(expected.P))
        assert worst((found.P - expected.P) / np.outer(sd, sd)) < 1e-9
        np.testing.assert_array_equal(found.P, found.P.T)
