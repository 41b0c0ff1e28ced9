"""A tracker for a loop of one's own gives what `reconstruct` gives causally, and takes blocks of one's own."""

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from scipy.optimize import brentq

import mbkf
from mbkf.errors import InvalidInput, NotObservable, ShapeError
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import NO_SLIDES
from mbkf.model.human import HumanModel
from mbkf.scaling.correction import correct_markers
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.live.filter import live_inputs
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.plants.damped import Damped

FRAMES = 45


@cache
def squat():
    """A person whose factors are known to 2 % and markers to 5 mm, and the beginning of the trial."""
    person, recorded = mbkf.synthesise("squat", seconds=2.0, seed=4)
    factors, markers = tuple(person.scale_factors), tuple(marker.name for marker in person.markers)
    sd = np.concatenate([np.full(len(factors), 0.02), np.full(3 * len(markers), 0.005)])
    person = replace(person, covariance=BodyCovariance(factors, markers, np.diag(sd)))
    markers = recorded.trial.markers
    short = replace(markers, positions_m=markers.positions_m[: FRAMES + 15])
    trial = replace(recorded.trial, markers=short)
    return person, trial, mbkf.plate_wrenches(trial.plates, trial.markers.times_s, trial.markers.rate_hz)


def followed(blocks=None, settings=None, plates=None, readings=None, plant=None):
    person, trial, wrenches = squat()
    plates = trial.plates if plates is None else plates
    tracker = mbkf.Tracker(
        person,
        trial.markers.names,
        plates,
        trial.markers.rate_hz,
        settings=settings,
        blocks=blocks,
        plant=plant,
    )
    found = []
    for t in range(FRAMES):
        own = {} if readings is None else {name: values[t] for name, values in readings.items()}
        tracker.push(trial.markers.positions_m[t], wrenches[t, : len(plates)], readings=own)
        found += tracker.answers
    return tracker, found


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_it_takes_the_causal_steps_of_reconstruct(name):
    person, trial, _ = squat()
    settings = ReconstructSettings(filter=name, smooth=False, correct_markers=False, pelvis="lab")
    result = mbkf.reconstruct(trial, person, settings=settings)
    _, found = followed(settings=settings)
    assert [one.number for one in found] == list(range(len(found)))
    for one in found[::10]:
        t = one.number
        np.testing.assert_array_equal(one.q, result.q[t])
        np.testing.assert_array_equal(one.q_sd, result.sd_q[t])
        np.testing.assert_array_equal(one.q_sd_offset, result.sd_q_offset[t])
        np.testing.assert_array_equal(one.v_sd_offset, result.sd_v_offset[t])
        assert (one.q_sd_offset[6:] > 0.0).any() and (one.q_sd_offset < one.q_sd).all()
        for k, coordinate in enumerate(result.coordinate_names):
            assert one.angles[coordinate] == pytest.approx(result.angles[t, k], abs=1e-12)
            assert one.angles_sd[coordinate] == pytest.approx(result.angles_sd[t, k], rel=1e-9)
            assert one.angles_sd_offset[coordinate] == pytest.approx(result.angles_sd_offset[t, k], rel=1e-9)
        if name == "dynamic":
            np.testing.assert_allclose(one.tau, result.tau[t], atol=1e-9)
            np.testing.assert_array_equal(one.wrenches, result.foot_wrench[t])
            np.testing.assert_array_equal(one.wrenches_sd, result.foot_wrench_sd[t])
            np.testing.assert_array_equal(one.wrenches_sd_offset, result.foot_wrench_sd_offset[t])
            offset = result.moment_sd("knee_angle_r", "offset")[t]
            assert one.torques_sd_offset["knee_angle_r"] == pytest.approx(offset)
            assert one.torques["knee_angle_r"] == pytest.approx(result.torque("knee_angle_r")[t])
            assert one.torques_sd["knee_angle_r"] == pytest.approx(result.torque_sd("knee_angle_r")[t])


