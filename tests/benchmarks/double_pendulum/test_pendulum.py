"""The pendulum in natural coordinates: thesis eqs. 3.53–3.59; energy, inverse and forward dynamics, points."""

import numpy as np
import pytest

from benchmarks.double_pendulum.pendulum import ROOT, DoublePendulum, PendulumShape
from mbkf.errors import InvalidInput
from mbkf.filters.torque.integrators import INTEGRATORS, Motion
from tests.derivatives import slope

SHAPE = PendulumShape()


def moving(seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=4), 3.0 * rng.normal(size=4), rng


def energy(body, q, v):
    """Of the bars as rigid bodies, without natural coordinates."""
    shape, points, speeds = body.shape, body.points(q), body.velocity_matrix(q) @ v
    total = 0.0
    for mass, k, rate in ((shape.mass_1_kg, 0, v[2]), (shape.mass_2_kg, 2, v[3])):
        middle = 0.5 * (speeds[k : k + 2] + speeds[k + 2 : k + 4])
        height = 0.5 * (points[k + 1] + points[k + 3])
        total += 0.5 * mass * middle @ middle + 0.5 * mass * shape.length_m**2 / 12.0 * rate**2
        total += mass * shape.gravity_m_s2 * height
    return total


@pytest.mark.parametrize("seed", range(3))
def test_printed_velocity_matrix_is_the_derivative_of_the_points(seed):
    body, (q, _, _) = DoublePendulum(SHAPE), moving(seed)
    np.testing.assert_allclose(body.velocity_matrix(q), slope(body.points, q), atol=1e-9)


def test_bars_hang_down_at_zero():
    body = DoublePendulum(PendulumShape(length_m=0.5))
    np.testing.assert_allclose(
        body.points(np.array([1.0, 2.0, 0.0, np.pi / 2])), [1, 2, 1, 1.5, 1.5, 1.5], atol=1e-12
    )


@pytest.mark.parametrize("seed", range(3))
def test_effort_matrix_is_what_virtual_power_says(seed):
    """τ_1 works on the angle between the bars, the plate on point 2 and bar 2, the residual on x_0, y_0, θ_1."""
    body, (q, v, rng) = DoublePendulum(SHAPE), moving(seed)
    u = rng.normal(size=7)
    point_2 = (body.velocity_matrix(q) @ v)[4:]
    power = u[0] * (v[3] - v[2]) + u[1:3] @ point_2 + u[3] * v[3] + u[4:] @ v[:3]
    assert v @ body.effort_matrix(q) @ u == pytest.approx(power)


def test_mass_matrix_is_that_of_the_kinetic_energy():
    body, (q, v, _) = DoublePendulum(SHAPE), moving(0)
    kinetic = energy(body, q, v) - energy(body, q, np.zeros(4))
    assert 0.5 * v @ body.mass_matrix(q) @ v == pytest.approx(kinetic)


@pytest.mark.parametrize("residual", [True, False])
def test_energy_grows_by_the_work_of_the_efforts(residual):
    body, (q, v, rng) = DoublePendulum(SHAPE, residual), moving(1)
    u, h, work = 100.0 * rng.normal(size=body.nu), 1e-4, 0.0
    now = Motion(q, v)
    before = energy(body, q, v)
    for _ in range(200):
        later = INTEGRATORS["RK4"](body, now, u, h)
        power = [one.v @ body.effort_matrix(one.q) @ u for one in (now, later)]
        work, now = work + 0.5 * h * sum(power), later
    assert energy(body, now.q, now.v) - before == pytest.approx(work, rel=1e-6)


def test_falls_freely_without_efforts():
    body, (q, _, _) = DoublePendulum(SHAPE), moving(2)
    np.testing.assert_allclose(body.acceleration(q, np.zeros(4), np.zeros(7)), [0, -9.81, 0, 0], atol=1e-12)


