"""Segments by plates: found where they differ, refused where the table is right or a trial shows too little."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.io.inertia import SegmentInertia
from mbkf.model.human import HumanModel
from mbkf.model.inertial_regressor import PER_OWN, InertialRegressor
from mbkf.trial.inertia import estimate
from mbkf.trial.inertia.estimate import (
    INERTIA_KEY,
    estimate_from_rows,
    estimate_inertia,
    halves,
    rows_of,
    with_inertia,
)
from mbkf.trial.inertia.prior import PLACE
from mbkf.trial.inertia.rows import trial_rows
from tests.checked import body, evidence, motion, plates, recorded
from tests.dynamics import trial

HEAVY = 0.15


def squat_capture():
    return replace(recorded("squat"), plates=plates("squat"), path="folder/squat.c3d")


@pytest.fixture
def true_motion(monkeypatch):
    """The true motion in place of the one that is found from markers, which takes long."""
    monkeypatch.setattr(estimate, "correct_markers", lambda subject, _: subject)
    monkeypatch.setattr(estimate, "markers_alone", lambda *_: motion("squat"))


@cache
def squat_rows():
    regressor, found = InertialRegressor(body("squat")), evidence("squat")
    return regressor, trial_rows(regressor, motion("squat"), found, found.clear)


def of_torso(change):
    """The squat of a person whose torso is heavier and all else lighter, so that the whole mass stays."""
    regressor, rows = squat_rows()
    masses = regressor.table()[::10]
    torso = regressor.names.index("torso")
    differs = np.zeros((len(regressor.names), PER_OWN))
    differs[:, 0] = -change * masses[torso] / (masses.sum() - masses[torso])
    differs[torso, 0] = change
    more = rows.asked @ (regressor.own(differs.ravel())[0] - regressor.table())
    given = replace(rows, given=rows.given + more)
    return estimate_from_rows(trial("squat").subject, regressor, [given], ("squat",))


@cache
def table():
    return of_torso(0.0)


@cache
def heavy():
    return of_torso(HEAVY)


def test_the_table_is_kept_where_it_is_right():
    assert table().log_ratio < 0.0
    assert not table().supported


def test_a_heavier_torso_is_found_and_supported():
    found = heavy()
    own = found.subject.inertia["torso"]
    assert found.supported
    assert min(found.log_ratio, found.held_out_log_ratio) > 0.0
    assert abs(own.mass_factor - 1.0 - HEAVY) < 3.0 * own.mass_factor_sd
    assert own.mass_factor_sd < 0.05
    assert found.after[1] < 0.7 * found.before[1]


def test_the_subject_carries_what_was_found():
    """Its body has the parameters of the estimate, mass and all."""
    found = heavy()
    regressor, _ = squat_rows()
    body = InertialRegressor(HumanModel.of(found.subject))
    np.testing.assert_allclose(body.table(), regressor.own(found.mean[:-PLACE])[0], atol=1e-10)
    assert found.mass_sd_kg < 0.01 * found.subject.mass_kg


def test_halves_are_the_whole():
    _, rows = squat_rows()
    first, second = halves(rows)
    np.testing.assert_array_equal(np.concatenate([first.given, second.given]), rows.given)


def test_a_capture_that_shows_too_little_keeps_the_table():
    subject, capture = trial("squat").subject, replace(recorded("squat"), plates=())
    with pytest.raises(NotObservable, match="no trial shows the inertia of segments"):
        estimate_inertia(subject, [capture])
    kept = with_inertia(subject, [capture])
    assert kept.inertia == {}
    assert kept.report[INERTIA_KEY]["written"] is False


def test_a_capture_gives_rows(true_motion):
    regressor, rows = rows_of(trial("squat").subject, squat_capture())
    np.testing.assert_allclose(regressor.table(), squat_rows()[0].table())
    np.testing.assert_allclose(rows.given, squat_rows()[1].given, atol=0.5)


def test_the_note_tells_what_was_found(true_motion, monkeypatch):
    """Inertial parameters from before do not count; those that the evidence is for are written."""
    monkeypatch.setattr(estimate, "estimate_from_rows", lambda *_: heavy())
    given = replace(trial("squat").subject, inertia={"torso": SegmentInertia(2.0)})
    found = with_inertia(given, [squat_capture()])
    own, note = heavy().subject.inertia, found.report[INERTIA_KEY]
    assert found.inertia == own
    assert note["written"] is True
    assert note["segments"]["torso"]["mass_percent"] == pytest.approx(
        100.0 * (own["torso"].mass_factor - 1.0)
    )
    monkeypatch.setattr(estimate, "estimate_from_rows", lambda *_: table())
    kept = with_inertia(given, [squat_capture()])
    assert kept.report[INERTIA_KEY]["written"] is False
    assert "the table is kept" in kept.report[INERTIA_KEY]["told"]
    assert kept.inertia == {}
