"""Rows at a constant rate: lost frames are told, and times that do not go by the rate are left."""

import numpy as np

from mbkf.trial.exchange.even_frames import at_rows, even_rows


def test_lost_frames_have_no_row():
    times = 7.3 + np.array([0, 1, 2, 5, 6]) / 120.0
    rows = even_rows(times, 120.0)
    np.testing.assert_array_equal(rows, [0, 1, 2, -1, -1, 3, 4])
    values = at_rows(times, rows)
    np.testing.assert_array_equal(np.isnan(values), rows < 0)
    np.testing.assert_array_equal(values[rows >= 0], times)


def test_without_frames_and_with_times_of_another_rate_rows_stay():
    assert len(even_rows(np.empty(0), 100.0)) == 0
    np.testing.assert_array_equal(even_rows(np.arange(5) / 300.0, 100.0), np.arange(5))
