"""Segment lengths of a trial: a subject's own are more likely than anybody's, and those of another person are found."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel, reference_body
from mbkf.scaling.correction import correction, trial_lengths
from mbkf.scaling.trial_lengths import spread_of_people
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import marker_positions, moderate_pose, random_model, subject_of

LEGS = ("right_thigh", "left_thigh", "right_shank", "left_shank")
THIGH_M = 0.42


@pytest.fixture(scope="module")
def subject():
    return subject_of(random_model(np.random.default_rng(1)), session_sd_m=0.01)


def moving(person, moved=None, frames=12):
    """A trial of a person with noise of 1 mm; markers ``moved`` sit elsewhere, m."""
    model, rng = HumanModel.of(person), np.random.default_rng(2)
    places = np.array([m.position_m + (moved or {}).get(m.name, 0.0) for m in person.markers])
    sensor = MarkerSensor(model, [m.segment for m in person.markers], places)
    positions = marker_positions(sensor, [moderate_pose(model, rng, spread=0.6) for _ in range(frames)])
    positions = positions + 0.001 * rng.normal(size=positions.shape)
    return MarkerTrajectories(tuple(m.name for m in person.markers), positions, 100.0)


def grown(person, times, names=LEGS):
    """The person with longer segments, whose markers sit where they would sit on them."""
    body = reference_body(person)
    factors = {name: k * (times if name in names else 1.0) for name, k in person.scale_factors.items()}
    before, after = (
        np.array([f[name] for name in body.scale_factors]) for f in (person.scale_factors, factors)
    )
    stretch = {m.segment: body.segment(m.segment).scale_matrix for m in person.markers}
    markers = tuple(
        replace(m, position_m=m.position_m * (stretch[m.segment] @ after) / (stretch[m.segment] @ before))
        for m in person.markers
    )
    return replace(person, scale_factors=factors, markers=markers)


def test_the_subjects_own_lengths_are_more_likely_than_anybodys(subject):
    found = trial_lengths(subject, moving(subject))
    assert found.powers < -2.0 and len(found.changes) == 1
    assert abs(found.changes[0].longer_mm) < 2.0 * found.changes[0].sd_mm


def test_longer_legs_are_found_with_their_length(subject):
    found = trial_lengths(subject, moving(grown(subject, 1.15)))
    thigh = next(one for one in found.changes if one.name == "thigh")
    assert found.powers > 10.0
    assert thigh.longer_mm == pytest.approx(0.15 * 1e3 * THIGH_M, abs=15.0) and 0.0 < thigh.sd_mm < 15.0
    assert trial_lengths(subject, moving(grown(subject, 0.87))).changes[0].longer_mm < -20.0


@pytest.mark.parametrize(
    "moved",
    [
        {"RKNE": np.array([0.0, 0.0, -0.09]), "RANK": np.array([0.0, 0.0, 0.09])},
        {"RTHI": np.array([0.03, -0.05, 0.04]), "LANK": np.array([0.0, 0.02, 0.03])},
    ],
)
def test_markers_that_were_put_on_elsewhere_are_no_other_person(subject, moved):
    assert trial_lengths(subject, moving(subject, moved)).powers < -2.0


def test_lengths_that_the_file_states_loosely_may_differ(subject):
    """A body that is not known well is less surprised by other lengths."""
    trial = moving(grown(subject, 1.05))
    body = reference_body(subject)
    powers = [
        correction(replace(subject, covariance=covariance(subject, body, sd)), trial).lengths.powers
        for sd in (0.005, 0.05)
    ]
    assert powers[0] > 5.0 and powers[1] < 0.0
    assert correction(subject, trial).lengths.powers == pytest.approx(3.5, abs=1.0), (
        "without a covariance: 1 %"
    )


def covariance(subject, body, sd):
    from mbkf.io.body_covariance import BodyCovariance

    names = tuple(m.name for m in subject.markers)
    sizes = np.r_[np.full(len(body.scale_factors), sd), np.full(3 * len(names), 1e-3)]
    return BodyCovariance.of(body.scale_factors, names, np.diag(sizes**2))


def test_people_differ_in_size_and_a_persons_sides_hardly(subject):
    body = reference_body(subject)
    spread = spread_of_people(body)
    thighs = [body.scale_factors.index(name) for name in LEGS[:2]]
    apart = np.array([1.0, -1.0])
    assert np.sqrt(spread[0, 0]) == pytest.approx(np.hypot(0.2, 0.06))
    assert apart @ spread[np.ix_(thighs, thighs)] @ apart == pytest.approx(2 * 0.015**2)
