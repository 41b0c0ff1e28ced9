"""The check of a person: words on lengths, and trials whose markers are not corrected."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.scaling.trial_lengths import LengthChange, LengthEvidence
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.checks.persons import finding_of_markers, person_finding
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.synth import synthesise

CHANGES = (LengthChange("thigh", 38.4, 9.0), LengthChange("shank", -21.0, 6.0))


@pytest.mark.parametrize(
    ("powers", "value", "verdict"),
    [(-6.0, 0.0, "inside"), (2.4, 2.4, "inside"), (4.0, 4.0, "doubtful"), (14.2, 14.2, "outside")],
)
def test_only_evidence_for_another_person_counts(powers, value, verdict):
    found = person_finding(LengthEvidence(powers, CHANGES))
    assert (found.value, found.verdict) == (value, verdict)
    assert found.hint.startswith("thigh 38 ± 9 mm longer, shank 21 ± 6 mm shorter in the trial")
    assert ("another person" in found.hint) == (verdict == "outside")


def test_a_trial_without_correction_is_judged_by_a_few_frames():
    subject, made = synthesise("walk", seconds=1.0, seed=1)
    shown = subject_markers(made.trial.markers, subject)
    assert finding_of_markers(subject, shown).verdict == "inside"
    assert finding_of_markers(synthesise_subject(12), shown).verdict == "outside"
    nobody = replace(shown, positions_m=np.full_like(shown.positions_m, np.nan))
    assert finding_of_markers(subject, nobody).verdict == "not judged"
