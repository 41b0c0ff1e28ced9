"""The smoother that keeps information is the textbook's (Rauch 1965), forward and backward, for noise of any rank."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.loading import library
from tests.kernel.test_covariance import banded_rows, information
from tests.kernel.test_smoothing import transition, whole
from tests.motions import worst

READINGS = 7


def gentle(rng, nv, orders):
    """A transition that is well taken back."""
    phi = transition(rng, nv, orders)
    A, B = (np.eye(nv) + 0.3 * (one - np.eye(nv)) for one in (phi.A, phi.B))
    return phi._replace(A=A, B=B, rates=0.3 * phi.rates + 0.7 * np.eye(orders))


def noise_of(rng, nv, orders, rest):
    """Share, sd, (N, N) covariance of no full rank and numbers of its components; a dof has no noise."""
    N = (1 + orders) * nv + rest
    share, sd = rng.uniform(0.2, 1.0, orders + 1), rng.uniform(0.1, 1.0, nv)
    sd[0] = 0.0
    active = np.sort(rng.choice(N, rest, replace=False)).astype(np.int32)
    root, D = rng.normal(size=(rest, max(rest - 1, 0))), np.zeros((N, N))
    D[np.ix_(active, active)] = root @ root.T
    return share, sd, D, active


def whole_noise(share, sd, D, nv):
    """(N, N) covariance of all noise."""
    G = np.zeros((len(D), nv))
    for order, one in enumerate(share):
        G[order * nv + np.arange(nv), np.arange(nv)] = one * sd
    return G @ G.T + D


def one_step(kernel, rng, P, d, phi, noise):
    """A frame by the kernel, checked against the textbook; the filtered estimate, and what leads back over it."""
    N, nv = len(P), len(phi.A)
    r, parts = nv + len(noise[3]), (phi.A, phi.B, phi.joints, phi.push, phi.rates)
    offset, added, values = rng.normal(size=N), rng.normal(size=N), rng.normal(size=READINGS)
    matrix, rows, vector = information(rng, nv, nv + 4), banded_rows(rng, READINGS, N), rng.normal(size=nv)
    after, gain, spread, Y = np.empty((N, N)), np.empty((N, r)), np.empty((r, r)), np.linalg.inv(P)
    Y = 0.5 * (Y + Y.T)
    known = matrix, vector, rows, values, added
    failed, y, mean = kernel.information_forward(
        Y, Y @ d, offset, *parts, *noise, *known, after, gain, spread
    )
    assert not failed
    predicted = phi.matrix(N) @ P @ phi.matrix(N).T + whole_noise(*noise[:3], nv)
    prior, total = phi.matrix(N) @ d + offset, values @ rows + added
    total[:nv] += vector
    expected = np.linalg.inv(np.linalg.inv(predicted) + whole(matrix, rows))
    found = prior + expected @ (total - whole(matrix, rows) @ prior)
    sd = np.sqrt(np.diag(expected))
    np.testing.assert_array_equal(after, after.T)
    assert worst((np.linalg.inv(after) - expected) / np.outer(sd, sd)) < 1e-6
    assert worst((np.linalg.solve(after, y) - found) / sd) < 1e-6 * max(1.0, worst(found / sd))
    back = (offset, *parts, noise[0], noise[3], gain, spread, mean)
    return 0.5 * (expected + expected.T), found, (predicted, prior, back)


@pytest.mark.usefixtures("products")
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 28), st.integers(1, 2), st.integers(0, 26))
def test_both_passes_are_the_textbooks(seed, nv, orders, rest):
    kernel, rng, N = library(), np.random.default_rng(seed), (1 + orders) * nv + rest
    P, d, passed = np.diag(rng.uniform(0.5, 2.0, N)), rng.normal(size=N), []
    for _ in range(3):
        phi, noise = gentle(rng, nv, orders), noise_of(rng, nv, orders, rest)
        after, found, (predicted, prior, back) = one_step(kernel, rng, P, d, phi, noise)
        passed.append((P, d, phi.matrix(N), predicted, prior, back))
        P, d = after, found
    S, by_kernel, smoothed = P, P, d
    for filtered, estimate, phi, predicted, prior, back in reversed(passed):
        before = np.empty((N, N))
        failed, step = kernel.information_backward(by_kernel, d, *back, before)
        gain = np.linalg.solve(predicted, phi @ filtered).T
        smoothed = estimate + gain @ (smoothed - prior)
        S = filtered + gain @ (S - predicted) @ gain.T
        sd = np.sqrt(np.diag(S))
        assert not failed
        np.testing.assert_array_equal(before, before.T)
        assert worst((before - S) / np.outer(sd, sd)) < 1e-5
        assert worst((step - smoothed) / sd) < 1e-5 * max(1.0, worst(smoothed / sd))
        by_kernel, d = before, step


def test_a_transition_without_an_inverse_is_refused():
    kernel, rng = library(), np.random.default_rng(1)
    if kernel is None:
        pytest.skip("the kernel is not compiled here")
    phi, noise = transition(rng, 3, 2), noise_of(rng, 3, 2, 2)
    phi.A[0, :] = 0.0
    nothing, matrix, rows = np.zeros(11), np.eye(3), np.zeros((0, 11))
    parts = phi.A, phi.B, phi.joints, phi.push, phi.rates
    known = matrix, np.zeros(3), rows, np.zeros(0), nothing
    room = np.empty((11, 11)), np.empty((11, 5)), np.empty((5, 5))
    assert kernel.information_forward(np.eye(11), nothing, nothing, *parts, *noise, *known, *room)[0] == 1
