"""A trial's markers are those of standing: skin may move them, another person's or moved ones are refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.study.scaling.likeness import LEAST_COVERAGE, MOST_CHANGED_MM, StandingMarkers
from tests.bending import squat, stander, standing


@pytest.fixture(scope="module")
def markers():
    return StandingMarkers(stander(), standing().markers)


def test_the_same_person_in_another_posture_is_accepted(markers):
    own = squat().markers
    assert markers.refusal(own) == ""
    assert markers.changed_mm(own) < 0.5 and markers.coverage(own) == 1.0


def test_skin_that_moves_by_millimetres_is_accepted_and_other_sizes_and_places_are_refused(markers):
    assert markers.refusal(squat(moved_m=0.003).markers) == ""
    for other in (squat(factor=1.1), squat(moved_m=0.015)):
        assert markers.changed_mm(other.markers) > MOST_CHANGED_MM
        assert "another person, or markers put on anew" in markers.refusal(other.markers)


def test_one_marker_put_on_anew_does_not_cost_the_trial(markers):
    own = squat().markers
    positions = own.positions_m.copy()
    positions[:, own.names.index("C7")] += 0.2
    assert markers.refusal(replace(own, positions_m=positions)) == ""


def test_a_trial_that_lacks_most_markers_is_refused_and_few_pairs_leave_the_person_open(markers):
    own = squat().markers
    few = own.select(own.names[: int(LEAST_COVERAGE * len(own.names)) - 1])
    assert "% of the markers of the standing trial" in markers.refusal(few)
    assert markers.changed_mm(own.select(("LASI", "RASI"))) is None
    gaps = replace(own, positions_m=np.full_like(own.positions_m, np.nan))
    assert markers.coverage(gaps) == 0.0
