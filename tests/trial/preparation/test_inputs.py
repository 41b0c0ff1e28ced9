"""What a filter is built from: the trial's markers in their order, and the dofs that none of them shows."""

from dataclasses import replace

import numpy as np

from mbkf.io.body_covariance import BodyCovariance
from mbkf.model.clinical import dof_names
from mbkf.trial.preparation.inputs import MIN_PRESENT, trial_inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.walker import walker


def shown(names):
    trial, subject = walker().trial, walker().subject
    columns = [trial.markers.names.index(name) for name in names]
    positions = trial.markers.positions_m[:, columns]
    return replace(trial.markers, names=tuple(names), positions_m=positions), trial.plates, subject


def test_markers_keep_the_order_of_the_trial():
    names = ["RKNE", "LKNE", "LASI", "RASI", "SACR"]
    names = [name for name in names if name in walker().trial.markers.names]
    markers, plates, subject = shown(names)
    inputs, recording = trial_inputs(markers, plates, subject, ReconstructSettings())
    noise = {marker.name: marker.noise_m for marker in subject.markers}
    np.testing.assert_array_equal(inputs.noise_m, [noise[name] for name in names])
    assert inputs.dt_s == recording.dt_s == 1.0 / markers.rate_hz
    assert recording.plates.shape == (markers.frames, len(plates), 6)
    assert recording.markers_m is markers.positions_m


def test_a_marker_that_is_hardly_seen_shows_no_dof():
    markers, plates, subject = shown(walker().trial.markers.names)
    complete, _ = trial_inputs(markers, plates, subject, ReconstructSettings())
    assert complete.unobservable.sum() < complete.unobservable.size
    positions = np.full_like(markers.positions_m, np.nan)
    positions[0] = markers.positions_m[0]
    assert MIN_PRESENT * markers.frames > 1.0
    hidden, _ = trial_inputs(replace(markers, positions_m=positions), plates, subject, ReconstructSettings())
    assert hidden.unobservable.all()


def test_noise_that_stays_is_told_as_wider_white_noise():
    markers, plates, subject = shown(walker().trial.markers.names)
    first, *others = subject.markers
    keypoint = replace(first, noise_m=0.02, correlated_m=0.01, correlation_s=0.3)
    subject = replace(subject, markers=(keypoint, *others))
    settings = ReconstructSettings()
    inputs, _ = trial_inputs(markers, plates, subject, settings)
    column = markers.names.index(first.name)
    own = {marker.name: marker.noise_m for marker in subject.markers}
    skin = np.array([own[name] for name in markers.names])
    assert inputs.noise_m[column] > 0.04
    assert inputs.spread_m is not None and inputs.spread_m[column] == 0.02
    np.testing.assert_array_equal(np.delete(inputs.noise_m, column), np.delete(skin, column))
    share = settings.dynamic.markers.innovation_share
    np.testing.assert_allclose(np.delete(inputs.spread_m, column), np.delete(share**0.5 * skin, column))
    assert trial_inputs(*shown(walker().trial.markers.names), settings)[0].spread_m is None


def test_filters_and_inverse_dynamics_read_the_same_cleaned_plates():
    markers, plates, subject = shown(walker().trial.markers.names)
    clean, recording = trial_inputs(markers, plates, subject, ReconstructSettings())
    assert clean.plates is plates or all(a is b for a, b in zip(clean.plates, plates, strict=True))
    assert clean.remarks == ()
    force = np.array(plates[1].force_n)
    force[700, 2] = 1e9
    faulty = (plates[0], replace(plates[1], force_n=force), *plates[2:])
    inputs, repaired = trial_inputs(markers, faulty, subject, ReconstructSettings())
    (remark,) = inputs.remarks
    assert "plate '2'" in remark
    assert np.abs(inputs.plates[1].force_n - plates[1].force_n).max() < 20.0
    np.testing.assert_allclose(repaired.plates, recording.plates, atol=20.0)


def test_a_marker_that_scaling_did_not_see_may_be_anywhere_its_session_allows():
    """All but the skin being known, it turns the leg that it is on."""
    markers, plates, subject = shown(walker().trial.markers.names)
    settings, factors = ReconstructSettings(), tuple(subject.scale_factors)
    assert trial_inputs(markers, plates, replace(subject, covariance=None), settings)[0].body is None
    q, found = walker().truth.q[50], []
    for unseen in (None, "RKNE"):
        names = tuple(marker.name for marker in subject.markers if marker.name != unseen)
        known = BodyCovariance(factors, names, 1e-9 * np.eye(len(factors) + 3 * len(names)))
        inputs, _ = trial_inputs(markers, plates, replace(subject, covariance=known), settings)
        found.append(np.linalg.norm(inputs.body.pose_root(q), axis=1))
    person = replace(subject, covariance=known)
    assert trial_inputs(markers, plates, person, settings, body_errors=False)[0].body is None
    more = np.sqrt(np.maximum(found[1] ** 2 - found[0] ** 2, 0.0))
    largest = dof_names(inputs.sensor.model)[int(more.argmax())]
    assert largest.startswith(("right_thigh", "right_shank", "right_foot")) and more.max() > 0.01
    other = [not name.startswith("right") for name in dof_names(inputs.sensor.model)]
    assert more[other].max() < 0.5 * more.max()


def test_a_joint_that_few_markers_show_may_be_held_otherwise_than_the_prior_has_it():
    """The rest of the body is known exactly, and the skin as good as that: of the hand's turn most of 5° is left."""
    markers, plates, subject = shown(walker().trial.markers.names)
    factors, names = tuple(subject.scale_factors), tuple(marker.name for marker in subject.markers)
    size = len(factors) + 9 * len(names)
    person = replace(subject, covariance=BodyCovariance(factors, names, np.zeros((size, size)), 2))
    inputs, _ = trial_inputs(markers, plates, person, ReconstructSettings())
    spread = np.linalg.norm(inputs.body.pose_root(walker().truth.q[50]), axis=1)
    turn = dof_names(inputs.sensor.model).index("right_hand_z")
    assert 0.7 < spread[turn] / inputs.sensor.model.posture_sd[turn] < 1.0


def test_errors_by_the_body_beside_a_hole_are_those_under_the_narrower_prior_there():
    """Without markers on the pelvis, skin turns the thighs about their length by more than people's postures differ."""
    person = walker().subject
    segments = {marker.name: marker.segment for marker in person.markers}
    names = [name for name in walker().trial.markers.names if segments.get(name, "pelvis") != "pelvis"]
    markers, plates, _ = shown(names)
    factors, known = tuple(person.scale_factors), tuple(segments)
    size = len(factors) + 9 * len(known)
    person = replace(person, covariance=BodyCovariance(factors, known, np.zeros((size, size)), 2))
    inputs, _ = trial_inputs(markers, plates, person, ReconstructSettings())
    spread = np.linalg.norm(inputs.body.pose_root(walker().truth.q[50]), axis=1)
    turn = dof_names(inputs.sensor.model).index("right_thigh_z")
    assert 0.35 < spread[turn] / inputs.sensor.model.posture_sd[turn] < 0.9
