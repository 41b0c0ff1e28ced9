"""Rows on shared captures: every capture has right answers, and results that are missing keep no bound."""

import numpy as np
import pytest

from benchmarks.strangers.right_answers import ANSWERS
from benchmarks.strangers.shared_captures import CAPTURES, standing_ankles_deg
from benchmarks.strangers.trial import Trial

READ_FILES = {"functional_walk", "fukuchi_run", "two_persons_art"}
"""Captures whose answers are found with commands of their own."""


def test_every_capture_has_right_answers():
    assert {one.capture.folder for one in CAPTURES} == set(ANSWERS)
    assert len({one.capture.name for one in CAPTURES}) == 11


@pytest.mark.parametrize("folder", sorted(set(ANSWERS) - READ_FILES))
def test_a_result_that_is_missing_is_no_right_answer(folder, tmp_path):
    rows = list(ANSWERS[folder](Trial(tmp_path, tmp_path)))
    assert rows
    assert not any(row.passed for row in rows)


def test_nothing_is_known_of_a_person_who_was_not_scaled(tmp_path):
    assert np.isnan(standing_ankles_deg(tmp_path / "subject.toml")).all()
    trial = Trial(tmp_path, tmp_path)
    assert np.isnan(trial.range_deg("knee_angle")).all()
    assert (trial.word("pelvis"), trial.said("scale"), trial.supports()) == ("", "", [])
