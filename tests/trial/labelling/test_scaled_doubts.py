"""Doubts about the labels of a scaled person: told where the walk is not worn as the standing trial was."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.label import label
from mbkf.trial.labelling.doubts import DOUBTFUL_ODDS
from mbkf.trial.labelling.result import label_summary
from mbkf.trial.labelling.score import score
from tests.walker import unlabelled, walker

pytestmark = pytest.mark.slow


def without(made, name, *points):
    """The walk without a marker's name or point, and with other points (T, 3)."""
    names = made.trial.markers.names
    positions = np.delete(made.trial.markers.positions_m, names.index(name), axis=1)
    more = [point[:, None] for point in points]
    return unlabelled(made.trial, np.concatenate([positions, *more], axis=1), shuffle=False)


def test_a_walk_worn_as_the_standing_trial_is_in_no_doubt():
    made = walker()
    found = label(made.trial, made.subject).doubts
    assert found.labels == ()
    assert found.warnings() == ()
    assert min(found.odds.values()) > DOUBTFUL_ODDS


def test_a_point_that_stands_where_a_marker_is_not_is_told():
    """A reflection fixed to the shank takes the name of the knee's marker, which was not worn."""
    made = walker()
    names = made.trial.markers.names
    knee = made.trial.markers.positions_m[:, names.index("RKNE")]
    found = label(without(made, "RKNE", knee + np.array([0.0, 0.0, 0.045])), made.subject)
    truth = made.trial.markers.select(tuple(name for name in names if name != "RKNE"))
    wrong = score(found.markers, truth, made.subject).wrong.any(axis=0)
    assert "RKNE" in found.doubts.labels or not wrong.any()
    assert "RKNE" in {*found.doubts.far_m, *found.doubts.unused}
    assert label_summary(found)["doubts"]["labels"] == list(found.doubts.labels)


def test_a_marker_that_lacks_is_counted_as_unused():
    made = walker()
    found = label(without(made, "LTUB"), made.subject).doubts
    assert found.unused == ("LTUB",)
    assert found.nameless == 0


def test_a_moved_marker_is_told_with_its_distance():
    made = walker()
    places = [
        replace(m, position_m=m.position_m + np.array([0.0, 0.0, 0.045])) if m.name == "C7" else m
        for m in made.subject.markers
    ]
    found = label(made.trial, replace(made.subject, markers=tuple(places))).doubts
    assert list(found.far_m) == ["C7"]
    assert found.far_m["C7"] == pytest.approx(0.045, abs=0.015)
    assert any("C7" in line and "mm" in line for line in found.warnings())
