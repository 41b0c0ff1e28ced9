"""Points are linked over time by place and velocity."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.tracklets import link_points
from mbkf.synthesis.cameras import without_labels

RATE_HZ = 100.0


def swarm(frames, points, rng):
    """(T, N, 3) smooth courses, decimetres apart, up to several metres per second."""
    t = np.arange(frames)[:, None] / RATE_HZ
    start = 0.15 * np.arange(points)[:, None] * np.array([1.0, 0.0, 0.0])
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    sway = 0.3 * np.sin(2.0 * np.pi * 2.0 * t + phase)
    return start + sway[:, None] + rng.normal(0.0, 5e-4, (frames, points, 3))


def test_shuffled_points_are_linked_as_they_moved():
    rng = np.random.default_rng(1)
    shown = swarm(80, 12, rng)
    shuffled = without_labels(shown, rng)
    tracklets = link_points(shuffled)
    assert tracklets.count == 12
    for frames, columns in tracklets.pieces:
        owner = [
            np.flatnonzero((shown[t] == shuffled[t, c]).all(axis=1))[0]
            for t, c in zip(frames, columns, strict=True)
        ]
        assert len(set(owner)) == 1
        assert np.array_equal(frames, np.arange(80))


def test_a_crossing_is_passed_by_velocity():
    t = np.arange(60) / RATE_HZ
    one = np.stack([t - 0.3, 0.0075 + 0.0 * t, 0.0 * t], axis=1)
    other = np.stack([0.3 - t, -0.0075 + 0.0 * t, 0.0 * t], axis=1)
    tracklets = link_points(np.stack([one, other], axis=1))
    assert tracklets.count == 2
    assert (tracklets.number == [0, 1]).all()


def test_a_doubtful_link_is_not_made():
    still = np.zeros((10, 2, 3))
    still[:, 1, 0] = 0.3
    still[5:, :, 0] += [0.02, -0.29]  # both land beside the place of the first
    tracklets = link_points(still)
    assert not set(tracklets.number[4]) & set(tracklets.number[5])


def test_gaps_end_a_tracklet():
    shown = swarm(30, 3, np.random.default_rng(0))
    shown[10:12, 1] = np.nan
    tracklets = link_points(shown)
    assert tracklets.count == 4
    assert (tracklets.number[10:12, 1] == HIDDEN).all()
    assert sorted(map(tuple, tracklets.spans)) == [(0, 10), (0, 30), (0, 30), (12, 30)]


def test_labels_of_tracklets_are_those_of_their_points():
    shown = swarm(5, 3, np.random.default_rng(0))
    shown[2:, 2] = np.nan
    tracklets = link_points(shown)
    labels = tracklets.points(np.array([7, HIDDEN, 5]))
    assert labels[0].tolist() == [7, HIDDEN, 5]
    assert labels[3].tolist() == [7, HIDDEN, HIDDEN]
    nothing = link_points(np.full((4, 2, 3), np.nan))
    assert nothing.count == 0
    assert (nothing.points(np.zeros(0, dtype=int)) == HIDDEN).all()


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.integers(1, 12))
def test_every_point_has_one_tracklet_and_every_tracklet_one_point_a_frame(seed, points, frames):
    rng = np.random.default_rng(seed)
    shown = rng.uniform(-0.1, 0.1, (frames, points, 3))
    shown[rng.random((frames, points)) < 0.3] = np.nan
    tracklets = link_points(shown)
    there = ~np.isnan(shown).any(axis=2)
    assert np.array_equal(tracklets.number != HIDDEN, there)
    for row in tracklets.number:
        own = row[row != HIDDEN]
        assert len(own) == len(set(own.tolist()))
    for k, (at, _) in enumerate(tracklets.pieces):
        assert np.array_equal(at, np.arange(*tracklets.spans[k]))
