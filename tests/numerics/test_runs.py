"""Runs of a mask cover exactly its true samples; spread indices are even, different and within the sequence."""

from itertools import pairwise

import numpy as np
import pytest

from mbkf.numerics.runs import runs, spread_indices, stretches


def test_runs_at_the_ends_and_between():
    assert runs(np.array([False, True, True, False, False, True])) == [(1, 3), (5, 6)]
    assert runs(np.ones(4, dtype=bool)) == [(0, 4)]
    assert runs(np.zeros(4, dtype=bool)) == runs(np.zeros(0, dtype=bool)) == []


@pytest.mark.parametrize(
    ("mask", "count"),
    [([], 0), ([0, 0], 0), ([1], 1), ([1, 1, 0, 1], 2), ([0, 1, 0, 1, 0, 1, 1], 3), ([1, 0, 0, 1], 2)],
)
def test_number_of_runs(mask, count):
    assert len(runs(np.array(mask, dtype=bool))) == count


@pytest.mark.parametrize("seed", range(3))
def test_runs_cover_the_true_samples_and_never_touch(seed):
    mask = np.random.default_rng(seed).random(200) < 0.6
    found = runs(mask)
    again = np.zeros_like(mask)
    for first, end in found:
        assert first < end
        again[first:end] = True
    np.testing.assert_array_equal(again, mask)
    assert all(end < first for (_, end), (first, _) in pairwise(found))


@pytest.mark.parametrize(("length", "most"), [(1000, 60), (61, 60), (5, 60), (1, 3)])
def test_spread_indices_reach_from_first_to_last(length, most):
    found = spread_indices(length, most)
    assert len(found) == min(length, most)
    assert (found[0], found[-1]) == (0, length - 1)
    assert np.ptp(np.diff(found)) <= 1 if len(found) > 2 else True


def test_nothing_is_spread_over_an_empty_sequence():
    assert len(spread_indices(0, 10)) == 0
    assert len(spread_indices(1, 10, first=1)) == 0
    assert spread_indices(3, 10, first=1).tolist() == [1, 2]


def test_stretches_are_the_unbroken_runs():
    mask = np.array([1, 1, 0, 0, 1, 0, 1, 1, 1], bool)
    assert [run.tolist() for run in stretches(mask)] == [[0, 1], [4], [6, 7, 8]]
    assert stretches(np.zeros(3, bool)) == []
    assert [run.tolist() for run in stretches(np.ones(2, bool))] == [[0, 1]]
