"""Scaling a made-up person whose size and marker places are known."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotConverged, NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.scaling import search
from mbkf.scaling.fit import factor_covariance, scale_subject
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import marker_positions, moderate_pose, reference_model

PROTOCOL = load_protocol("reference36")
BODY = reference_model().description
NAMES = tuple(m.name for m in PROTOCOL.markers)


class Person:
    """Known factors; anatomical markers exactly in place and technical ones up to 3 cm off, or all as expected."""

    def __init__(self, seed, spread=0.08, drawn_from_prior=False, pelvis=1.0):
        rng, prior = np.random.default_rng(seed), ScalingSettings()
        self.factors = rng.uniform(0.95, 1.08) * rng.uniform(1 - spread / 2, 1 + spread / 2, 17)
        self.factors = np.append(
            self.factors, pelvis * self.factors[2]
        )  # pelvis and torso share their vertical one
        technical = np.array([[m.kind == "technical"] for m in PROTOCOL.markers])
        self.offsets_m = technical * rng.uniform(-0.03, 0.03, (len(NAMES), 3))
        if drawn_from_prior:
            spread = factor_covariance(BODY, 0.3 * prior.stature_sd, prior)
            self.factors = 1.0 + np.linalg.cholesky(spread) @ rng.normal(size=18)
            self.offsets_m = np.array([[m.placement_sd_m] for m in PROTOCOL.markers]) * rng.normal(
                size=(len(NAMES), 3)
            )
        self.model = HumanModel(BODY, self.factors, 72.0)
        scale = [self.model.axis_scale(BODY.segment(m.segment)) for m in PROTOCOL.markers]
        places = np.array(scale) * np.array([m.position_m for m in PROTOCOL.markers]) + self.offsets_m
        self.sensor = MarkerSensor(self.model, [m.segment for m in PROTOCOL.markers], places)
        self.rng = rng

    def moving(self, frames=20, noise_m=0.0):
        poses = [moderate_pose(self.model, self.rng, spread=0.6) for _ in range(frames)]
        return self.trial(poses, noise_m)

    def standing(self, frames=5, noise_m=0.0):
        return self.trial([self.model.neutral()] * frames, noise_m)

    def trial(self, poses, noise_m):
        positions = marker_positions(self.sensor, poses)
        return MarkerTrajectories(NAMES, positions + noise_m * self.rng.normal(size=positions.shape), 100.0)


def found_factors(subject):
    table = subject.report["factors"].values()
    return np.array([one["value"] for one in table]), np.array([one["standard_error"] for one in table])


@pytest.fixture(scope="module")
def person():
    return Person(1)


@pytest.fixture(scope="module")
def subject(person):
    return scale_subject([person.standing()], [person.moving()], PROTOCOL, mass_kg=72.0)


@pytest.fixture
def without(person):
    """A trial of the person in which some markers are not there at all."""

    def make(*lost):
        one = person.moving(8)
        return one.select(tuple(name for name in NAMES if name not in lost))

    return make


def test_markers_fit_within_a_millimetre(subject):
    assert subject.report["converged"]
    assert subject.report["marker_rms_mm"] < 0.5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_factors_are_recovered_within_three_standard_errors(seed):
    one = Person(seed)
    result = scale_subject([one.standing()], [one.moving()], PROTOCOL, mass_kg=72.0)
    found, errors = found_factors(result)
    assert (
        np.abs(found - one.factors) < 1.5 * errors
    ).all()  # noise-free, hence well within 3 standard errors
    assert np.abs(found - one.factors).max() < 0.03
    assert (errors < 0.06).all()  # 0.06 is what one knows before
    assert list(result.scale_factors) == list(BODY.scale_factors)
    np.testing.assert_allclose(list(result.scale_factors.values()), found, atol=1e-5)


def test_technical_markers_are_found_where_they_sit(person, subject):
    sensor_places = dict(zip(NAMES, person.sensor.local_m, strict=True))
    technical = [m.name for m in PROTOCOL.markers if m.kind == "technical"]
    assert technical
    by_name = {m.name: m for m in subject.markers}
    off = [np.linalg.norm(by_name[name].position_m - sensor_places[name]) for name in technical]
    assert max(off) < 0.006


def test_the_report_counts_samples_and_displacements(person, subject):
    report = subject.report
    assert set(report["markers"]) == set(NAMES)
    assert report["frames"] == 25
    assert report["left_out"] == {}
    for one in report["markers"].values():
        assert one["samples"] == 25
        assert one["samples_left_out"] == 0
        assert 0 <= one["rms_mm"] <= one["max_mm"]
    assert not any(one["at_bound"] for one in report["factors"].values())


def test_errors_are_as_large_as_their_standard_errors_say():
    """People drawn from the prior, with the noise that is assumed: normalised errors have about unit variance."""
    squared = []
    for seed in range(3):
        one = Person(20 + seed, drawn_from_prior=True)
        result = scale_subject([], [one.moving(10, noise_m=0.005)], PROTOCOL, mass_kg=72.0)
        found, errors = found_factors(result)
        squared.append(((found - one.factors) / errors) ** 2)
    assert 0.6 < np.mean(squared) < 1.6  # 51 correlated numbers


def test_limbs_of_one_person_are_nearly_equally_long():
    names, prior = list(BODY.scale_factors), ScalingSettings()
    spread = factor_covariance(BODY, 0.1, prior)
    right, left, head = (names.index(name) for name in ("right_thigh", "left_thigh", "head"))
    between = spread[right, right] + spread[left, left] - 2.0 * spread[right, left]
    assert between == pytest.approx(2.0 * prior.side_sd**2)
    assert spread[right, right] == pytest.approx(0.1**2 + prior.proportion_sd**2 + prior.side_sd**2)
    assert spread[head, head] == pytest.approx(0.1**2 + prior.proportion_sd**2)
    assert spread[head, right] == pytest.approx(0.1**2)


def test_more_frames_make_smaller_standard_errors(person):
    few, many = (scale_subject([], [person.moving(n)], PROTOCOL, mass_kg=72.0) for n in (4, 20))
    assert (found_factors(many)[1] < found_factors(few)[1]).all()


def test_the_posture_of_the_static_trial_is_kept(person, subject):
    """A person who stands with bent knees is told to; one scaled from movement alone stands nowhere."""
    model, bent = person.model, person.model.neutral()
    for segment in ("right_shank", "left_shank"):
        away = np.zeros(model.nv)
        away[model.joint(segment).v.start + 1] = 0.2
        bent = model.integrate(bent, away)
    found = scale_subject(
        [person.trial([bent] * 4, 0.0)], [person.moving()], PROTOCOL, mass_kg=72.0
    ).standing_q
    knees = [model.joint(segment).v.start + 1 for segment in ("right_shank", "left_shank")]
    np.testing.assert_allclose(model.difference(model.neutral(), found)[knees], 0.2, atol=0.03)
    np.testing.assert_allclose(model.difference(model.neutral(), subject.standing_q)[knees], 0.0, atol=0.03)
    assert scale_subject([], [person.moving()], PROTOCOL, mass_kg=72.0).standing_q is None


def test_a_known_height_sets_the_overall_size():
    """Standing still with a few pelvis and trunk markers, the stated height decides about the limbs."""
    one = Person(4, spread=0.0)
    tall = one.factors.mean() * BODY.reference_height_m
    names = ("RASI", "LASI", "SACR", "C7", "CLAV", "RFHD", "LFHD")
    static = one.standing().select(names)
    known = scale_subject([static], [], PROTOCOL, mass_kg=72.0, height_m=tall)
    assert known.height_m == tall
    assert known.scale_factors["right_shank"] == pytest.approx(one.factors[0], rel=0.02)
    left_out = [m.name for m in PROTOCOL.markers if m.name not in names]
    assert all(
        m.session_sd_m == p.placement_sd_m
        for m, p in zip(known.markers, PROTOCOL.markers, strict=True)
        if m.name in left_out
    )


def test_static_with_few_markers_scales_what_it_sees(person):
    names = ("RASI", "LASI", "SACR", "RKNE", "LKNE", "RANK", "LANK", "RHEE")
    result = scale_subject([person.standing().select(names)], [], PROTOCOL, mass_kg=72.0)
    assert result.report["marker_rms_mm"] < 5.0
    assert len(result.markers) == len(NAMES)
    factors = result.report["factors"]
    assert factors["right_shank"]["standard_error"] < 0.7 * factors["right_forearm"]["standard_error"]


@pytest.mark.slow
def test_active_bounds_are_reported():
    """A giant twice as large as the reference: what is seen of every limb ends at the upper bound."""
    giant = Person(5, spread=0.0)
    huge = giant.standing(1)
    trial = MarkerTrajectories(NAMES, 1.75 * huge.positions_m, 100.0)
    wide = ScalingSettings(proportion_sd=2.0, stature_sd=2.0, outlier_m=1.0)
    report = scale_subject([trial], [], PROTOCOL, mass_kg=120.0, settings=wide).report
    at_bound = {name for name, one in report["factors"].items() if one["at_bound"]}
    assert {"right_thigh", "left_thigh", "right_shank", "left_shank"} <= at_bound
    for name in at_bound:
        assert report["factors"][name]["value"] in (0.5, 1.6)


def test_markers_left_out_come_with_reasons(person, without):
    one = without("RTUB")
    with_foo = np.concatenate([one.positions_m, one.positions_m[:, :1]], axis=1)
    strange = MarkerTrajectories((*one.names, "Foo"), with_foo, 100.0)
    result = scale_subject([], [strange], PROTOCOL, mass_kg=72.0)
    assert result.report["left_out"] == {"Foo": "not a marker of the protocol"}
    assert "RTUB" not in result.report["markers"]
    lost = next(m for m in result.markers if m.name == "RTUB")
    reference = next(m for m in PROTOCOL.markers if m.name == "RTUB")
    expected = result.scale_factors["right_shank"] * reference.position_m
    np.testing.assert_allclose(lost.position_m, expected, rtol=1e-12)
    assert lost.session_sd_m == reference.placement_sd_m


def test_a_wild_sample_is_dropped_and_counted():
    trial = Person(1).moving(10)
    positions = trial.positions_m.copy()
    positions[3, NAMES.index("RMID")] += [0.0, 0.2, 0.0]
    result = scale_subject([], [replace(trial, positions_m=positions)], PROTOCOL, mass_kg=72.0)
    samples = {
        name: (one["samples"], one["samples_left_out"]) for name, one in result.report["markers"].items()
    }
    assert samples.pop("RMID") == (9, 1)
    assert set(samples.values()) == {(10, 0)}
    assert result.report["marker_rms_mm"] < 1.0


@pytest.mark.parametrize("mass", [0.0, -70.0, np.nan, np.inf])
def test_impossible_masses_are_refused(person, mass):
    with pytest.raises(InvalidInput, match=r"mass must be positive.*give --mass KG"):
        scale_subject([person.standing(1)], [], PROTOCOL, mass_kg=mass)


@pytest.mark.parametrize("height", [0.4, 175.0, -1.8, np.nan])
def test_impossible_heights_are_refused(person, height):
    with pytest.raises(InvalidInput, match="height must be between"):
        scale_subject([person.standing(1)], [], PROTOCOL, mass_kg=72.0, height_m=height)


def test_no_trial_is_refused():
    with pytest.raises(InvalidInput, match="a static trial, or at least one --trial"):
        scale_subject([], [], PROTOCOL, mass_kg=72.0)


def test_too_few_markers_are_refused(person):
    with pytest.raises(NotObservable, match="5 markers of protocol"):
        scale_subject([person.standing().select(NAMES[:5])], [], PROTOCOL, mass_kg=72.0)


def test_markers_that_are_no_person_are_refused(person):
    nonsense = MarkerTrajectories(NAMES, np.random.default_rng(6).uniform(-2, 2, (1, len(NAMES), 3)), 100.0)
    with pytest.raises(NotConverged, match="protocol"):
        scale_subject([nonsense], [], PROTOCOL, mass_kg=72.0)


def test_progress_is_told(person):
    told = []
    scale_subject([person.standing(2)], [], PROTOCOL, mass_kg=72.0, progress=lambda *step: told.append(step))
    assert told[0][0] == 1
    assert all(done <= total for done, total in told)


@pytest.mark.parametrize("turn", ["x", "y"])
def test_a_static_trial_that_lies_is_refused(turn):
    """The up axis of the file was mistaken: everything is turned by a right angle."""
    standing = Person(3).standing()
    x, y, z = np.moveaxis(standing.positions_m, -1, 0)
    lying = np.stack([x, -z, y] if turn == "x" else [z, y, -x], axis=-1)
    with pytest.raises(InvalidInput, match=r"tilted by (89|90)°.*--up"):
        scale_subject([replace(standing, positions_m=lying)], [], PROTOCOL, mass_kg=70.0)


def test_keypoints_are_scaled_from_standing_and_carry_their_noise():
    """Feet stay flat and lengths true under 20 mm of noise, and what stays of the noise is told to the filters."""
    protocol, rng = load_protocol("halpe26"), np.random.default_rng(4)
    model = HumanModel(BODY, np.full(18, 0.97), 70.0)
    places = [0.97 * m.position_m for m in protocol.markers]
    sensor = MarkerSensor(model, [m.segment for m in protocol.markers], np.array(places))
    names = tuple(m.name for m in protocol.markers)

    def seen(poses):
        exact = marker_positions(sensor, poses)
        return MarkerTrajectories(names, exact + rng.normal(0.0, 0.02, exact.shape), 60.0)

    standing, moving = [model.neutral()] * 40, [moderate_pose(model, rng, spread=0.6) for _ in range(40)]
    found = scale_subject([seen(standing)], [seen(moving)], protocol, mass_kg=70.0)
    for name in ("trunk_height", "right_thigh", "left_shank"):
        told = 1.2 * found.report["factors"][name]["standard_error"]
        assert found.scale_factors[name] == pytest.approx(0.97, abs=told)
    place = {m.name: m.position_m for m in found.markers}
    sole = place["RSmallToe"] - place["RHeel"]
    true = dict(zip(names, places, strict=True))
    expected = true["RSmallToe"] - true["RHeel"]
    assert np.degrees(np.arctan2(sole[2], sole[0]) - np.arctan2(expected[2], expected[0])) == pytest.approx(
        0, abs=3
    )
    assert {(m.noise_m, m.correlated_m, m.correlation_s) for m in found.markers} == {(0.02, 0.01, 0.3)}
    assert {m.session_sd_m for m in found.markers} == {0.005}, "nobody sticks them on anew"


def exchanged(trial, *names):
    """The trial with each marker under the next one's name."""
    columns = [NAMES.index(name) for name in names]
    positions = trial.positions_m.copy()
    positions[:, columns] = trial.positions_m[:, np.roll(columns, 1)]
    return replace(trial, positions_m=positions)


