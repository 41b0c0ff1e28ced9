"""Checks of one trial: those of plates need plates and the motion of markers alone."""

import numpy as np

from mbkf.trial.checks.rigidity import NAME as RIGIDITY
from mbkf.trial.checks.trial import trial_checks
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise


def test_plates_are_judged_where_there_are_plates():
    subject, made = synthesise("walk", seconds=1.0, seed=1)
    shown = subject_markers(made.trial.markers, subject)
    inputs, recording = trial_inputs(shown, made.trial.plates, subject, ReconstructSettings())
    alone = markers_alone(inputs, recording)
    with_plates = trial_checks(shown, subject, inputs, recording, alone)
    without = trial_checks(shown, subject, inputs, recording, None)
    assert without == with_plates[-len(without) :] and RIGIDITY in {one.name for one in without}
    assert "mass against plates" in {one.name for one in with_plates}
    assert all(one.value is None or np.isfinite(one.value) for one in with_plates)
