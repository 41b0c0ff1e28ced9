"""Exchanged names of a static trial: put right, reported, looked for in the trials that follow."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotConverged
from mbkf.io.static_exchanges import static_exchanges
from mbkf.model.protocol import load_protocol
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.standing_names import StandingNames
from mbkf.trial.preparation import static_names
from mbkf.trial.preparation.exchanged import names_put_right
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.static_names import (
    carried_pairs,
    exchanged_names,
    markers_as_scaled,
    static_exchange_note,
    static_put_right,
    under_names_of_static,
)
from mbkf.trial.scale import EXCHANGED_KEY, scale
from tests.motions import capture_of, marker_positions, moderate_pose, protocol_sensor, random_model

MODEL = random_model(np.random.default_rng(7), spread=0.03)
SENSOR, NAMES = protocol_sensor(MODEL)
PAIR = ("RKNE", "LKNE")
FEW = ScalingSettings(frames_per_trial=3)


def made(poses):
    return capture_of(NAMES, marker_positions(SENSOR, poses))


def wrong(capture, *pairs):
    return replace(capture, markers=exchanged_names(capture.markers, pairs))


STATIC = made([MODEL.neutral()] * 2)
TRIAL = made([moderate_pose(MODEL, np.random.default_rng(seed), spread=0.4) for seed in range(8)])


@pytest.fixture(scope="module")
def subject():
    return scale(wrong(STATIC, PAIR), mass_kg=70.0, settings=FEW)


def test_the_person_is_scaled_from_names_put_right(subject):
    right = scale(STATIC, mass_kg=70.0, settings=FEW)
    assert static_exchanges(subject) == (PAIR[::-1],) or static_exchanges(subject) == (PAIR,)
    assert static_exchanges(right) == ()
    assert subject.scale_factors == right.scale_factors


def test_names_are_kept_on_request():
    kept = scale(wrong(STATIC, PAIR), mass_kg=70.0, settings=replace(FEW, correct_names=False))
    assert static_exchanges(kept) == ()
    assert kept.scale_factors != scale(STATIC, mass_kg=70.0, settings=FEW).scale_factors


def test_a_trial_with_the_same_exchange_is_put_right_and_reported(subject):
    measured = subject_markers(wrong(TRIAL, PAIR).markers, subject)
    right, told = names_put_right(measured, subject)
    assert np.array_equal(right.positions_m, subject_markers(TRIAL.markers, subject).positions_m)
    assert [({a, b}, frames) for a, b, frames in told] == [(set(PAIR), 8)]
    assert np.array_equal(
        markers_as_scaled(wrong(TRIAL, PAIR).markers, subject).positions_m, right.positions_m
    )


def test_a_trial_with_right_names_stays(subject):
    measured = subject_markers(TRIAL.markers, subject)
    assert carried_pairs(measured, subject) == ()
    assert names_put_right(measured, subject) == (measured, ())


def test_scaling_takes_trials_with_the_same_exchange():
    both = scale(wrong(STATIC, PAIR), [wrong(TRIAL, PAIR)], mass_kg=70.0, settings=FEW)
    right = scale(STATIC, [TRIAL], mass_kg=70.0, settings=FEW)
    assert both.scale_factors == right.scale_factors
    assert [sorted(one[:2]) + one[2:] for one in both.report[EXCHANGED_KEY]] == [["LKNE", "RKNE", 8]]


@pytest.mark.parametrize(
    ("misfit", "stray", "refused"), [(9.0, False, True), (9.0, True, False), (7.0, False, False)]
)
def test_a_static_that_fits_no_one_is_refused_with_its_markers(monkeypatch, misfit, stray, refused):
    found = StandingNames((), 0.0, misfit, misfit, ("RKNE", "LANK"), stray)
    monkeypatch.setattr(static_names, "likeliest_names", lambda *_: found)
    if not refused:
        assert static_put_right(STATIC, load_protocol("reference36"))[1] == ()
        return
    with pytest.raises(NotConverged, match=r"RKNE and LANK.*--keep-names"):
        static_put_right(STATIC, load_protocol("reference36"))


def test_a_stream_goes_on_under_its_own_names(subject):
    own = under_names_of_static(subject)
    as_named = {marker.name: marker.position_m for marker in own.markers}
    right = {marker.name: marker.position_m for marker in subject.markers}
    assert np.array_equal(as_named["RKNE"], right["LKNE"])
    assert np.array_equal(as_named["RANK"], right["RANK"])
    measured = subject_markers(wrong(TRIAL, PAIR).markers, own)
    assert carried_pairs(measured, own) == ()
    assert {one for one in own.covariance.markers} == {one for one in subject.covariance.markers}


def test_the_sentence_names_the_pairs_and_the_option():
    assert static_exchange_note(()) == ""
    assert "A and B, C and D" in static_exchange_note([("A", "B"), ("C", "D")])
    assert "--keep-names" in static_exchange_note([("A", "B")])