def test_a_person_raises_no_doubt(subject):
    assert DOUBTS_KEY not in subject.report


def test_one_exchanged_pair_of_a_standing_trial_is_doubted(person):
    one = exchanged(person.standing(), "RKNE", "RANK")
    (doubt,) = scale_subject([one], [], PROTOCOL, mass_kg=72.0).report[DOUBTS_KEY]
    assert doubt.startswith("proportions are unusual")


def test_a_standing_trial_whose_names_go_round_is_no_person_though_it_fits(person):
    one = exchanged(person.standing(), "RKNE", "RANK", "LELB", "C7", "RHEE", "LKNE", "LANK", "RELB")
    with pytest.raises(NotConverged, match="proportions that people do not have"):
        scale_subject([one], [], PROTOCOL, mass_kg=72.0)


def test_a_fit_that_is_cut_short_is_told(person, monkeypatch):
    monkeypatch.setattr(search, "MAX_ITERATIONS", 1)
    found = scale_subject([person.standing()], [person.moving()], PROTOCOL, mass_kg=72.0)
    assert not found.report["converged"]
    assert found.report[DOUBTS_KEY][0] == "the fit did not converge"


def test_the_thesis_scales_pelvis_and_torso_by_one_vertical_factor():
    """Its seventeen factors; with the body's own, a pelvis that is taller than the torso is found as such."""
    one = Person(5, pelvis=1.08)
    trial = one.moving(20)
    found = {
        thesis: scale_subject(
            [], [trial], PROTOCOL, mass_kg=72.0, settings=ScalingSettings(thesis_factors=thesis)
        ).scale_factors
        for thesis in (False, True)
    }
    assert found[True]["pelvis_height"] == pytest.approx(found[True]["trunk_height"], abs=1e-4)
    assert 1.02 < found[False]["pelvis_height"] / found[False]["trunk_height"] < 1.09
