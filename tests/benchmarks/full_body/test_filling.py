"""Gap filling as laboratories do it: what is exact, that edges are met, and when it falls back."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.full_body.filling import gaps, moved_with, rigid_filled, spline_filled
from mbkf.synthesis.person import synthesise_subject

SUBJECT = synthesise_subject()
FRAMES = 60
TIMES = np.linspace(0.0, 1.0, FRAMES)
GAP = slice(20, 35)
CLUSTER = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.12, 0.0], [0.03, 0.05, 0.1]])
THIGH, SHANK, TORSO = "right_thigh", "right_shank", "torso"


def rigid():
    """(T, 4, 3) markers of a segment that turns and travels, not polynomially."""
    turns = Rotation.from_euler("xyz", np.c_[np.sin(7 * TIMES), TIMES**2, np.cos(9 * TIMES)])
    travel = np.c_[TIMES, np.sin(8 * TIMES), np.cos(5 * TIMES)]
    return np.array([turn.apply(CLUSTER) for turn in turns]) + travel[:, None]


def lost(positions_m, *markers, gap=GAP):
    shown = positions_m.copy()
    for marker in markers or (0,):
        shown[gap, marker] = np.nan
    return shown


def test_gaps_are_found_with_their_ends_and_never_seen_markers_have_none():
    seen = np.ones((10, 3), dtype=bool)
    seen[[0, 1, 4, 9], 0] = False
    seen[:, 2] = False
    assert [(gap.marker, gap.first, gap.end) for gap in gaps(seen)] == [(0, 0, 2), (0, 4, 5), (0, 9, 10)]


def test_the_spline_reproduces_cubics():
    powers = TIMES[:, None] ** np.arange(4)
    truth = (powers @ np.random.default_rng(0).normal(size=(4, 6))).reshape(FRAMES, 2, 3)
    np.testing.assert_allclose(spline_filled(lost(truth, 0, 1)), truth, atol=1e-12)


def test_the_spline_leaves_the_trials_ends_open():
    shown = lost(lost(rigid(), 0, gap=slice(0, 5)), 1, gap=slice(50, None))
    filled = spline_filled(shown)
    assert np.isnan(filled[:5, 0]).all() and np.isnan(filled[50:, 1]).all()
    assert np.isfinite(filled[5:, 0]).all() and np.isfinite(filled[:50, 1]).all()


def test_a_marker_on_a_rigid_segment_is_found_exactly():
    truth = rigid()
    filled = rigid_filled(lost(truth), [THIGH] * 4, SUBJECT)
    np.testing.assert_allclose(filled, truth, atol=1e-12)
    assert np.abs(spline_filled(lost(truth)) - truth).max() > 1e-4


@pytest.mark.parametrize("gap", [slice(0, 12), slice(45, None)])
def test_one_edge_is_enough_at_the_trials_ends(gap):
    truth = rigid()
    np.testing.assert_allclose(rigid_filled(lost(truth, gap=gap), [THIGH] * 4, SUBJECT), truth, atol=1e-12)


def test_a_marker_that_slides_is_met_at_both_edges():
    """Its place in the segment is taken to move linearly from edge to edge."""
    truth = rigid()
    shown = lost(truth)
    slide = np.array([0.0, 0.02, 0.0])
    shown[GAP.stop :, 0] += slide
    filled = rigid_filled(shown, [THIGH] * 4, SUBJECT)
    turn, after = (
        Rotation.align_vectors(truth[frame, 1:] - truth[frame, 1], CLUSTER[1:] - CLUSTER[1])[0]
        for frame in (GAP.start, GAP.stop)
    )
    first_share = 1.0 / (GAP.stop - GAP.start + 1)
    wanted = truth[GAP.start, 0] + first_share * (turn * after.inv()).apply(slide)
    np.testing.assert_allclose(filled[GAP.start, 0], wanted, atol=1e-12)


def test_two_markers_of_the_segment_do_not_do_without_a_neighbour():
    truth = rigid()
    segments = [THIGH, THIGH, THIGH, SHANK]
    np.testing.assert_allclose(rigid_filled(lost(truth), segments, SUBJECT), truth, atol=1e-12)
    alone = rigid_filled(lost(truth), segments, SUBJECT, neighbours=False)
    np.testing.assert_array_equal(alone, spline_filled(lost(truth)))
    far = rigid_filled(lost(truth), [THIGH, THIGH, THIGH, TORSO], SUBJECT)
    np.testing.assert_array_equal(far, spline_filled(lost(truth)))


def test_frames_without_three_carriers_fall_back_on_the_spline():
    truth = rigid()
    shown = lost(lost(truth), 1, gap=slice(28, 33))
    filled = rigid_filled(shown, [THIGH] * 4, SUBJECT)
    for carried in (slice(20, 28), slice(33, 35)):
        np.testing.assert_allclose(filled[carried, 0], truth[carried, 0], atol=1e-12)
    np.testing.assert_array_equal(filled[28:33, 0], spline_filled(shown)[28:33, 0])


def test_the_past_alone_knows_neither_the_second_edge_nor_splines():
    truth = rigid()
    shown = lost(lost(truth), 1, gap=slice(30, 40))
    later = shown.copy()
    later[GAP.stop :, 0] += 0.05
    filled = [rigid_filled(one, [THIGH] * 4, SUBJECT, past_only=True)[GAP, 0] for one in (shown, later)]
    np.testing.assert_array_equal(*filled)
    np.testing.assert_allclose(filled[0][:10], truth[20:30, 0], atol=1e-12)
    assert np.isnan(filled[0][10:]).all()


def test_points_on_a_line_carry_nothing():
    line = np.arange(3)[:, None] * np.array([0.1, 0.0, 0.0])
    assert np.isnan(moved_with(line, line + 0.1, np.ones(3))).all()
