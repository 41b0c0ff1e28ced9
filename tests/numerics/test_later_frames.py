"""The joined backward pass of a moving window against the pass frame by frame and against all frames at once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.numerics.later_frames import CurvatureTransition, LaterFrames, LinearStep
from mbkf.numerics.smoothing import BackwardPass
from tests.motions import worst
from tests.numerics.test_smoothing import Problem, assert_same, batch, filtered, problem

seeds, sizes, lengths = st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 12)


def steps(p):
    """Those into frames 1, 2 … of a problem, whose frame 0 has no readings."""
    return [
        LinearStep(P, H.T @ H, H.T @ (y - H @ before), phi)
        for (before, _, _, P), H, y, phi in zip(filtered(p)[1:], p.H, p.y, p.phi, strict=True)
    ]


def mild(seed, size, frames):
    """A problem whose readings are as sure as its plant, so that nothing cancels in the textbook's filter."""
    p = problem(seed, size, frames, size, size)
    p.H = [H / np.linalg.norm(H, axis=1, keepdims=True) for H in p.H]
    return p


def cut(p, frames):
    """The problem as it stood when no more than ``frames`` frames after the first were in."""
    return Problem(p.m, p.L, p.phi[:frames], p.G[:frames], p.H[:frames], p.y[:frames])


def lagged(p, lag, covariances=True):
    """Mean and covariance of every frame from the readings of the ``lag`` frames after it, by the moving window."""
    window, found, passed = LaterFrames(covariances), [], filtered(p)
    for t, step in enumerate(steps(p), start=1):
        window.append(step)
        if t - len(found) == lag:
            (_, _, x, P), (correction, covariance) = (
                passed[t - lag],
                window.backward().corrected(passed[t - lag][3]),
            )
            found.append((x + correction, covariance))
            window.drop()
    for _, _, x, P in passed[len(found) :]:
        correction, covariance = (window.backward() or BackwardPass(len(x))).corrected(P)
        found.append((x + correction, covariance))
        if window.backward() is not None:
            window.drop()
    return found


@given(seeds, sizes, lengths, st.integers(1, 8))
@settings(max_examples=60, deadline=None)
def test_a_lag_is_the_least_squares_of_the_readings_until_then(seed, size, frames, lag):
    p = problem(seed, size, frames, size, size)
    exact = [batch(cut(p, min(t + lag, frames)))[t] for t in range(frames + 1)]
    assert_same(lagged(p, lag), exact, 1e-6)


@pytest.mark.parametrize("lag", [1, 2, 5, 8])
def test_a_lag_is_exact_to_rounding(lag):
    p = mild(7, 5, 16)
    exact = [batch(cut(p, min(t + lag, 16)))[t] for t in range(17)]
    assert_same(lagged(p, lag), exact, 1e-9)


@pytest.mark.parametrize("lag", [1, 4, 16])
def test_without_curvature_means_are_the_same_and_covariances_the_filters(lag):
    p = mild(7, 5, 16)
    found, expected = lagged(p, lag, covariances=False), lagged(p, lag)
    for (x, P), (mean, smoothed), (_, _, _, own) in zip(found, expected, filtered(p), strict=True):
        np.testing.assert_array_equal(x, mean)
        np.testing.assert_allclose(P, own, rtol=1e-12, atol=1e-12)
        assert np.linalg.eigvalsh(P - smoothed).min() > -1e-9 * worst(P)


def test_a_lag_of_all_frames_is_the_smoother():
    p = mild(2, 6, 9)
    assert_same(lagged(p, 9), batch(p), 1e-9)


@pytest.mark.parametrize("grouped", [1, 3, 6])
def test_passages_join_in_any_grouping(grouped):
    """What the pass finds frame by frame, from a curvature that is not zero."""
    p, root = mild(5, 4, 7), np.random.default_rng(0).normal(size=(4, 4))
    back = BackwardPass(4)
    back.curvature = root @ root.T
    last = CurvatureTransition(np.zeros((4, 4)), back.curvature)
    for step in reversed(steps(p)):
        back.through_readings(step.P, step.information, step.vector)
        back.through_plant(step.transition)

    def joined(parts):
        total = parts[-1]
        for part in parts[-2::-1]:
            total = total.after(part)
        return total

    parts = [*map(CurvatureTransition.over, steps(p)), last]
    total = joined([joined(parts[:grouped]), joined(parts[grouped:])])
    assert worst(total.curvature - back.curvature) < 1e-10 * worst(back.curvature)


@pytest.mark.parametrize("covariances", [True, False])
def test_an_empty_window_tells_nothing(covariances):
    window = LaterFrames(covariances)
    assert window.backward() is None
    window.append(steps(problem(1, 3, 1, 3, 3))[0])
    assert window.backward() is not None
    window.drop()
    assert window.backward() is None
