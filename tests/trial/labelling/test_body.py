"""A subject's markers made ready for labelling."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.labelling.running import RunningSettings
from mbkf.trial.labelling.body import CORRECTED_SD_M, corrected_body, label_body
from tests.walker import walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def person():
    made = walker()
    return made.trial.markers, made.subject


def test_markers_that_scaling_never_saw_are_not_looked_for(person):
    _, subject = person
    body = label_body(subject.markers, subject, RunningSettings())
    assert set(body.names) == set(subject.report["markers"])
    assert body.sensor.segments == tuple(m.segment for m in body.markers)
    assert np.array_equal(body.noise_m, [m.noise_m for m in body.markers])


def test_corrected_markers_sit_where_the_trial_shows_them(person):
    trial, subject = person
    body = label_body(subject.markers, subject, RunningSettings())
    places = {m.name: m.position_m for m in body.markers}
    shown = trial.positions_m.copy()
    shown[:, trial.names.index("RKNE")] = np.nan
    corrected = corrected_body(body, replace(trial, positions_m=shown))
    assert "RKNE" not in corrected.names
    assert set(corrected.names) == set(trial.names) - {"RKNE"}
    assert all(m.session_sd_m <= CORRECTED_SD_M for m in corrected.markers)
    moved = [np.linalg.norm(m.position_m - places[m.name]) for m in corrected.markers]
    assert 0.0 < np.median(moved) < 0.01


def test_markers_that_fit_no_body_correct_nothing(person):
    trial, subject = person
    body = label_body(subject.markers, subject, RunningSettings())
    assert corrected_body(body, replace(trial, positions_m=np.full_like(trial.positions_m, np.nan))) is None
