"""A person who stands up from a chair that no plate measures, recorded and followed: what the seat bore."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.tracking import track
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.supports.block import BEARING
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.live.filter import LiveFilter
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.other_contacts import contact_opener, with_other_contacts
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.dynamics import trial
from tests.supported import SEAT, seat, seated

QUIET = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.0, occlusion=0.0, offset_n=(0.0, 0.0))
SETTINGS = ReconstructSettings(smooth=False, correct_markers=False)
SETTLED = slice(15, None)
"""Frames in which the filter no longer settles."""


@cache
def prepared(name):
    """What filters of a trial are built from and read, before and after the search."""
    made = trial(name)
    recorded = synthesise_capture(made.subject, made.motion, QUIET, seed=1).trial
    markers = recorded.markers
    inputs, recording = trial_inputs(markers, recorded.plates, made.subject, SETTINGS)
    alone = markers_alone(inputs, recording)
    return recorded, inputs, recording, with_other_contacts(inputs, recording, markers.times_s, alone)


@cache
def followed(smooth):
    """The trial through the filter."""
    inputs, recording = prepared("sit_to_stand")[3]
    filter = tracking_filter("dynamic", inputs)
    assert isinstance(filter.report, DynamicReport)
    return track(filter, recording, smoothing=SmoothingSettings() if smooth else None)


def leg_torques(found):
    """(T, 12) errors of the torques at hips and knees, N m/kg, and their standard deviations."""
    model, motion = seated().model, seated().motion
    dofs = np.concatenate(
        [
            np.arange(model.nv)[model.joint(f"{side}_{name}").v]
            for side in ("right", "left")
            for name in ("thigh", "shank")
        ]
    )
    balance = NewtonEuler(model)
    states = zip(found.q, found.v, found.a, found.wrench.reshape(-1, 12), strict=True)
    tau = np.array([balance.tau(*state) for state in states])
    return ((tau - motion.tau) / model.mass_kg)[:, dofs], (found.torque_sd / model.mass_kg)[:, dofs]


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_who_only_stands_is_followed_as_before():
    """Nothing is found, and nothing is changed."""
    _, inputs, recording, (after, read) = prepared("squat")
    assert after == replace(inputs)
    assert read is recording


def test_a_seat_is_found_in_what_instruments_read():
    _, before, recording, (inputs, read) = prepared("sit_to_stand")
    assert not before.other_contacts and BEARING not in recording.readings
    assert inputs.other_contacts
    assert inputs.remarks == before.remarks
    flags, weight_n = read.readings[BEARING], GRAVITY_M_S2 * seated().model.mass_kg
    true = np.linalg.norm(seat(seated().motion)[:, :3], axis=1) > 0.05 * weight_n
    assert set(np.unique(flags)) == {0.0, 1.0}
    assert not np.delete(flags, SEAT, axis=1).any()
    assert np.abs(flags[:, SEAT] - true).sum() <= 0.1 * seated().motion.rate_hz


@pytest.mark.parametrize("factor", [0.85, 1.1])
def test_a_wrong_mass_is_named_and_opens_no_contact(factor):
    """A body that is stated too heavy seems to be held up by its torso."""
    recorded, *_ = prepared("squat")
    person = replace(trial("squat").subject, mass_kg=factor * trial("squat").subject.mass_kg)
    inputs, recording = trial_inputs(recorded.markers, recorded.plates, person, SETTINGS)
    alone = markers_alone(inputs, recording)
    found, read = with_other_contacts(inputs, recording, recorded.markers.times_s, alone)
    assert {one.cause for one in found.contradictions} == {"mass"}
    assert not found.other_contacts and read is recording and found.remarks == inputs.remarks


def test_what_blocks_of_ones_own_read_stays():
    _, inputs, recording, _ = prepared("sit_to_stand")
    own = replace(recording, readings={"mine": np.arange(len(recording))})
    _, read = with_other_contacts(inputs, own, seated().motion.times_s, markers_alone(inputs, recording))
    assert set(read.readings) == {"mine", BEARING}
    assert read.readings["mine"] is own.readings["mine"]


def test_a_body_without_such_parts_is_not_searched():
    _, inputs, recording, _ = prepared("sit_to_stand")
    model = inputs.sensor.model
    bare = type(model)(replace(model.description, bearings={}), model.scale, model.mass_kg)
    inputs = replace(inputs, sensor=type(inputs.sensor)(bare, inputs.sensor.segments, inputs.sensor.local_m))
    alone = markers_alone(inputs, recording)
    assert with_other_contacts(inputs, recording, seated().motion.times_s, alone) == (inputs, recording)


@pytest.mark.parametrize(("smooth", "share"), [(False, 0.06), (True, 0.03)])
def test_the_seats_force_is_the_true_one(smooth, share):
    """RMS of the force's error, in body weights; the feet's own stay what the plates read."""
    found, motion = followed(smooth), seated().motion
    error = found.support[:, SEAT] - seat(motion)
    assert rms(np.linalg.norm(error[:, :3], axis=1)) <= share * GRAVITY_M_S2 * seated().model.mass_kg
    assert not np.delete(found.support, SEAT, axis=1).any()
    assert rms((found.wrench - motion.foot_wrench)[SETTLED, :, :3]) < 3.0


@pytest.mark.parametrize("smooth", [False, True])
def test_the_seats_wrench_errs_as_it_says(smooth):
    found = followed(smooth)
    bears = (found.support_sd[:, SEAT] > 0.0).all(axis=1)
    error = np.abs(found.support - seat(seated().motion)[:, None])[bears, SEAT]
    assert bears.sum() > 50
    assert (error <= 3.0 * found.support_sd[bears, SEAT]).mean() >= 0.95
    np.testing.assert_array_equal(found.support_sd[~bears], 0.0)


@pytest.mark.parametrize("smooth", [False, True])
def test_torques_of_hips_and_knees_are_the_true_ones(smooth):
    error, sd = leg_torques(followed(smooth))
    assert np.sqrt(np.mean(error[SETTLED] ** 2, axis=0)).max() <= 0.15
    assert (np.abs(error) <= 3.0 * sd)[SETTLED].mean() >= 0.95


@cache
def on_the_way():
    """The trial through the causal filter, which opens contacts on its way."""
    _, inputs, recording, _ = prepared("sit_to_stand")
    filter = tracking_filter("dynamic", inputs)
    return track(filter, recording, contacts=contact_opener(inputs, SETTINGS))


def test_a_causal_filter_opens_the_seat_within_a_second_and_closes_it():
    found, weight_n = on_the_way(), GRAVITY_M_S2 * seated().model.mass_kg
    opened, true = np.nan_to_num(found.support[:, SEAT]).any(axis=1), seat(seated().motion)[:, 2]
    assert not np.nan_to_num(np.delete(found.support, SEAT, axis=1)).any()
    first = int(np.argmax(opened))
    assert true[0] > 0.5 * weight_n and 0 < first <= seated().motion.rate_hz
    bears = opened & (true > 0.08 * weight_n)
    assert bears.sum() > 10 and opened[first:][true[first:] > 0.08 * weight_n].all()
    assert found.support[bears, SEAT, 2].mean() == pytest.approx(true[bears].mean(), rel=0.15)
    assert not opened[-20:].any()


def test_from_when_it_has_opened_the_seat_is_as_if_it_had_been_known():
    """The frames in which it bore already are taken again."""
    found, known = on_the_way(), followed(False)
    opened = np.nan_to_num(found.support[:, SEAT]).any(axis=1) & known.support[:, SEAT].any(axis=1)
    error = np.linalg.norm((found.support - known.support)[opened, SEAT, :3], axis=1)
    assert error.max() < 0.05 * GRAVITY_M_S2 * seated().model.mass_kg
    off = np.array(
        [seated().model.difference(*pair) for pair in zip(found.q[opened], known.q[opened], strict=True)]
    )
    assert np.abs(off).max() < 0.01
    assert (found.support_sd[opened, SEAT] > 0.0).all()


def test_a_live_filter_takes_the_same_steps():
    _, inputs, recording, _ = prepared("sit_to_stand")
    live, expected = (
        LiveFilter(tracking_filter("dynamic", inputs), 0.0, contact_opener(inputs, SETTINGS)),
        on_the_way(),
    )
    steps = []
    for t in range(len(recording)):
        steps += live.push(t, recording.frame(t))
        live.predict()
    for step in steps:
        np.testing.assert_array_equal(step.estimate.q, expected.q[step.number])
        given = np.nan if step.estimate.support is None else step.estimate.support
        np.testing.assert_array_equal(
            np.zeros_like(expected.support[0]) + given, expected.support[step.number]
        )


def test_a_causal_filter_is_told_of_no_missing_force():
    """Contacts of later frames are not known then."""
    recorded, inputs, recording, _ = prepared("sit_to_stand")
    alone = markers_alone(inputs, recording)
    found, read = with_other_contacts(inputs, recording, recorded.markers.times_s, alone, missing=False)
    assert read is recording and not found.other_contacts


@pytest.mark.parametrize("changes", [{"filter": "kinematic"}, {"other_contacts": False}])
def test_contacts_open_for_the_dynamic_filter_and_where_they_are_wanted(changes):
    inputs = prepared("squat")[1]
    assert contact_opener(inputs, SETTINGS) is not None
    assert contact_opener(inputs, replace(SETTINGS, **changes)) is None
    assert contact_opener(replace(inputs, plates=()), SETTINGS) is None


@pytest.mark.slow
def test_reconstruct_asks_unless_told_that_only_feet_bear():
    recorded = prepared("sit_to_stand")[0]
    smoothed, opens = replace(SETTINGS, smooth=True), SETTINGS
    found = reconstruct(recorded, seated().subject, settings=smoothed)
    np.testing.assert_allclose(found.q, followed(True).q, atol=1e-9)
    np.testing.assert_allclose(found.foot_wrench, followed(True).wrench, atol=1e-6)
    causal = reconstruct(recorded, seated().subject, settings=opens)
    np.testing.assert_allclose(causal.q, on_the_way().q, atol=1e-9)
    assert not np.isnan(causal.support_wrench).any()
    plain = reconstruct(recorded, seated().subject, settings=replace(opens, other_contacts=False))
    bears = causal.support_wrench[:, SEAT].any(axis=1) & (seat(seated().motion)[:, 2] > 100.0)
    ours, theirs = (rms((one.a - seated().motion.a)[bears, :3]) for one in (causal, plain))
    assert ours < 0.5 * theirs, "a body that nothing holds falls"