@pytest.mark.parametrize("residual", [True, False])
def test_forward_dynamics_returns_what_inverse_dynamics_was_given(residual):
    body, (q, v, rng) = DoublePendulum(SHAPE, residual), moving(3)
    a = 10.0 * rng.normal(size=4)
    u = body.efforts(q, v, a)
    assert not u[4:].any()
    np.testing.assert_allclose(body.acceleration(q, v, u), a, rtol=1e-11)
    np.testing.assert_allclose(body.effort_matrix(q) @ u, body.inertial(q, v, a).force, rtol=1e-11)


def natural_inertia(shape):
    bar = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    M = np.zeros((3, 3))
    M[:2, :2] += shape.mass_1_kg * bar
    M[1:, 1:] += shape.mass_2_kg * bar
    return np.kron(M, np.eye(2))


@pytest.mark.parametrize("seed", range(3))
def test_derivatives_are_the_thesis_s_formulas(seed):
    """Thesis eqs. 3.42–3.50 with R_z numeric; the last derivative of thesis eq. 3.47 is by ż, so that C = 2 Rᵀ M̄ Ṙ."""
    body, (q, v, rng) = DoublePendulum(SHAPE), moving(seed)
    u = 100.0 * rng.normal(size=7)
    R, M, Bt, M_bar = (
        body.velocity_matrix(q),
        body.mass_matrix(q),
        body.effort_matrix(q),
        natural_inertia(SHAPE),
    )
    weights = np.array([0.0, SHAPE.mass_1_kg, 0.0, SHAPE.mass_1_kg + SHAPE.mass_2_kg, 0.0, SHAPE.mass_2_kg])
    Q_bar = -0.5 * SHAPE.gravity_m_s2 * weights
    R_z = slope(body.velocity_matrix, q)
    R_dot = R_z @ v
    by_z = slope(lambda z: slope(body.velocity_matrix, z, 1e-4) @ v @ v, q, 1e-4)
    inertial = Q_bar - M_bar @ R_dot @ v
    K = -np.einsum("ikj,i->kj", R_z, inertial) + R.T @ M_bar @ by_z
    C = 2.0 * R.T @ M_bar @ R_dot
    half = np.einsum("aij,ab,bk->ikj", R_z, M_bar, R)
    M_z = half + half.transpose(1, 0, 2)
    found = body.linearise(q, v, u)
    np.testing.assert_allclose(M, R.T @ M_bar @ R, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(M @ found.a, R.T @ inertial + Bt @ u, rtol=1e-7, atol=1e-6)
    turned = slope(lambda z: body.effort_matrix(z) @ u, q)
    by_q = np.linalg.solve(M, -(M_z.transpose(0, 2, 1) @ found.a) - (K - turned))
    np.testing.assert_allclose(found.by_q, by_q, atol=1e-6 * np.abs(by_q).max())
    np.testing.assert_allclose(found.by_v, -np.linalg.solve(M, C), atol=1e-6 * np.abs(found.by_v).max())
    np.testing.assert_allclose(found.by_u, np.linalg.solve(M, Bt), rtol=1e-9, atol=1e-12)


def test_root_equations_are_those_without_the_joint_torque():
    body, (q, _, _) = DoublePendulum(SHAPE), moving(4)
    np.testing.assert_array_equal(ROOT @ body.effort_matrix(q)[:, 0], np.zeros(3))
    assert np.linalg.matrix_rank(ROOT) == 3


def test_points_on_bars_lie_between_their_ends():
    body, (q, _, _) = DoublePendulum(SHAPE), moving(5)
    share, bar = np.array([0.0, 0.25, 1.0, 0.25, 1.0]), np.array([1, 1, 1, 2, 2])
    found, ends = body.on_bars(q, share, bar).positions_m.reshape(-1, 2), body.points(q).reshape(-1, 2)
    expected = [ends[0], 0.75 * ends[0] + 0.25 * ends[1], ends[1], 0.75 * ends[1] + 0.25 * ends[2], ends[2]]
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("name", ["mass_1_kg", "length_m", "gravity_m_s2"])
def test_shapes_are_positive(name):
    with pytest.raises(InvalidInput, match=name):
        PendulumShape(**{name: 0.0})
