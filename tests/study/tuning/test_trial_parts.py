"""The likelihood of a part of a trial: its readings are counted, and settings change it."""

import math

import pytest

from mbkf.errors import InvalidInput
from mbkf.study.tuning.trial_parts import likelihood_per_reading, split_trials
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.walker import walker

SETTINGS = ReconstructSettings(filter="kinematic", correct_markers=False)


def test_a_single_trial_that_is_too_short_to_halve_is_refused():
    with pytest.raises(InvalidInput, match="first half' is too short"):
        split_trials([walker().trial], walker().subject, "kinematic", SETTINGS, None)


def test_trials_are_held_out_by_position():
    trials = [walker().trial, walker().trial]
    tuned, held_out = split_trials(trials, walker().subject, "kinematic", SETTINGS, (0,))
    assert len(tuned) == len(held_out) == 1
    assert tuned[0].readings == held_out[0].readings > 0
    defaults = {"marker_noise_scale": 1.0}
    wide = {"marker_noise_scale": 100.0}
    assert likelihood_per_reading(tuned, defaults) > likelihood_per_reading(tuned, wide)
    assert tuned[0].value({"marker_noise_scale": math.nan}) == -math.inf
