"""Columns that are tracks are recognised, shuffled ones are not."""

import numpy as np

from mbkf.labelling.tracks import continued


def frames(seed=0, points=30):
    rng = np.random.default_rng(seed)
    before = rng.uniform(-1.0, 1.0, (points, 3))
    return rng, before, before + rng.normal(0.0, 0.003, before.shape)


def test_tracks_continue():
    _, before, now = frames()
    assert continued(before, now).all()


def test_empty_columns_do_not():
    _, before, now = frames()
    before[3], now[5] = np.nan, np.nan
    same = continued(before, now)
    assert not same[[3, 5]].any()
    assert same.sum() == len(before) - 2


def test_shuffled_columns_do_not():
    rng, before, now = frames()
    order = rng.permutation(len(now))
    assert np.array_equal(continued(before, now[order]), order == np.arange(len(now)))


def test_no_column_in_common():
    empty = np.full((4, 3), np.nan)
    assert not continued(empty, np.zeros((4, 3))).any()
