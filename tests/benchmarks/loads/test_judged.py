"""Rows of judged trials: which are flagged, and how many clean ones are accused."""

import numpy as np
import pytest

from benchmarks.loads.judged import Judged, clean_rows, violator_rows

NAN = float("nan")


def one(loads=0, checks=(), credited=(), spoilt=NAN, largest=0.02):
    return Judged("trial", 100, 50, largest, loads, ("mass",) * loads, checks, credited, spoilt, NAN, NAN)


def row(rows, words):
    (found,) = (check for check in rows if words in check.name)
    return found


@pytest.mark.parametrize(
    ("judged", "flagged"),
    [(one(), 0), (one(1), 1), (one(checks=("mass against plates",)), 1), (one(credited=("pelvis",)), 1)],
)
def test_a_violator_is_flagged_by_whatever_states_it(judged, flagged):
    check = row(violator_rows([judged]), "violators flagged")
    assert (check.value, check.bound, check.passed) == (flagged, 1, bool(flagged))


def test_spoilt_frames_are_summed_over_trials_with_a_known_load():
    check = row(violator_rows([one(1), one(1, spoilt=2.0), one(1, spoilt=1.0)]), "valid frames under")
    assert check.value == 3.0 and "2 trials" in check.name and not check.passed


def test_clean_trials_that_are_accused_are_counted():
    rows = list(clean_rows([one(), one(1), one(2), one(largest=np.nan)]))
    check = row(rows, "accused")
    assert (check.value, check.bound) == (2, 1) and "3 of them judged" in check.name
