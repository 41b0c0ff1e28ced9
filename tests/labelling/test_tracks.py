"""Columns that are tracks are recognised, shuffled ones are not; points are followed through a capture."""

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.tracks import columns_are_tracks, continuing_columns, link_tracks
from tests.labelling.bodies import reference_sensor
from tests.labelling.movement import RATE_HZ, movement, shuffled

SENSOR = reference_sensor()


def frames(seed=0, points=30):
    rng = np.random.default_rng(seed)
    before = rng.uniform(-1.0, 1.0, (points, 3))
    return rng, before, before + rng.normal(0.0, 0.003, before.shape)


def test_tracks_continue():
    _, before, now = frames()
    assert continuing_columns(before, now).all()


def test_empty_columns_do_not():
    _, before, now = frames()
    before[3], now[5] = np.nan, np.nan
    same = continuing_columns(before, now)
    assert not same[[3, 5]].any()
    assert same.sum() == len(before) - 2


def test_shuffled_columns_do_not():
    rng, before, now = frames()
    order = rng.permutation(len(now))
    assert np.array_equal(continuing_columns(before, now[order]), order == np.arange(len(now)))


def test_no_column_in_common():
    empty = np.full((4, 3), np.nan)
    assert not continuing_columns(empty, np.zeros((4, 3))).any()


def owners(tracks, marker_of_point):
    """For every track the set of markers whose points it holds."""
    found = [set() for _ in range(tracks.count)]
    for t, c in np.argwhere(tracks.number != HIDDEN):
        found[tracks.number[t, c]].add(int(marker_of_point[t, c]))
    return found


@pytest.mark.parametrize("shuffle", [False, True])
def test_tracks_hold_one_marker_each_through_gaps(shuffle):
    rng = np.random.default_rng(3)
    positions = movement(SENSOR, rng)
    columns = np.broadcast_to(np.arange(positions.shape[1]), positions.shape[:2])
    positions[40:46, 5] = np.nan
    if shuffle:
        positions, columns = shuffled(positions, rng)
    tracks = link_tracks(positions, RATE_HZ)
    assert np.array_equal(tracks.number != HIDDEN, ~np.isnan(positions[:, :, 0]))
    held = owners(tracks, columns)
    assert all(len(markers) == 1 for markers in held)
    assert tracks.count <= positions.shape[1] + 2
    assert sum(5 in markers for markers in held) == 1


def test_a_column_that_leaps_is_two_tracks():
    rng = np.random.default_rng(4)
    positions = movement(SENSOR, rng, frames=40)
    positions[15:20, 7] = np.nan
    positions[20:, 7] += [2.0, 0.0, 0.0]
    number = link_tracks(positions, RATE_HZ).number[:, 7]
    assert len(set(number[:15])) == len(set(number[20:])) == 1
    assert number[0] != number[-1]


def test_columns_are_known_for_tracks_or_not():
    rng = np.random.default_rng(5)
    positions = movement(SENSOR, rng, frames=40)
    assert columns_are_tracks(positions)
    assert not columns_are_tracks(shuffled(positions, rng)[0])


def test_positions_and_lives_of_tracks():
    rng = np.random.default_rng(6)
    positions = movement(SENSOR, rng, frames=20)
    positions[5:8, 2] = np.nan
    tracks = link_tracks(positions, RATE_HZ)
    own = tracks.number[0]
    looks = np.array([0, 6, 19])
    assert np.array_equal(tracks.positions(positions, looks)[:, own], positions[looks], equal_nan=True)
    assert np.array_equal(tracks.visible()[own].T, ~np.isnan(positions[:, :, 0]))


def test_nothing_makes_no_tracks():
    assert link_tracks(np.full((5, 3, 3), np.nan), RATE_HZ).count == 0


@pytest.mark.parametrize(("along_m", "tracks"), [(0.09, 1), (-0.05, 2)])
def test_a_point_may_come_back_anywhere_on_the_way_it_was_going_and_not_behind_it(along_m, tracks):
    """At 1 m/s for 0.1 s, beside a point at rest; the two change their columns."""
    frames, gap = 40, 10
    course = np.ones((frames, 2, 3))
    course[:, 0] = np.column_stack([np.arange(frames) / 100.0, np.zeros((frames, 2))])
    course[20 : 20 + gap - 1, 0] = np.nan
    course[20 + gap - 1 :, 0, 0] += course[19, 0, 0] + along_m - course[20 + gap - 1, 0, 0]
    course[::2] = course[::2, ::-1]
    assert not columns_are_tracks(course)
    assert link_tracks(course, 100.0).count == 1 + tracks
