"""Levenberg–Marquardt with shared unknowns: the arrow step against dense algebra, and fits with known answers."""

import numpy as np
import pytest

from mbkf.numerics.elimination import Border
from mbkf.numerics.levenberg_marquardt import ArrowEquations, minimise


def random_arrow(seed, frames=4, own=3, shared=2):
    """Equations of a random dense problem: all unknowns are (frames · own, shared); returns J, r, equations."""
    rng = np.random.default_rng(seed)
    rows = own + shared + 1
    by_own = rng.normal(size=(frames, rows, own))
    by_shared = rng.normal(size=(frames, rows, shared))
    residual = rng.normal(size=(frames, rows))
    J = np.zeros((frames * rows, frames * own + shared))
    for t in range(frames):
        J[t * rows : (t + 1) * rows, t * own : (t + 1) * own] = by_own[t]
        J[t * rows : (t + 1) * rows, frames * own :] = by_shared[t]
    return J, residual.ravel(), arrow(by_own, by_shared, residual)


def arrow(by_own, by_shared, residual):
    return ArrowEquations(
        frames=np.einsum("tri,trj->tij", by_own, by_own),
        border=Border.plain(np.einsum("tri,trj->tij", by_own, by_shared)),
        corner=np.einsum("tri,trj->ij", by_shared, by_shared),
        frame_gradient=np.einsum("tri,tr->ti", by_own, residual),
        corner_gradient=np.einsum("tri,tr->i", by_shared, residual),
        cost=float((residual**2).sum()),
    )


def flat(step):
    return np.concatenate([step[0].ravel(), step[1]])


