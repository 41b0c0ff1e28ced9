"""Trials of a session against each other: another person's trial, another file, markers that were put on anew."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.scaling.trial_lengths import LengthChange, LengthEvidence
from mbkf.study.session.agreement import TrialBody, disagreements
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.checks.persons import person_finding

PERSON = synthesise_subject(3)
NAMES = tuple(m.name for m in PERSON.markers)


def trial(name, powers=-4.0, subject=PERSON, moved=None):
    """A trial with markers a millimetre from their places, some of them further."""
    rng = np.random.default_rng(len(name))
    places = {m.name: m.position_m + 0.0005 * rng.normal(size=3) for m in PERSON.markers}
    for marker, away in (moved or {}).items():
        places[marker] = places[marker] + away
    lengths = person_finding(LengthEvidence(powers, (LengthChange("thigh", 38.4, 9.0),)))
    return TrialBody(name, subject, places, lengths)


def test_trials_of_one_person_agree():
    assert disagreements([trial("a"), trial("b", 2.4), trial("c", -1.0)]) == ()
    assert disagreements([]) == ()


def test_a_trial_of_another_person_is_named_among_right_ones():
    (found,) = disagreements([trial("a"), trial("b", 14.0), trial("c")])
    assert (found.trials, found.word) == (("b",), "do not use")
    assert "thigh 38 ± 9 mm longer" in found.sentence and "other 2 trials" in found.sentence


def test_a_file_that_fits_no_trial_is_the_fault_itself():
    (found,) = disagreements([trial("a", 9.0), trial("b", 14.0)])
    assert found.trials == ("a", "b") and "the file is another person's" in found.sentence


def test_trials_with_another_file_are_named():
    other = replace(PERSON, scale_factors={**PERSON.scale_factors, "right_thigh": 1.2})
    nearly = {name: 1.002 * k for name, k in PERSON.scale_factors.items()}
    same = replace(PERSON, scale_factors=nearly)
    (found,) = disagreements([trial("a"), trial("b", subject=other), trial("c", subject=same)])
    assert (found.trials, found.word) == (
        ("b",),
        "do not use",
    ) and "another subject file than a" in found.sentence


@pytest.mark.parametrize(("moved_m", "named"), [(0.03, False), (0.09, True)])
def test_a_marker_that_was_put_on_anew_is_named_with_its_distance(moved_m, named):
    away = {"RKNE": np.array([0.0, 0.0, moved_m])}
    found = disagreements([trial("a"), trial("b", moved=away), trial("c")])
    assert [(one.trials, one.word) for one in found] == ([(("b",), "look")] if named else [])
    assert all("RKNE sits 90 mm" in one.sentence for one in found)
    assert disagreements([trial("a"), trial("b", moved=away)]) == (), "of two trials it is not known which"


def test_markers_of_a_segment_that_move_together_are_skin():
    segment = next(m.segment for m in PERSON.markers if m.name == "LASI")
    together = {m.name: np.array([0.09, 0.0, 0.0]) for m in PERSON.markers if m.segment == segment}
    assert disagreements([trial("a"), trial("b", moved=together), trial("c")]) == ()
