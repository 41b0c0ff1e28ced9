"""The compressed Kalman update against the textbook forms with dense matrices."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.numerics.information_update import informed, informed_with_rows, positive_informed
from mbkf.numerics.kalman import correct, information, informed_whole
from tests.motions import worst

SILENT = np.zeros((1, 1))
"""Information that says nothing."""


def random_covariance(rng, size):
    A = rng.normal(size=(size, size))
    return A @ A.T / size + 0.05 * np.eye(size)


def random_problem(seed, size=8, observed=5, readings=7, rank=None, scale=1.0):
    """P (N, N), H (m, n) of a given rank, sd (m,) spread over a decade about ``scale``, y (m,)."""
    rng = np.random.default_rng(seed)
    H = rng.normal(size=(readings, observed))
    if rank is not None:
        H = rng.normal(size=(readings, rank)) @ rng.normal(size=(rank, observed))
    sd = scale * 10 ** rng.uniform(-0.5, 0.5, readings)
    return random_covariance(rng, size), H, sd, rng.normal(size=readings)


def textbook(P, H, sd, y):
    """Step, posterior (Joseph form), K H and NIS with K = P Hᵀ (H P Hᵀ + R)⁻¹, H widened to all N components."""
    H = np.hstack([H, np.zeros((len(H), len(P) - H.shape[1]))])
    R = np.diag(sd**2)
    S = H @ P @ H.T + R
    K = np.linalg.solve(S, H @ P).T
    closed = np.eye(len(P)) - K @ H
    return K @ y, closed @ P @ closed.T + K @ R @ K.T, K @ H, y @ np.linalg.solve(S, y)


def assert_is_textbook(problem, tolerance):
    P, H, sd, y = problem
    step, posterior, effect, nis = textbook(P, H, sd, y)
    found = correct(P, information(y, H, sd))
    assert worst(found.step - step) <= tolerance * max(worst(step), 1e-300)
    assert worst(found.covariance - posterior) <= tolerance * worst(P)
    KH = found.covariance[:, : H.shape[1]] @ found.readings.matrix
    assert worst(KH - effect[:, : H.shape[1]]) <= tolerance * max(worst(effect), 1e-300)
    assert found.nis == pytest.approx(nis, rel=tolerance * 10)


@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(0, 6), st.integers(1, 20))
@settings(max_examples=150, deadline=None)
def test_equals_the_textbook_update(seed, observed, hidden, readings):
    assert_is_textbook(random_problem(seed, observed + hidden, observed, readings), 1e-9)


@pytest.mark.parametrize("rank", [1, 2, 4])
@pytest.mark.parametrize("seed", range(5))
def test_equals_the_textbook_update_where_readings_leave_directions_open(seed, rank):
    assert_is_textbook(random_problem(seed, 10, 6, 9, rank), 1e-9)


@pytest.mark.parametrize(("scale", "tolerance"), [(1e-3, 1e-7), (1e-2, 1e-9), (1e2, 1e-10), (1e6, 1e-10)])
@pytest.mark.parametrize("seed", range(5))
def test_equals_the_textbook_update_for_exact_and_for_worthless_readings(seed, scale, tolerance):
    """Readings may be a thousand times better or a million times worse than what is known."""
    assert_is_textbook(random_problem(seed, scale=scale), tolerance)


@pytest.mark.parametrize(("scale", "tolerance"), [(1.0, 1e-12), (1e-2, 1e-10), (1e-4, 1e-6)])
def test_what_an_update_leaves_unexplained(scale, tolerance):
    """y − H x⁺ = R S⁻¹ y, which goes to zero with R: as many exact readings as unknowns solve for the state.

    The step's own rounding is about 1e-16 P / R; a marker's R is 1e-6 of P at worst.
    """
    P, H, sd, y = random_problem(3, 6, 6, 6, scale=scale)
    found = correct(P, information(y, H, sd))
    R = np.diag(sd**2)
    assert worst(y - H @ found.step - R @ np.linalg.solve(H @ P @ H.T + R, y)) < tolerance
    assert np.linalg.eigvalsh(found.covariance).min() > 0


@given(st.integers(0, 10**6))
@settings(max_examples=50, deadline=None)
def test_nis_is_the_normalised_innovation(seed):
    P, H, sd, y = random_problem(seed)
    S = H @ P[:5, :5] @ H.T + np.diag(sd**2)
    assert correct(P, information(y, H, sd)).nis == pytest.approx(y @ np.linalg.inv(S) @ y, rel=1e-9)


@given(st.integers(0, 10**6), st.integers(1, 6))
@settings(max_examples=50, deadline=None)
def test_one_after_the_other_equals_both_at_once(seed, cut):
    P, H, sd, y = random_problem(seed)
    first, second = information(y[:cut], H[:cut], sd[:cut]), information(y[cut:], H[cut:], sd[cut:])
    joint = correct(P, first + second)
    one = correct(P, first)
    left = y[cut:] - H[cut:] @ one.step[:5]
    two = correct(one.covariance, information(left, H[cut:], sd[cut:]))
    np.testing.assert_allclose(one.step + two.step, joint.step, rtol=0, atol=1e-10)
    np.testing.assert_allclose(two.covariance, joint.covariance, rtol=0, atol=1e-10)
    assert one.nis + two.nis == pytest.approx(joint.nis, rel=1e-9)


def test_information_adds_like_stacked_readings():
    _, H, sd, y = random_problem(1)
    whole, parts = (
        information(y, H, sd),
        information(y[:3], H[:3], sd[:3]) + information(y[3:], H[3:], sd[3:]),
    )
    np.testing.assert_allclose(parts.matrix, whole.matrix, rtol=1e-13)
    np.testing.assert_allclose(parts.vector, whole.vector, rtol=1e-12)
    assert parts.innovation == pytest.approx(whole.innovation)
    assert parts.readings == whole.readings == len(y)


@pytest.mark.parametrize("readings", [0, 3])
def test_readings_that_say_nothing_change_nothing(readings):
    P, *_ = random_problem(2)
    found = correct(P, information(np.ones(readings), np.zeros((readings, 5)), np.ones(readings)))
    np.testing.assert_array_equal(found.step, 0.0)
    np.testing.assert_allclose(found.covariance, P, rtol=1e-15)
    assert found.nis == readings


def test_covariance_stays_symmetric_and_positive_over_10_000_steps():
    """A chain of constant-velocity dofs, read with changing noise over six decades and partly not at all."""
    rng = np.random.default_rng(7)
    n, dt = 3, 0.01
    phi = np.block([[np.eye(n), dt * np.eye(n)], [np.zeros((n, n)), np.eye(n)]])
    gain = np.vstack([dt**2 / 2 * np.eye(n), dt * np.eye(n)])
    P = np.diag([1e4] * n + [1e-8] * n)
    for _ in range(10_000):
        P = phi @ P @ phi.T + 10.0**2 * gain @ gain.T
        m = rng.integers(0, 5)
        readings = information(rng.normal(size=m), rng.normal(size=(m, n)), 10 ** rng.uniform(-5, 1, m))
        P = correct(P, readings).covariance
        assert (P == P.T).all()
    assert np.linalg.eigvalsh(P).min() > 0


def test_a_steady_filter_reaches_the_riccati_solution():
    """Constant readings of a random walk: P⁺ solves p² + q p − q r = 0."""
    q, r, P = 0.3, 0.7, np.eye(1)
    for _ in range(200):
        P = correct(P + q, information(np.zeros(1), np.ones((1, 1)), np.array([np.sqrt(r)]))).covariance
    assert P[0, 0] == pytest.approx((-q + np.sqrt(q**2 + 4 * q * r)) / 2, rel=1e-12)


@given(st.integers(0, 10**6), st.integers(0, 8))
@settings(max_examples=50, deadline=None)
def test_reading_components_directly_is_the_textbook_update(seed, readings):
    """One row on each of some components, before any information; exactly symmetric in, exactly symmetric out."""
    rng = np.random.default_rng(seed)
    P = random_covariance(rng, 8)
    P = 0.5 * (P + P.T)
    sd, read = rng.uniform(0.1, 3.0, readings), rng.permutation(8)[:readings]
    H = np.eye(8)[read]
    found = informed_with_rows(P, SILENT, H / sd[:, None])
    S = H @ P @ H.T + np.diag(sd**2)
    np.testing.assert_allclose(found, P - P @ H.T @ np.linalg.inv(S) @ H @ P, rtol=0, atol=1e-13)
    np.testing.assert_array_equal(found, found.T)


@pytest.mark.parametrize("order", ["C", "F"])
def test_covariances_of_either_order_are_left_alone(order):
    P, H, sd, y = random_problem(4)
    P = np.array(0.5 * (P + P.T), order=order)
    kept, matrix = P.copy(), information(y, H, sd).matrix
    found = informed(P, matrix)
    informed_with_rows(P, matrix, np.eye(len(P))[[1, 6, 7]])
    np.testing.assert_array_equal(P, kept)
    np.testing.assert_array_equal(found, found.T)
    np.testing.assert_allclose(found, correct(P, information(y, H, sd)).covariance, rtol=0, atol=1e-15)


def test_information_may_leave_components_out():
    """A row of zeros has no Cholesky factor of its own."""
    P, H, sd, y = random_problem(5)
    H[:, 2] = 0.0
    assert_is_textbook((P, H, sd, y), 1e-9)


def test_a_covariance_that_is_none_is_refused():
    with pytest.raises(np.linalg.LinAlgError, match="not positive"):
        informed(-10.0 * np.eye(4), np.eye(2))


@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(1, 9))
@settings(max_examples=50, deadline=None)
def test_rows_on_the_whole_state_are_the_textbook_update(seed, readings, size):
    """Any number of whitened rows R^(-1/2) H; exactly symmetric in, exactly symmetric out."""
    rng = np.random.default_rng(seed)
    P = random_covariance(rng, size)
    P = 0.5 * (P + P.T)
    rows = rng.normal(size=(readings, size)) * 10 ** rng.uniform(-2, 1, (readings, 1))
    found = informed_with_rows(P, SILENT, rows)
    K = np.linalg.solve(rows @ P @ rows.T + np.eye(readings), rows @ P).T
    np.testing.assert_allclose(found, P - K @ rows @ P, rtol=0, atol=1e-11 * worst(P))
    np.testing.assert_array_equal(found, found.T)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("rank", [None, 2])
def test_information_and_rows_together_are_one_after_the_other(order, rank):
    P, H, sd, y = random_problem(6, size=9, rank=rank)
    P = np.array(0.5 * (P + P.T), order=order)
    kept, rows = P.copy(), np.random.default_rng(6).normal(size=(4, 9))
    matrix = information(y, H, sd).matrix
    found = informed_with_rows(P, matrix, rows)
    one = informed_with_rows(informed(P, matrix), SILENT, rows)
    np.testing.assert_allclose(found, one, rtol=0, atol=1e-13)
    np.testing.assert_array_equal(positive_informed(P, matrix, rows), found)
    whole = informed_whole(P, matrix, rows)
    np.testing.assert_allclose(whole, one, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(whole, whole.T)
    np.testing.assert_array_equal(found, found.T)
    np.testing.assert_array_equal(P, kept)


@pytest.mark.parametrize("update", [informed_with_rows, informed_whole])
def test_without_rows_there_is_only_the_information(update):
    P, H, sd, y = random_problem(7)
    P = 0.5 * (P + P.T)
    matrix = information(y, H, sd).matrix
    np.testing.assert_array_equal(update(P, matrix, np.zeros((0, len(P)))), informed(P, matrix))
