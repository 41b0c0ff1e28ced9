"""The backward pass against two independent smoothers, on random linear systems with singular noise among them."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.numerics.smoothing import BackwardPass
from mbkf.numerics.transition import DenseTransition
from tests.motions import worst


@dataclass
class Problem:
    """x⁺ = Φ x + G u, y = H x + r with unit u and r; x₀ = m + L z with unit z. The first frame has no readings."""

    m: np.ndarray
    L: np.ndarray
    phi: list
    G: list
    H: list
    y: list


def problem(seed, size, frames, noises, starts):
    rng = np.random.default_rng(seed)
    few = rng.integers(0, size + 1, frames)
    return Problem(
        rng.normal(size=size),
        rng.normal(size=(size, starts)),
        [np.eye(size) + 0.3 * rng.normal(size=(size, size)) for _ in range(frames)],
        [rng.normal(size=(size, noises)) for _ in range(frames)],
        [rng.normal(size=(k, size)) * 10 ** rng.uniform(-1, 1, (k, 1)) for k in few],
        [rng.normal(size=k) for k in few],
    )


def filtered(p):
    """Per frame the prior and posterior mean and covariance, by the textbook."""
    x, P = p.m, p.L @ p.L.T
    passed = [(x, P, x, P)]
    for phi, G, H, y in zip(p.phi, p.G, p.H, p.y, strict=True):
        before, prior = phi @ x, phi @ P @ phi.T + G @ G.T
        K = np.linalg.solve(H @ prior @ H.T + np.eye(len(y)), H @ prior).T
        kept = np.eye(len(x)) - K @ H
        x, P = before + K @ (y - H @ before), kept @ prior @ kept.T + K @ K.T
        passed.append((before, prior, x, P))
    return passed


def bryson_frazier(p, covariances=True):
    passed, back, found = filtered(p), BackwardPass(len(p.m), covariances), []
    for k in range(len(passed) - 1, -1, -1):
        before, _, x, P = passed[k]
        found.append((x + back.step(P), back.covariance(P) if covariances else None))
        if k:
            H, y = p.H[k - 1], p.y[k - 1]
            back.through_readings(P, H.T @ H, H.T @ (y - H @ before))
            back.through_plant(p.phi[k - 1])
    return found[::-1]


def rauch_tung_striebel(p):
    passed = filtered(p)
    x, P = passed[-1][2:]
    found = [(x, P)]
    for (_, _, mean, own), (before, prior, _, _), phi in zip(
        passed[-2::-1], passed[:0:-1], p.phi[::-1], strict=True
    ):
        C = np.linalg.solve(prior, phi @ own).T
        x, P = mean + C @ (x - before), own + C @ (P - prior) @ C.T
        found.append((x, P))
    return found[::-1]


def batch(p):
    """All frames at once as one least-squares problem in the unit numbers (z, u₁ …), singular covariances included."""
    size, starts = p.L.shape
    columns = starts + sum(G.shape[1] for G in p.G)
    mean, by = p.m, np.hstack([p.L, np.zeros((size, columns - starts))])
    states, rows, values, first = [(mean, by)], [np.eye(columns)], [np.zeros(columns)], starts
    for phi, G, H, y in zip(p.phi, p.G, p.H, p.y, strict=True):
        mean, by = phi @ mean, phi @ by
        by[:, first : first + G.shape[1]] += G
        first += G.shape[1]
        states.append((mean, by))
        rows.append(H @ by)
        values.append(y - H @ mean)
    A, b = np.vstack(rows), np.concatenate(values)
    Q, R = np.linalg.qr(A)
    z, root = np.linalg.solve(R, Q.T @ b), np.linalg.inv(R)
    return [(mean + by @ z, (by @ root) @ (by @ root).T) for mean, by in states]


def assert_same(found, expected, tolerance):
    for (x, P), (mean, covariance) in zip(found, expected, strict=True):
        assert worst(x - mean) <= tolerance * max(1.0, worst(mean))
        assert worst(P - covariance) <= tolerance * max(1.0, worst(covariance))


seeds, sizes, lengths = st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 8)


@given(seeds, sizes, lengths)
@settings(max_examples=60, deadline=None)
def test_equals_rauch_tung_striebel(seed, size, frames):
    p = problem(seed, size, frames, size, size)
    assert_same(bryson_frazier(p), rauch_tung_striebel(p), 1e-5)


@given(seeds, sizes, lengths, st.integers(0, 6), st.integers(1, 6))
@settings(max_examples=120, deadline=None)
def test_equals_all_frames_at_once(seed, size, frames, noises, starts):
    """Also with exactly known directions at the start, and noise on few directions or none."""
    p = problem(seed, size, frames, min(noises, size), min(starts, size))
    assert_same(bryson_frazier(p), batch(p), 1e-5)


def test_means_do_not_need_covariances():
    p = problem(3, 5, 8, 2, 4)
    for (x, none), (mean, _) in zip(bryson_frazier(p, covariances=False), bryson_frazier(p), strict=True):
        np.testing.assert_array_equal(x, mean)
        assert none is None
    with pytest.raises(ValueError, match="no covariances"):
        BackwardPass(3, covariances=False).covariance(np.eye(3))


def test_smoothed_covariances_are_symmetric_positive_and_never_larger():
    p = problem(4, 6, 12, 3, 6)
    for (_, P), (_, _, _, own) in zip(bryson_frazier(p), filtered(p), strict=True):
        np.testing.assert_array_equal(P, P.T)
        assert np.linalg.eigvalsh(P).min() > -1e-12 * worst(P)
        assert np.linalg.eigvalsh(own - P).min() > -1e-9 * worst(own)


def test_readings_and_transitions_may_come_by_their_parts():
    """through_frame: information on the first components, and rows, and any form of Φ."""
    rng = np.random.default_rng(5)
    H, rows, P, vector, phi = (rng.normal(size=size) for size in ((4, 3), (2, 5), (5, 5), (5,), (5, 5)))
    whole = rows.T @ rows
    whole[:3, :3] += H.T @ H
    found, expected = BackwardPass(5), BackwardPass(5)
    for _ in range(2):
        step = found.through_frame(P @ P.T, H.T @ H, rows, vector, DenseTransition(phi))
        np.testing.assert_array_equal(step, expected.step(P @ P.T))
        expected.through_readings(P @ P.T, whole, vector)
        expected.through_plant(phi)
    np.testing.assert_array_equal(found.gradient, expected.gradient)
    np.testing.assert_array_equal(found.curvature, expected.curvature)


def test_nothing_comes_after_the_last_frame():
    back = BackwardPass(4)
    np.testing.assert_array_equal(back.step(np.eye(4)), 0.0)
    np.testing.assert_array_equal(back.covariance(2.0 * np.eye(4)), 2.0 * np.eye(4))
