"""Rows of intervals: a cell is judged by the mean of its persons, coverage over all cells."""

import numpy as np

from benchmarks.intervals.cells import cell_rows
from benchmarks.intervals.trials import Judged, Key


def judged(person, nees, cover, motion="walk"):
    return Judged(
        Key(motion, person, 0.003, "static"),
        False,
        (nees,) * 4,
        np.array([cover]),
        np.array([cover]),
        ("knee",),
        2.0,
    )


def value(rows, name):
    return next(row.value for row in rows if row.name == name)


def test_a_cell_is_the_mean_of_its_persons_and_the_mean_that_of_cells():
    rows = cell_rows([judged(0, 0.5, 0.9), judged(1, 1.5, 1.0), judged(0, 3.0, 0.8, "jump")])
    assert value(rows, "causal, NEES of q: walk, skin 3 mm, static, at most") == 1.0
    assert value(rows, "causal, NEES of q, mean, at most") == 2.0
    assert value(rows, "causal, 95 % interval covers angle knee, at least") == 100 * np.mean([0.9, 1.0, 0.8])
    failed = {row.name for row in rows if not row.passed}
    assert "causal, NEES of v: jump, skin 3 mm, static, at most" in failed
    assert not any("walk" in name for name in failed)