def test_frames_before_a_start_are_answered_with_it():
    person, trial, wrenches = squat()
    tracker = mbkf.Tracker(person, trial.markers.names, trial.plates, trial.markers.rate_hz)
    answers = []
    for t in range(30):
        estimate = tracker.push(trial.markers.positions_m[t], wrenches[t])
        answers.append((estimate is not None, len(tracker.answers)))
    first = next(t for t, (there, _) in enumerate(answers) if there)
    assert answers[first][1] == first + 1
    assert all(given == (True, 1) for given in answers[first + 1 :])


def test_frames_that_wait_are_answered_at_the_end():
    person, trial, wrenches = squat()
    tracker = mbkf.Tracker(person, trial.markers.names, trial.plates, trial.markers.rate_hz)
    for t in range(5):
        assert tracker.push(trial.markers.positions_m[t], wrenches[t]) is None
    assert [one.number for one in tracker.finish()] == list(range(5))


def test_with_a_lag_it_gives_the_frame_before_it_as_reconstruct_does():
    person, trial, wrenches = squat()
    settings = ReconstructSettings(lag_s=0.06, correct_markers=False)
    result = mbkf.reconstruct(trial, person, settings=settings)
    tracker = mbkf.Tracker(
        person, trial.markers.names, trial.plates, trial.markers.rate_hz, settings=settings
    )
    given = {}
    for t in range(40):
        estimate = tracker.push(trial.markers.positions_m[t], wrenches[t])
        if estimate is not None:
            given[t] = estimate
    assert {t: one.number for t, one in given.items()} == {t: t - 6 for t in range(min(given), 40)}
    assert len(given) > 10
    for one in given.values():
        np.testing.assert_array_equal(one.q, result.q[one.number])
        np.testing.assert_array_equal(one.wrenches, result.foot_wrench[one.number])
        assert (one.wrenches_sd >= result.foot_wrench_sd[one.number] * (1 - 1e-9)).all()
    assert [one.number for one in tracker.finish()] == list(range(34, 40))


class Barometer(mbkf.Block):
    """A reading of the pelvis's height, with a bias of its own in the state."""

    def states(self):
        return [mbkf.ExtraState("barometer", np.zeros(1), np.ones(1), np.zeros(1))]

    def bind(self, layout, body):
        self.bias, self.index = layout["barometer"].start, layout.extra_index("barometer")

    def decide(self, at, frame, memory, notes):
        return frame.readings["height"]

    def linearise(self, at, decision):
        up = 2.0 * np.array(
            [
                at.state.q[3] * at.state.q[5] - at.state.q[6] * at.state.q[4],
                at.state.q[4] * at.state.q[5] + at.state.q[6] * at.state.q[3],
                0.5 - at.state.q[3] ** 2 - at.state.q[4] ** 2,
            ]
        )
        away = decision - at.state.q[2] - at.state.extra[self.index]
        row = np.zeros((1, self.bias + 1))
        row[0, :3], row[0, self.bias] = up, 1.0
        return mbkf.Rows(row / 0.01, away / 0.01, readings=1)


def test_a_block_of_ones_own_may_bring_a_state():
    """A barometer that reads 0.3 m too much: its bias is found, and the body stays where markers have it."""
    person, trial, _ = squat()
    plain = followed()[1]
    heights = np.array([plain[min(t, len(plain) - 1)].q[2] for t in range(FRAMES)]) + 0.3
    blocks = [*mbkf.standard_blocks(person, trial.markers.names, trial.plates, 100.0), Barometer()]
    _, found = followed(blocks, readings={"height": heights})
    state = found[-1].posterior.record.state
    assert state.extra[-1] == pytest.approx(0.3, abs=0.01)
    assert abs(found[-1].q[2] - plain[-1].q[2]) < 0.005


