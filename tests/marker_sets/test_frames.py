"""Frames that are looked at: well seen, tall, and spread over the trials."""

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.marker_sets.frames import SPREAD, anchor_frames, spread_frames

NAMES = tuple("abcdefghij")


def trial(heights, names=NAMES):
    """Points of a pole, of another height in every frame."""
    level = np.linspace(0.0, 1.0, len(names))
    positions = np.zeros((len(heights), len(names), 3))
    positions[:, :, 2] = np.outer(heights, level)
    return MarkerTrajectories(tuple(names), positions, 100.0)


def top(frames):
    return np.nanmax(frames[:, :, 2], axis=1)


def test_the_tallest_of_every_stretch_is_chosen_the_tallest_of_all_first():
    heights = np.r_[1.0, 1.5, 1.1, 1.2, 1.6, 1.3]
    np.testing.assert_allclose(top(anchor_frames([trial(heights)], NAMES, 1)), [1.6])
    np.testing.assert_allclose(top(anchor_frames([trial(heights)], NAMES, 2)), [1.6, 1.5])
    np.testing.assert_allclose(top(anchor_frames([trial(heights)], NAMES, 99)), np.sort(heights)[::-1])


def test_a_frame_with_markers_missing_is_none():
    one = trial([1.0, 2.0])
    positions = one.positions_m.copy()
    positions[1, :2] = np.nan
    chosen = anchor_frames([MarkerTrajectories(one.names, positions, 100.0)], NAMES, 1)
    np.testing.assert_allclose(top(chosen), [1.0])


def test_spread_out_arms_count_against_height():
    one = trial([1.5, 1.6])
    positions = one.positions_m.copy()
    positions[1, 4, 0] = 1.0
    chosen = anchor_frames([MarkerTrajectories(one.names, positions, 100.0)], NAMES, 1)
    np.testing.assert_allclose(top(chosen), [1.5])


def test_columns_are_in_the_order_asked_for_and_empty_where_a_trial_lacks_the_marker():
    back = trial([1.0], NAMES[::-1])
    (frame,) = anchor_frames([back], (*NAMES, "k"), 1)
    np.testing.assert_array_equal(frame[:-1], back.positions_m[0, ::-1])
    assert np.isnan(frame[-1]).all()


@pytest.mark.parametrize("frames", [1, 5, SPREAD, 1000])
def test_frames_are_spread_evenly_over_each_trial(frames):
    heights = 1.0 + np.arange(frames)
    chosen = spread_frames([trial(heights), trial([7.0])], NAMES)
    tops = top(chosen)
    assert len(chosen) == min(frames, SPREAD) + 1
    assert tops[0] == heights[0]
    assert tops[-2] == heights[-1]
    assert tops[-1] == 7.0
    assert np.ptp(np.diff(tops[:-1])) <= 1.0 if frames > 2 else True


def test_badly_seen_frames_are_not_among_them():
    one = trial(np.ones(40))
    positions = one.positions_m.copy()
    positions[10:30, :6] = np.nan
    chosen = spread_frames([MarkerTrajectories(one.names, positions, 100.0)], NAMES)
    assert not np.isnan(chosen).any()
