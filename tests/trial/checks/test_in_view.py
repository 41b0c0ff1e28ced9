"""The check of one person in view: six markers of somebody else are outside its bound, five are not."""

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.trial.checks.in_view import NAME, in_view_finding, unseen_finding

OWN = ("LASI", "RASI", "LKNE")


@pytest.mark.parametrize(("others", "verdict"), [(0, "inside"), (5, "inside"), (6, "outside")])
def test_the_number_of_far_markers_is_judged(others, verdict):
    names = (*OWN, *(f"B{n}" for n in range(others)))
    places = np.zeros((4, len(names), 3))
    places[:, 3:, 1] = 2.0
    found = in_view_finding(MarkerTrajectories(names, places, 100.0), OWN)
    assert (found.value, found.verdict) == (others, verdict)
    assert ("record one person alone" in found.hint) == (verdict == "outside")


def test_a_live_run_does_not_judge_who_else_is_in_view():
    found = unseen_finding()
    assert (found.name, found.verdict, found.value) == (NAME, "not judged", None)