def test_offline_takes_blocks_and_readings_too():
    person, trial, _ = squat()
    causal = ReconstructSettings(smooth=False)
    plain = mbkf.reconstruct(trial, person, settings=causal)
    heights = {"height": plain.q[:, 2] + 0.3}
    result = mbkf.reconstruct(trial, person, settings=causal, blocks=[Barometer()], readings=heights)
    counted = result.nis_readings - plain.nis_readings
    assert counted[0] == 0 and (counted[1:] == 1).all()  # a start counts no reading
    assert np.abs(result.q[:, 2] - plain.q[:, 2]).max() < 0.005


def test_a_plant_of_ones_own_takes_the_same_steps_live_and_offline():
    person, trial, _ = squat()
    settings = ReconstructSettings(smooth=False, correct_markers=False, checks=False, other_contacts=False)
    result = mbkf.reconstruct(trial, person, settings=settings, plant=Damped)
    _, found = followed(plant=partial(Damped, fades_s=0.3))
    standard = followed()[1][30]
    for one in found[::10]:
        np.testing.assert_array_equal(one.q, result.q[one.number])
        np.testing.assert_array_equal(one.q_sd, result.sd_q[one.number])
    assert found[30].tracked and np.abs(found[30].q - standard.q).max() > 1e-6


def test_wrong_arrays_and_filters_are_refused():
    person, trial, wrenches = squat()
    tracker = mbkf.Tracker(person, trial.markers.names, trial.plates, 100.0)
    with pytest.raises(ShapeError, match="markers_m"):
        tracker.push(trial.markers.positions_m[0, :-1], wrenches[0])
    with pytest.raises(ShapeError, match="wrenches"):
        tracker.push(trial.markers.positions_m[0], wrenches[0, :1])
    with pytest.raises(NotObservable):
        mbkf.Tracker(person, ["a", "b"])
    with pytest.raises(InvalidInput, match="dynamic"):
        mbkf.Tracker(person, settings=ReconstructSettings(filter="kinematic"), blocks=[Barometer()])
    with pytest.raises(InvalidInput, match=r"has not seen yet; leave it out, or give a lag \(lag_s\)"):
        mbkf.Tracker(person, settings=ReconstructSettings(smooth=True))


@pytest.mark.parametrize("nonsense", [1e9, -1e5, np.inf])
def test_a_reading_that_the_person_cannot_make_is_one_that_was_not_made(nonsense):
    person, trial, wrenches = squat()
    found = []
    for value in (np.nan, nonsense):
        tracker = mbkf.Tracker(person, trial.markers.names, trial.plates, trial.markers.rate_hz)
        answers = []
        for t in range(35):
            pushed = wrenches[t].copy()
            if t == 31:
                pushed[0] = np.nan if np.isnan(value) else pushed[0]
                pushed[0, 2] = value
            tracker.push(trial.markers.positions_m[t], pushed)
            answers += tracker.answers
        found.append(answers)
    for missing, refused in zip(*found, strict=True):
        np.testing.assert_array_equal(refused.q, missing.q)
        np.testing.assert_array_equal(refused.wrenches, missing.wrenches)


def squatting(model, depth, lean):
    """Hips bent by 105° and knees by 100° at a depth of 1, the pelvis turned forward, soles flat on one place."""
    bent = np.zeros(model.nv)
    bent[4] = lean
    turned = {"thigh": np.radians(-105.0) * depth, "shank": np.radians(100.0) * depth}
    turned["foot"] = -lean - sum(turned.values())
    for segment, turn in turned.items():
        for side in ("right", "left"):
            dofs = model.joint(f"{side}_{segment}").v
            bent[dofs.start + (dofs.stop - dofs.start > 1)] = turn
    q = model.integrate(model.neutral(), bent)
    q[:3] -= sole_points(model, q[None])[0].mean(axis=(0, 1))
    return q


def balanced(model, depth):
    """A squat whose centre of mass is above the middle of the soles."""
    return squatting(
        model, depth, brentq(lambda lean: model.centre_of_mass(squatting(model, depth, lean))[0], -0.5, 1.5)
    )


