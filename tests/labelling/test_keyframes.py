"""Keyframes of a capture: which tracks move together, which frames differ, what stands still."""

import numpy as np

from mbkf.labelling.keyframes import TRAVEL_M, choose_keyframes, moving
from mbkf.labelling.tracks import link_tracks
from tests.labelling.bodies import reference_sensor
from tests.labelling.movement import RATE_HZ, movement

SENSOR = reference_sensor("autolabel62")


def scene(seed=1, extra=0):
    rng = np.random.default_rng(seed)
    positions = movement(SENSOR, rng)
    still = np.broadcast_to(rng.uniform(-2.0, 2.0, (extra, 3)), (len(positions), extra, 3))
    positions = np.concatenate([positions, still], axis=1)
    return positions, link_tracks(positions, RATE_HZ)


def test_tracks_of_a_segment_keep_their_distance_and_others_do_not():
    positions, tracks = scene()
    seen = choose_keyframes(positions, tracks, 60, 6)
    marker = np.empty(tracks.count, dtype=int)
    marker[tracks.number[60]] = np.arange(positions.shape[1])
    segment = np.array(SENSOR.segments)[marker[seen.tracks]]
    same = segment[:, None] == segment
    assert seen.spread_m[same].max() < 1e-9
    assert np.median(seen.spread_m[~same]) > 0.05
    assert np.array_equal(seen.length_m, seen.length_m.T)


def test_the_first_moment_is_the_frame_and_none_comes_twice():
    positions, tracks = scene(2)
    seen = choose_keyframes(positions, tracks, 30, 5)
    assert seen.frames[0] == 30
    assert len(set(seen.frames.tolist())) == 5
    assert np.allclose(seen.positions_m, tracks.positions(positions, seen.frames)[:, seen.tracks])


def test_moments_differ_more_than_frames_at_random():
    positions, tracks = scene(3)
    seen = choose_keyframes(positions, tracks, 0, 4)

    def least_difference(frames):
        arms = [np.linalg.norm(positions[t][:, None] - positions[t], axis=2) for t in frames]
        return min(np.sqrt(((a - b) ** 2).mean()) for i, a in enumerate(arms) for b in arms[:i])

    rng = np.random.default_rng(0)
    picked = [[0, *rng.choice(np.arange(1, len(positions)), 3, replace=False)] for _ in range(30)]
    assert least_difference(seen.frames) >= np.median([least_difference(frames) for frames in picked])


def test_what_stands_still_takes_no_part_while_the_body_travels():
    positions, tracks = scene(4, extra=3)
    seen = choose_keyframes(positions, tracks, 10, 3)
    assert not set(tracks.number[10, -3:].tolist()) & set(seen.tracks.tolist())
    assert len(seen.tracks) == len(SENSOR.segments)


def test_nothing_is_set_aside_where_no_person_travels():
    positions = np.zeros((50, 4, 3)) + np.arange(4)[:, None]
    positions[:, 0, 0] += np.linspace(0.0, 0.5 * TRAVEL_M, 50)
    assert moving(positions).all()


def test_too_few_tracks_are_no_moments():
    positions = np.random.default_rng(0).normal(size=(1, 2, 3)) * np.ones((20, 1, 1))
    assert choose_keyframes(positions, link_tracks(positions, RATE_HZ), 5, 3) is None
