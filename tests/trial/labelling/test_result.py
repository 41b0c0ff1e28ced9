"""The result of labelling: shares, the labelled capture, and the summary's numbers."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN
from mbkf.trial.labelling.result import Labelling, label_summary, labelled_capture
from mbkf.trial.labelling.score import LabelScore
from tests.walker import walker

A, B, NEVER = range(3)


@pytest.fixture
def found():
    """Four frames: A seen in all but the first, B in the last two, a third marker in none."""
    positions = np.full((4, 3, 3), np.nan)
    positions[1:, A], positions[2:, B] = 1.0, 2.0
    labels = np.full((4, 5), HIDDEN)
    return Labelling(
        MarkerTrajectories(("a", "b", "never"), positions, 100.0),
        labels,
        ghosts=np.array([2, 1, 0, 3]),
        starts=(2, 3),
        repaired=4,
        step_seconds=np.array([np.nan, 1e-3, 3e-3, 2e-3]),
        relabelled=5,
    )


def test_shares_count_the_markers_that_the_capture_shows(found):
    assert found.assigned_fraction == pytest.approx(5 / 8)
    assert found.first_labelled_frame == 1
    nothing = replace(found, markers=replace(found.markers, positions_m=np.full((4, 3, 3), np.nan)))
    assert nothing.assigned_fraction == 0.0


def test_the_summary_holds_plain_numbers(found):
    summary = label_summary(found)
    assert summary["markers"] == 2
    assert (summary["ghosts_dropped"], summary["ghosts_per_frame"]) == (6, [2, 1, 0, 3])
    assert (summary["swaps_repaired"], summary["samples_relabelled"], summary["starts"]) == (4, 5, [2, 3])
    assert summary["step_seconds_median"] == pytest.approx(2e-3)
    assert "doubts" not in summary and "correct_fraction" not in summary
    assert label_summary(replace(found, step_seconds=np.full(4, np.nan)))["step_seconds_median"] is None


def test_the_summary_compares_with_a_truth(found):
    right, wrong, missed = np.array([1, 1, 0, 0], bool), np.array([0, 0, 1, 0], bool), np.zeros(4, bool)
    summary = label_summary(found, LabelScore(("a",), right, wrong, missed, 4))
    shares = [summary[f"{kind}_fraction"] for kind in ("correct", "wrong", "missed")]
    assert shares == [0.5, 0.25, 0.0]


def test_the_labelled_capture_shows_only_markers_with_points(found):
    raw = walker().raw
    named = labelled_capture(raw, found)
    assert named.markers.names == ("a", "b")
    np.testing.assert_array_equal(named.markers.positions_m, found.markers.positions_m[:, :2])
    assert named.plates == raw.plates


def test_points_of_a_second_person_are_remarked(found):
    raw, crowd = walker().raw, replace(found, others=31)
    assert (found.others_remark, labelled_capture(raw, found).notes) == ("", raw.notes)
    assert labelled_capture(raw, crowd).notes == (*raw.notes, crowd.others_remark)
    assert "31 points" in crowd.others_remark and label_summary(crowd)["others_in_view"] == 31
