"""The motion of markers alone: near the truth, blind to plates, and told frame by frame."""

from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.tracking import track
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.dynamics import trial

QUIET = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.0, occlusion=0.0, offset_n=(0.0, 0.0))
FEW = 60


@cache
def read():
    made = trial("squat")
    recorded = synthesise_capture(made.subject, made.motion, QUIET, seed=1).trial
    inputs, recording = trial_inputs(recorded.markers, recorded.plates, made.subject, ReconstructSettings())
    return (
        made,
        inputs,
        replace(recording, markers_m=recording.markers_m[:FEW], plates=recording.plates[:FEW]),
    )


def test_it_is_the_true_motion():
    made, inputs, recording = read()
    found = markers_alone(inputs, recording)
    off = [made.model.difference(*pair) for pair in zip(found.q, made.motion.q[:FEW], strict=True)]
    assert np.sqrt(np.mean(np.square(off))) < 0.02
    assert np.sqrt(np.mean((found.v - made.motion.v[:FEW])[10:] ** 2)) < 0.25


def test_it_is_the_smoothed_kinematic_filter_s():
    """Smoothing covariances as well changes no mean."""
    _, inputs, recording = read()
    found = markers_alone(inputs, recording)
    whole = track(tracking_filter("kinematic", inputs), recording, smoothing=SmoothingSettings())
    np.testing.assert_array_equal(found.q, whole.q)
    np.testing.assert_array_equal(found.v, whole.v)


def test_plates_have_no_say():
    _, inputs, recording = read()
    found = markers_alone(inputs, recording)
    other = markers_alone(inputs, replace(recording, plates=recording.plates + 100.0))
    np.testing.assert_array_equal(found.q, other.q)
    np.testing.assert_array_equal(found.v, other.v)


def test_progress_is_told_up_to_the_last_frame():
    _, inputs, recording = read()
    told = []
    markers_alone(inputs, recording, lambda *at: told.append(at))
    assert told[-1] == (FEW, FEW)
