"""Rows of stated spreads: pooled over trials, per axis, chosen and shown apart."""

import numpy as np

from benchmarks.strangers.orientation_spreads import _axis


def test_an_axis_is_pooled_over_trials_and_bounded_on_both_sides():
    rows = list(_axis("a", np.array([0.25, 4.0, 1.0]), np.array([100.0, 70.0, 94.0])))
    assert [round(row.value, 4) for row in rows] == [1.3229, 1.3229, 88.0, 88.0, 0.5, 2.0]
    assert [row.passed for row in rows if row.bounded] == [True, False, False, True]
