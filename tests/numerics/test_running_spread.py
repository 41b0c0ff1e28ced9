"""The running spread: a mean of all squares at first, of the last ones later, and unbiased for innovations."""

import numpy as np
import pytest

from mbkf.numerics.running_spread import RunningSpread

FORGET = 0.02


def test_it_is_the_mean_of_all_and_then_forgets():
    squares = np.random.default_rng(0).chisquare(1, size=400)
    spread = RunningSpread(np.zeros(1), np.zeros(1))
    for k, one in enumerate(squares, start=1):
        spread = spread.followed(np.array([one]), np.array([True]), FORGET)
        if k <= 1.0 / FORGET:
            assert spread.mean_square[0] == pytest.approx(squares[:k].mean(), rel=1e-12)
    weights = FORGET * (1.0 - FORGET) ** np.arange(350)[::-1]
    by_hand = weights @ squares[50:] + (1.0 - FORGET) ** 350 * squares[:50].mean()
    assert spread.mean_square[0] == pytest.approx(by_hand, rel=1e-12)


def test_what_is_expected_counts_as_so_many_frames_and_the_unseen_stays():
    spread = RunningSpread(np.array([4.0, 9.0]), np.array([2.0, 2.0]))
    after = spread.followed(np.array([1.0, 0.0]), np.array([True, False]), FORGET)
    np.testing.assert_allclose(after.mean_square, [(2 * 4.0 + 1.0) / 3, 9.0], rtol=1e-15)
    np.testing.assert_array_equal(after.frames, [3.0, 2.0])


def test_it_is_unbiased_for_the_innovations_of_markers_on_a_body():
    """y = H e + r: prior errors e add to each marker's spread; no pose is fitted, so none takes up a part of it."""
    rng, frames = np.random.default_rng(1), 4000
    H, sd = rng.normal(size=(12, 5)), np.repeat([1.0, 2.0, 3.0, 4.0], 3)
    y = rng.normal(size=(frames, 5)) @ H.T + sd * rng.normal(size=(frames, 12))
    expected = ((H**2).sum(axis=1) + sd**2).reshape(4, 3).mean(axis=1)
    spread = RunningSpread(np.ones(4), np.zeros(4))
    for one in (y**2).reshape(frames, 4, 3).mean(axis=2):
        spread = spread.followed(one, np.ones(4, dtype=bool), 0.0)
    np.testing.assert_allclose(spread.mean_square, expected, rtol=0.06)