@cache
def deep_squat():
    """A person whose skin moves by a centimetre at 60°, the poses of a squat to 105°, and its exact markers."""
    rng, (person, _, _) = np.random.default_rng(3), squat()
    model, segments = HumanModel.of(person), [marker.segment for marker in person.markers]
    skin = FlexedSkin(model, segments)
    slides = rng.normal(0.0, 0.01, (len(segments), skin.flexions, 3))
    sensor = MarkerSensor(model, segments, np.array([marker.position_m for marker in person.markers]))
    poses, places = [], []
    for depth in np.sin(np.linspace(0.0, np.pi, 80)):
        q = balanced(model, depth)
        moved = np.einsum("md,mdi->mi", skin.shares(q), slides)
        axes = model.placements(q)[0][sensor.joint_ids]
        poses.append(q)
        places.append(sensor.positions(q) + np.einsum("mij,mj->mi", axes, moved))
    known = tuple(replace(m, slides_m=c) for m, c in zip(person.markers, slides, strict=True))
    return replace(person, markers=known, covariance=None), np.array(poses), np.array(places)


def angle_errors_deg(person, name):
    """(frames, 4) errors of hips' and knees' flexion in the deepest frames of the squat, followed live."""
    _, poses, places = deep_squat()
    tracker = mbkf.Tracker(person, rate_hz=50.0, settings=ReconstructSettings(filter=name))
    found = []
    for frame in places:
        tracker.push(frame)
        found += tracker.answers
    clinical = mbkf.ClinicalAngles(HumanModel.of(person))
    columns = [
        clinical.names.index(f"{joint}_{side}") for joint in ("hip_flexion", "knee_angle") for side in "rl"
    ]
    own = np.array([[one.angles[clinical.names[k]] for k in columns] for one in found[30:50]])
    return np.degrees(own - clinical.angles(poses[30:50])[:, columns])


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_a_deep_squat_is_followed_live_on_skin_that_moves_as_scaling_found(name):
    person, _, _ = deep_squat()
    rigid = replace(person, markers=tuple(replace(m, slides_m=NO_SLIDES) for m in person.markers))
    known, neutral = angle_errors_deg(person, name), angle_errors_deg(rigid, name)
    assert np.abs(known).max() < 0.3
    assert np.abs(neutral).max() > 2.0


def test_live_places_are_those_of_a_corrected_trial_on_the_average_of_its_postures():
    person, poses, places = deep_squat()
    trial = MarkerTrajectories(tuple(marker.name for marker in person.markers), places, 50.0)
    corrected = correct_markers(person, trial)
    live = live_inputs(trial.names, 50.0, (), corrected, ReconstructSettings()).inputs.sensor
    usual = np.mean([live.local_at(q) for q in poses], axis=0)
    offline, _ = trial_inputs(trial, (), corrected, ReconstructSettings())
    away = np.linalg.norm(offline.sensor.local_at(poses[0]) - usual, axis=1)
    neutral = np.linalg.norm(live.local_at(HumanModel.of(person).neutral()) - usual, axis=1)
    assert away.max() < 1e-4
    assert neutral.max() > 0.01


def test_kept_markers_follow_the_posture_also_of_a_person_who_was_corrected_on_another_trial():
    person, poses, places = deep_squat()
    trial = Capture("", MarkerTrajectories(tuple(marker.name for marker in person.markers), places, 50.0))
    moved = [
        replace(m, position_m=m.position_m + 0.5 * m.slides_m.sum(axis=0), slid=np.full(len(m.slides_m), 0.5))
        for m in person.markers
    ]
    kept = ReconstructSettings(
        filter="kinematic", correct_markers=False, smooth=False, checks=False, pelvis="lab"
    )
    found = mbkf.reconstruct(trial, replace(person, markers=tuple(moved)), settings=kept)
    model = HumanModel.of(person)
    away = [model.difference(q, own) for q, own in zip(poses[30:50], found.q[30:50], strict=True)]
    assert np.degrees(np.abs(away)[:, 6:12]).max() < 0.3
    assert np.linalg.norm(found.predicted_m - places, axis=2)[30:50].max() < 1e-3
