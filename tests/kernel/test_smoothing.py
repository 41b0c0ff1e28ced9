"""The backward pass by parts is the one by whole matrices, with the kernel and without it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.smoothing import LinearReadings, SparseBackwardPass, linear_step
from mbkf.numerics.smoothing import BackwardPass
from mbkf.numerics.transition import DenseTransition, RateTransition
from tests.kernel.test_covariance import banded_rows, covariance, information
from tests.motions import worst


def transition(rng, nv, orders):
    """Joints of one to three dofs, near the identity."""
    joints, first = [], 0
    while first < nv:
        joints.append((first, min(first + int(rng.integers(1, 4)), nv)))
        first = joints[-1][1]
    A, B = np.eye(nv), np.eye(nv)
    for start, end in joints:
        own, dofs = slice(start, end), end - start
        A[own, own] += 0.3 * rng.normal(size=(dofs, dofs))
        B[own, own] += 0.3 * rng.normal(size=(dofs, dofs))
    rates = np.triu(rng.uniform(0.1, 1.0, (orders, orders)))
    return RateTransition(A, B, np.array(joints, dtype=np.int32), rng.uniform(0.0, 1.0, orders), rates)


def posterior(prior, matrix, rows):
    """(N, N) after readings, in scaled components, by the textbook's formula that needs no inverse of the prior."""
    scale = np.sqrt(np.where(np.diag(prior) > 0.0, np.diag(prior), 1.0))
    C, L = prior / scale / scale[:, None], whole(matrix, rows) * scale * scale[:, None]
    found = (C - C @ np.linalg.solve(np.eye(len(C)) + L @ C, L @ C)) * scale * scale[:, None]
    return 0.5 * (found + found.T)


def filtered(rng, frames, nv, orders, rest, readings, held=False):
    """From the last frame to the first: posterior covariance, readings by their parts, transition into the frame.

    With ``held``, the first dof, which moves on its own, and half of the components after the rates are certain.
    """
    N = (1 + orders) * nv + rest
    n, P, passed = nv + int(rng.integers(0, N - nv + 1)), covariance(rng, N), []
    certain = np.zeros(N, dtype=bool)
    if held:
        certain[: (1 + orders) * nv : nv], certain[(1 + orders) * nv :: 2] = True, True
    for _ in range(frames):
        matrix, rows = information(rng, n, n + 4), banded_rows(rng, readings, N)
        phi = transition(rng, nv, orders)
        if held:
            phi.A[0], phi.A[:, 0], phi.B[0], phi.B[:, 0] = np.eye(nv)[[0, 0, 0, 0]]
        P[certain] = P[:, certain] = 0.0
        moved = phi.matrix(N) @ P @ phi.matrix(N).T
        P = posterior(moved + np.diag(np.where(certain, 0.0, rng.uniform(0.0, 1.0, N))), matrix, rows)
        passed.append((P, matrix, rows, rng.normal(size=N), phi))
    return passed[::-1]


def whole(matrix, rows):
    information = rows.T @ rows
    information[: len(matrix), : len(matrix)] += matrix
    return information


def assert_follows(frames, tolerance, covariances=True, last_asked=0):
    """Both passes tell the same of every frame, from the last to the first; spreads in units of the filter's.

    Covariances are asked for from frame ``last_asked`` on, the last one being 0.
    """
    N = len(frames[0][0])
    by_parts, by_matrices = SparseBackwardPass(N, covariances), BackwardPass(N, covariances)
    for k, (P, matrix, rows, vector, phi) in enumerate(frames):
        certain = np.diag(P) == 0.0
        scale = np.sqrt(np.where(certain, 1.0, np.diag(P)))
        expected_step = by_matrices.step(P)
        assert worst((by_parts.step(P) - expected_step) / scale) <= tolerance
        if covariances and k >= last_asked:
            found, expected = by_parts.covariance(P), by_matrices.covariance(P)
            np.testing.assert_array_equal(found, found.T)
            assert worst((found - expected) / np.outer(scale, scale)) <= tolerance
        step = by_parts.through_frame(P, matrix, rows, vector, phi)
        assert worst((step - expected_step) / scale) <= tolerance
        by_matrices.through_readings(P, whole(matrix, rows), vector)
        by_matrices.through_plant(phi.matrix(N))
        assert worst(by_parts.gradient - by_matrices.gradient) <= tolerance * worst(by_matrices.gradient)
        if covariances:
            counts = np.ix_(~certain, ~certain)
            difference = worst((by_parts.curvature - by_matrices.curvature)[counts])
            assert difference <= tolerance * worst(by_matrices.curvature)


