"""A trial of the campaign: errors are those of the result, and whatever is raised is told."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.campaign import trials
from benchmarks.campaign.draw import drawn
from benchmarks.campaign.trials import error_of, outcome
from mbkf.errors import InvalidInput
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.walker import walker


@pytest.mark.parametrize(
    ("error", "refused", "failed"),
    [
        (InvalidInput("no\nmass"), "InvalidInput: no mass", ""),
        (ValueError("shape"), "", "ValueError: shape"),
    ],
)
def test_what_is_raised_is_told(error, refused, failed, monkeypatch):
    def raising(trial):
        raise error

    monkeypatch.setattr(trials, "_errors", raising)
    found = outcome(3)
    assert (found.refused, found.failed, found.errors) == (refused, failed, ())
    assert found.trial == drawn(3)


def test_a_warning_fails(monkeypatch):
    monkeypatch.setattr(
        trials, "_errors", lambda trial: warnings.warn("overflow", RuntimeWarning, stacklevel=1)
    )
    assert outcome(3).failed == "RuntimeWarning: overflow"


@pytest.mark.slow
def test_errors_are_those_of_the_settled_tracked_frames():
    made = walker()
    settings = ReconstructSettings(filter="kinematic", smooth=False, checks=False, correct_markers=False)
    found = reconstruct(made.trial, made.subject, settings=settings)
    right = error_of(drawn(0), found, made.truth, made.subject)
    assert right.worst_deg < 20.0 and right.tracked == 1.0 and not right.smoothed
    name = "knee_angle_r"
    column, at = found.coordinate_names.index(name), right.angle_names.index(name)
    off = found.angles.copy()
    settled = found.times_s >= found.times_s[0] + 0.5
    off[:, column] += np.where(settled, 0.5, 100.0)
    wrong = error_of(drawn(0), replace(found, angles=off), made.truth, made.subject)
    assert wrong.angle_rms_deg[at] == pytest.approx(np.degrees(0.5), abs=right.angle_rms_deg[at])
    assert wrong.angle_doubt[at] > 5.0 > right.angle_doubt[at]
    tracked = found.tracked.copy()
    tracked[-10:] = False
    off[-10:] = np.nan
    left = error_of(drawn(0), replace(found, angles=off, tracked=tracked), made.truth, made.subject)
    assert np.isfinite(left.angle_rms_deg).all()
    assert left.tracked == pytest.approx(1.0 - 10 / settled.sum())
    assert error_of(drawn(0), replace(found, angles=off), made.truth, made.subject).worst_deg == np.inf
