"""The joined backward pass of a moving window against the pass frame by frame and against all frames at once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.numerics.passage import Passage, PassageWindow
from mbkf.numerics.smoothing import BackwardPass
from tests.motions import worst
from tests.numerics.test_smoothing import Problem, assert_same, batch, filtered, problem

seeds, sizes, lengths = st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 12)


def passages(p):
    """Those over frames 1, 2 … of a problem, whose frame 0 has no readings."""
    return [
        Passage.over(P, H.T @ H, H.T @ (y - H @ before), phi)
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


def lagged(p, lag):
    """Mean and covariance of every frame from the readings of the ``lag`` frames after it, by the moving window."""
    window, found, passed = PassageWindow(), [], filtered(p)
    for t, passage in enumerate(passages(p), start=1):
        window.append(passage)
        if len(window) == lag:
            back, (_, _, x, P) = window.told(), passed[t - lag]
            found.append((x + back.step(P), back.covariance(P)))
            window.drop()
    for _, _, x, P in passed[len(found) :]:
        back = window.told() or BackwardPass(len(x))
        found.append((x + back.step(P), back.covariance(P)))
        if len(window):
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


def test_a_lag_of_all_frames_is_the_smoother():
    p = mild(2, 6, 9)
    assert_same(lagged(p, 9), batch(p), 1e-9)


@pytest.mark.parametrize("grouped", [1, 3, 6])
def test_passages_join_in_any_grouping(grouped):
    """What the pass finds frame by frame, from a gradient and curvature that are not zero."""
    p, rng = problem(5, 4, 7, 4, 4), np.random.default_rng(0)
    root = rng.normal(size=(4, 4))
    back = BackwardPass(4)
    back.gradient, back.curvature = rng.normal(size=4), root @ root.T
    last = Passage(np.zeros((4, 4)), back.gradient, back.curvature)
    for (before, _, _, P), H, y, phi in list(zip(filtered(p)[1:], p.H, p.y, p.phi, strict=True))[::-1]:
        back.through_readings(P, H.T @ H, H.T @ (y - H @ before))
        back.through_plant(phi)

    def joined(parts):
        total = parts[-1]
        for part in parts[-2::-1]:
            total = total.after(part)
        return total

    parts = [*passages(p), last]
    total = joined([joined(parts[:grouped]), joined(parts[grouped:])])
    assert worst(total.gradient - back.gradient) < 1e-10 * worst(back.gradient)
    assert worst(total.curvature - back.curvature) < 1e-10 * worst(back.curvature)


def test_a_frame_without_motion_and_readings_passes_everything_on():
    one = passages(problem(1, 3, 1, 3, 3))[0]
    for joined in (one.after(Passage.nothing(3)), Passage.nothing(3).after(one)):
        for mine, other in zip(joined, one, strict=True):
            np.testing.assert_allclose(mine, other, atol=1e-15)


def test_an_empty_window_tells_nothing():
    window = PassageWindow()
    assert window.told() is None
    window.append(passages(problem(1, 3, 1, 3, 3))[0])
    assert window.told() is not None and len(window) == 1
    window.drop()
    assert window.told() is None and len(window) == 0