@pytest.mark.usefixtures("products")
@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 10**6),
    st.integers(2, 20),
    st.integers(1, 2),
    st.integers(0, 14),
    st.integers(0, 12),
    st.booleans(),
    st.integers(0, 2),
)
def test_parts_are_whole_matrices(seed, nv, orders, rest, readings, held, last_asked):
    """Any sizes: those of tiles, less and more; components that are certain count nowhere.

    Covariances of later frames may not be asked for.
    """
    rng = np.random.default_rng(seed)
    assert_follows(filtered(rng, 3, nv, orders, rest, readings, held), 1e-5, last_asked=last_asked)


@pytest.mark.parametrize("covariances", [True, False])
def test_with_the_kernel_and_without_it(either_kernel, covariances):
    rng = np.random.default_rng(8)
    frames = filtered(rng, 4, 9, 2, 12, 7)
    for last_asked in (0, 3):
        assert_follows(frames, 1e-8, covariances, last_asked)


@pytest.mark.parametrize("covariances", [True, False])
def test_a_dense_transition_is_taken_as_a_matrix(either_kernel, covariances):
    frames = filtered(np.random.default_rng(7), 4, 9, 2, 12, 7)
    dense = [(*known, DenseTransition(phi.matrix(len(known[0])))) for *known, phi in frames]
    assert_follows(dense, 1e-8, covariances)


def test_a_covariance_is_that_of_the_frame_asked_for(either_kernel):
    """What is kept of one frame is not told of another."""
    rng = np.random.default_rng(9)
    one, other = filtered(rng, 2, 4, 2, 3, 5)
    back = SparseBackwardPass(15)
    back.through_frame(*one)
    for P in (one[0], other[0], one[0]):
        np.testing.assert_allclose(back.covariance(P), BackwardPass.covariance(back, P), atol=1e-9 * worst(P))
    with pytest.raises(ValueError, match="no covariances"):
        SparseBackwardPass(15, covariances=False).covariance(one[0])


@pytest.mark.usefixtures("products")
@pytest.mark.parametrize("others", [0, 2])
def test_a_configuration_may_be_certain_altogether(others):
    P, matrix, rows, vector, phi = filtered(np.random.default_rng(3), 1, 4, 2, 6, 5)[0]
    certain = len(P) - others
    assert certain >= len(matrix) > 0
    P[:certain] = P[:, :certain] = 0.0
    by_parts, by_matrices = SparseBackwardPass(len(P)), BackwardPass(len(P))
    for back in (by_parts, by_matrices):
        for _ in range(2):
            back.through_frame(P, matrix, rows, vector, phi)
    difference = by_parts.curvature - by_matrices.curvature
    assert worst(difference) <= 1e-9 * worst(by_matrices.curvature)


@pytest.mark.parametrize("is_dense", [False, True])
@pytest.mark.parametrize(("n", "readings", "adds"), [(9, 7, False), (20, 4, True), (39, 0, True)])
def test_a_linear_step_is_that_of_whole_matrices(either_kernel, is_dense, n, readings, adds):
    rng = np.random.default_rng(12)
    N, phi = 39, transition(rng, 9, 2)
    P, matrix, rows = covariance(rng, N), information(rng, n, n + 4), banded_rows(rng, readings, N)
    before, offset, added = rng.normal(size=(3, N))
    vector, values = rng.normal(size=n), rng.normal(size=readings)
    moved, gradient = phi.matrix(N) @ before + offset, values @ rows
    gradient[:n] += vector
    gradient += (added if adds else 0.0) - whole(matrix, rows) @ moved
    known = LinearReadings(matrix, vector, rows, values, added if adds else None)
    found = linear_step(P, before, offset, known, DenseTransition(phi.matrix(N)) if is_dense else phi)
    np.testing.assert_allclose(found[0], gradient, rtol=0.0, atol=1e-12 * worst(gradient))
    np.testing.assert_allclose(found[1], moved + P @ gradient, rtol=0.0, atol=1e-12 * worst(P @ gradient))