@pytest.mark.parametrize("shared", [0, 1, 4])
@pytest.mark.parametrize("damping", [0.0, 1e-3, 10.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_step_is_the_dense_levenberg_marquardt_step(seed, damping, shared):
    J, r, equations = random_arrow(seed, shared=shared)
    H = J.T @ J
    dense = np.linalg.solve(H + damping * np.diag(np.diag(H)), -J.T @ r)
    np.testing.assert_allclose(flat(equations.step(damping)), dense, rtol=0, atol=1e-12)


def test_undamped_step_solves_a_linear_problem_at_once():
    J, r, equations = random_arrow(3)
    np.testing.assert_allclose(flat(equations.step(0.0)), np.linalg.lstsq(J, -r)[0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_schur_complement_is_the_inverse_of_the_shared_block_of_the_covariance(seed):
    J, _, equations = random_arrow(seed, shared=3)
    covariance = np.linalg.inv(J.T @ J)[-3:, -3:]
    np.testing.assert_allclose(np.linalg.inv(equations.schur_complement()), covariance, rtol=1e-10)


def test_a_step_leaves_its_equations_alone():
    _, _, equations = random_arrow(4)
    before = equations.frames.copy(), equations.corner.copy()
    equations.step(1.0)
    np.testing.assert_array_equal(equations.frames, before[0])
    np.testing.assert_array_equal(equations.corner, before[1])


def solve(residuals, jacobian, start, **options):
    """Minimises |r(x)|² of one frame without shared unknowns."""

    def linearise(x):
        r, J = residuals(x), jacobian(x)
        return arrow(J[None], np.zeros((1, len(r), 0)), r[None])

    return minimise(
        np.array(start, float),
        linearise,
        lambda x: float((residuals(x) ** 2).sum()),
        lambda x, own, _: x + own[0],
        **options,
    )


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])


def rosenbrock_jacobian(x):
    return np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


@pytest.mark.parametrize("start", [(-1.2, 1.0), (3.0, -4.0), (-5.0, 20.0)])
def test_rosenbrocks_valley_is_followed_to_its_end(start):
    solution = solve(rosenbrock, rosenbrock_jacobian, start, tolerance=1e-12, max_iterations=200)
    assert solution.converged
    np.testing.assert_allclose(solution.state, [1.0, 1.0], rtol=0, atol=1e-12)


def test_powells_singular_function():
    """The Jacobian is singular at the minimum; the cost still falls to nothing."""

    def residuals(x):
        b, d = x[1] - 2 * x[2], x[0] - x[3]
        return np.array([x[0] + 10 * x[1], 5**0.5 * (x[2] - x[3]), b**2, 10**0.5 * d**2])

    def jacobian(x):
        b, d = 2 * (x[1] - 2 * x[2]), 2 * 10**0.5 * (x[0] - x[3])
        return np.array([[1, 10, 0, 0], [0, 0, 5**0.5, -(5**0.5)], [0, b, -2 * b, 0], [d, 0, 0, -d]])

    solution = solve(residuals, jacobian, (3.0, -1.0, 0.0, 1.0), tolerance=0.0, max_iterations=60)
    assert solution.equations.cost < 1e-20


def test_the_cost_never_rises():
    costs = []

    def noted(x):
        costs.append(float((rosenbrock(x) ** 2).sum()))
        return rosenbrock_jacobian(x)

    solve(rosenbrock, noted, (-1.2, 1.0))
    assert len(costs) > 5
    assert (np.diff(costs) < 0).all()


def test_the_returned_equations_belong_to_the_returned_state():
    solution = solve(rosenbrock, rosenbrock_jacobian, (-1.2, 1.0), max_iterations=3)
    assert solution.equations.cost == pytest.approx(float((rosenbrock(solution.state) ** 2).sum()), rel=1e-14)


def test_running_out_of_iterations_is_reported():
    counted = []
    solution = solve(
        rosenbrock, rosenbrock_jacobian, (-1.2, 1.0), max_iterations=3, on_iteration=counted.append
    )
    assert not solution.converged
    assert solution.iterations == 3
    assert counted == [1, 2, 3]


def test_a_start_at_the_minimum_stays_there():
    solution = solve(lambda x: x - 2.0, lambda x: np.eye(2), (2.0, 2.0))
    assert solution.converged
    np.testing.assert_array_equal(solution.state, [2.0, 2.0])


def curves(seed, noise):
    """Exponentials y = a_t exp(−k x) + c, an amplitude of its own per curve, rate and floor shared."""
    rng = np.random.default_rng(seed)
    x, amplitudes = np.linspace(0, 4, 30), rng.uniform(1, 5, 6)
    k, c = 0.8, 0.3
    y = amplitudes[:, None] * np.exp(-k * x) + c + noise * rng.normal(size=(6, 30))
    return x, y, amplitudes, np.array([k, c])


def fit_curves(x, y):
    def residual(state):
        amplitudes, (k, c) = state
        return amplitudes[:, None] * np.exp(-k * x) + c - y

    def linearise(state):
        amplitudes, (k, _) = state
        decay = np.exp(-k * x)
        by_own = np.broadcast_to(decay, y.shape)[:, :, None]
        by_shared = np.stack([-amplitudes[:, None] * x * decay, np.ones_like(y)], axis=2)
        return arrow(by_own, by_shared, residual(state))

    return minimise(
        (np.ones(6), np.array([0.2, 0.0])),
        linearise,
        lambda s: float((residual(s) ** 2).sum()),
        lambda s, own, shared: (s[0] + own[:, 0], s[1] + shared),
        tolerance=1e-12,
    )


def test_curves_with_shared_parameters_recover_the_truth():
    x, y, amplitudes, shared = curves(1, noise=0.0)
    solution = fit_curves(x, y)
    np.testing.assert_allclose(solution.state[0], amplitudes, rtol=1e-9)
    np.testing.assert_allclose(solution.state[1], shared, rtol=1e-9)


def test_the_schur_complement_gives_the_spread_of_the_shared_parameters():
    """Over many noisy fits the errors of (k, c), divided by their standard errors, have unit variance."""
    noise, normal = 0.02, []
    for seed in range(60):
        x, y, _, shared = curves(seed, noise)
        solution = fit_curves(x, y)
        sd = noise * np.sqrt(np.diag(np.linalg.inv(solution.equations.schur_complement())))
        normal.append((solution.state[1] - shared) / sd)
    variance = (np.array(normal) ** 2).mean()  # 120 degrees of freedom: 1 ± 0.13
    assert 0.65 < variance < 1.4


@pytest.mark.parametrize("beyond", [np.nan, np.inf])
def test_a_step_to_a_cost_that_is_not_finite_is_rejected(beyond):
    """The first steps of √x − 2 from 40 end at x < 0, where the root is not a number."""

    def residuals(x):
        return np.where(x < 0.0, beyond, np.sqrt(np.maximum(x, 0.0)) - 2.0)

    solution = solve(residuals, lambda x: np.diag(0.5 / np.sqrt(x)), (40.0,), tolerance=1e-12)
    assert solution.converged
    np.testing.assert_allclose(solution.state, [4.0], rtol=1e-9)


@pytest.mark.parametrize("cost", [np.nan, np.inf])
def test_a_start_of_a_cost_that_is_not_finite_has_not_converged(cost):
    solution = solve(lambda x: x + cost, lambda x: np.eye(1), (1.0,))
    assert not solution.converged
    np.testing.assert_array_equal(solution.state, [1.0])


@pytest.mark.parametrize("slope", [1.0, np.nan, 0.0])
def test_a_search_without_a_finite_step_has_not_converged(slope):
    """Everywhere but at the start the cost is not a number, or no step follows from the derivatives."""
    solution = solve(lambda x: np.where(x == 3.0, 1.0, np.nan), lambda x: np.full((1, 1), slope), (3.0,))
    assert not solution.converged
    np.testing.assert_array_equal(solution.state, [3.0])
