"""Tracks named as wholes by a body that follows from the tracks named before."""

import numpy as np

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.naming import name_tracks, trajectories
from mbkf.labelling.tracks import link_tracks
from tests.labelling.bodies import reference_sensor
from tests.labelling.movement import RATE_HZ, movement, shuffled

SENSOR = reference_sensor()
SD = np.full(len(SENSOR.segments), 0.012)


def scene(seed=0, gap=None, extra=0):
    rng = np.random.default_rng(seed)
    positions = movement(SENSOR, rng, frames=90)
    if gap is not None:
        positions[30:70, gap] = np.nan
    ghosts = rng.uniform(-1.0, 1.0, (extra, 3)) + np.cumsum(rng.normal(0.0, 0.005, (90, extra, 3)), axis=0)
    whole, marker = shuffled(np.concatenate([positions, ghosts], axis=1), rng)
    marker = np.where(marker < len(SD), marker, HIDDEN)
    tracks = link_tracks(whole, RATE_HZ)
    truth = np.full(tracks.count, HIDDEN)
    there = tracks.number != HIDDEN
    truth[tracks.number[there]] = marker[there]
    return positions, whole, tracks, truth


def test_trajectories_are_those_of_the_tracks():
    positions, whole, tracks, truth = scene()
    assert np.array_equal(trajectories(whole, tracks, truth, len(SD)), positions, equal_nan=True)


def test_unnamed_tracks_get_their_names():
    _, whole, tracks, truth = scene(1)
    owner = np.where(np.isin(truth, (4, 11, 20)), HIDDEN, truth)
    found, worth = name_tracks(SENSOR, SD, whole, tracks, owner)
    assert np.array_equal(found, truth)
    assert worth > name_tracks(SENSOR, 2.0 * SD, whole, tracks, owner)[1]


def test_pieces_of_one_marker_share_its_name_and_ghosts_have_none():
    _, whole, tracks, truth = scene(2, gap=9, extra=4)
    assert (truth == 9).sum() == 2
    owner = truth.copy()
    owner[np.flatnonzero(truth == 9)[1]] = HIDDEN
    found, _ = name_tracks(SENSOR, SD, whole, tracks, owner)
    assert np.array_equal(found, truth)


def test_no_marker_is_two_points_at_once():
    _, whole, tracks, truth = scene(3)
    twin = np.concatenate([whole, whole[:, :1] + 0.004], axis=1)
    doubled = link_tracks(twin, RATE_HZ)
    owner = np.full(doubled.count, HIDDEN)
    there = tracks.number != HIDDEN
    owner[doubled.number[:, :-1][there]] = truth[tracks.number[there]]
    found, _ = name_tracks(SENSOR, SD, twin, doubled, owner)
    for frame in found[doubled.number]:
        used = frame[frame != HIDDEN]
        assert len(used) == len(set(used.tolist()))


def test_without_names_nothing_is_named():
    _, whole, tracks, _ = scene(4)
    found, worth = name_tracks(SENSOR, SD, whole, tracks, np.full(tracks.count, HIDDEN))
    assert (found == HIDDEN).all()
    assert worth == 0.0
