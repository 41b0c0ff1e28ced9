"""The occlusion study: its conditions, what is hidden, its arithmetic, and its page's parts."""

import numpy as np
import pytest

from benchmarks.dynamic.captures import Person
from benchmarks.dynamic.losses import CAPTURES, FRACTIONS, occluded, streaks
from benchmarks.dynamic.synthetic import MATCHED
from benchmarks.full_body import occlusion
from benchmarks.full_body.filters import DYNAMIC, FCDI
from benchmarks.full_body.occlusion import (
    AFTER,
    DYNAMIC_SMOOTHED,
    ESTIMATES,
    FILLED,
    GAP_S,
    GAPS_S,
    METHODS,
    OFFLINE,
    RIGID_PAST,
    SHARE,
    SHARES,
    SPLINE,
    SYNTHETIC,
    Condition,
    Point,
    Score,
    Trial,
    covered,
    fillings,
    hidden_mm,
    occlusion_findings,
    scores_of,
)
from benchmarks.full_body.occlusion_drawings import occlusion_drawings
from mbkf.trial.synth import synthesise

USUAL = Condition(SHARE, GAP_S)


@pytest.fixture(scope="module")
def person():
    subject, made = synthesise("squat", seconds=1.0, settings=MATCHED)
    return Person(SYNTHETIC, made.trial, subject)


@pytest.fixture(scope="module")
def case(person):
    return occluded(person, SHARE, 0)


def point(capture=CAPTURES[0], condition=USUAL, **errors_mm):
    """A point where every estimate has 10 mm, but those named."""
    scores = {name: Score(10.0) for name in ESTIMATES}
    scores |= {name: Score(value) for name, value in errors_mm.items()}
    return Point(capture, condition, 4, scores)


def test_every_condition_is_measured_once_and_the_bounded_ones_are_among_them():
    found = occlusion._conditions(quick=False)
    assert len(set(found)) == len(found) == len(SHARES) + len(GAPS_S) - 1
    assert [one.share for one in found if one.bounded] == list(FRACTIONS)


@pytest.mark.parametrize(("share", "frames"), [(0.1, 5), (0.1, 200), (0.5, 20)])
def test_the_share_is_reached_in_streaks_of_the_wanted_length(share, frames):
    hidden = streaks(np.ones((238, 41), dtype=bool), share, 0, frames)
    assert share <= hidden.mean() < share + (frames + 1) / hidden.size
    edges = np.diff(np.vstack([np.zeros((1, 41)), hidden, np.zeros((1, 41))]).astype(int), axis=0)
    for marker in range(41):
        first, end = np.flatnonzero(edges[:, marker] > 0), np.flatnonzero(edges[:, marker] < 0)
        assert ((end - first)[(first > 0) & (end < 238)] >= frames).all()


def test_only_what_is_hidden_is_withheld(case):
    shown, present = case.shown.markers.positions_m, ~np.isnan(case.withheld_m).any(axis=2)
    assert case.hidden.sum() / present.sum() == pytest.approx(SHARE, abs=0.02)
    assert (np.isnan(shown).any(axis=2) == (case.hidden | ~present)).all()


def test_fillings_keep_what_was_seen(case):
    seen = case.shown.markers.present
    for positions in fillings(case).values():
        np.testing.assert_array_equal(positions[seen], case.shown.markers.positions_m[seen])


def test_the_distance_is_taken_at_hidden_markers_only(case):
    moved = case.withheld_m + np.where(case.hidden[:, :, None], [0.003, 0.0, 0.004], 1.0)
    assert hidden_mm(case, moved) == pytest.approx(5.0)


def test_all_estimates_of_a_real_capture_have_an_error_and_no_truth(person):
    scores = scores_of(Trial(person, None, USUAL, 0))
    assert set(scores) == set(ESTIMATES)
    assert all(0.0 < one.hidden_mm < 200.0 for one in scores.values())
    assert np.isnan([one.cover for one in scores.values()]).all()


def test_of_a_practice_the_better_answer_counts_and_of_practices_the_best():
    one = point(**{SPLINE + FILLED: 4.0, SPLINE + AFTER: 5.0, DYNAMIC: 3.0, DYNAMIC_SMOOTHED: 1.0})
    assert one.hidden_mm(SPLINE) == 4.0
    assert one.ratio(DYNAMIC) == 0.75 and one.ratio(DYNAMIC_SMOOTHED) == 0.25
    past = point(**{RIGID_PAST + AFTER: 2.0, FCDI: 6.0, DYNAMIC: 3.0})
    assert past.ratio(DYNAMIC) == 0.5, "what sees only the past is none of the offline practices"
    assert past.ratio(DYNAMIC, (RIGID_PAST, FCDI)) == 1.5


def test_cover_counts_what_is_stated():
    error = np.array([[1.9, -2.1], [np.nan, 0.0]])
    sd = np.array([[1.0, 1.0], [1.0, np.nan]])
    assert covered(error, sd) == 0.5
    assert covered(np.random.default_rng(0).normal(size=(4000, 5)), np.ones((4000, 5))) == pytest.approx(
        0.95, abs=0.005
    )


def test_bounds_stand_on_real_walks_at_both_shares_only():
    everywhere = [
        point(capture, Condition(share, gap_s), **{DYNAMIC: 12.0, DYNAMIC_SMOOTHED: 6.0})
        for capture in (*CAPTURES, SYNTHETIC)
        for share in SHARES
        for gap_s in ((GAP_S, 1.0) if share == SHARE else (GAP_S,))
    ]
    found = occlusion_findings(everywhere)
    assert len(found.bands) == 2 * len(CAPTURES) * len(FRACTIONS)
    assert [band.kept for band in found.bands[:2]] == [False, True]
    assert all(band.needs_all_seeds for band in found.bands)
    judged = len(METHODS) + len(OFFLINE) + 1
    rows = [len(everywhere), 4 * len(SHARES), 4 * 2, judged * (len(SHARES) + 1)]
    assert [len(sheet.rows) for sheet in found.sheets] == rows
    assert all(len(row) == len(sheet.columns) for sheet in found.sheets for row in sheet.rows)


def test_figures_have_a_curve_for_every_capture():
    points = [
        point(capture, Condition(share, GAP_S)) for capture in (CAPTURES[0], SYNTHETIC) for share in SHARES
    ]
    share, gap, truth = occlusion_drawings(points)
    assert len({one.file for one in (share, gap, truth)}) == 3
    assert [one.get_title(loc="left") for one in share.figure.axes] == [CAPTURES[0], SYNTHETIC]
    assert len(truth.figure.axes) == 4
