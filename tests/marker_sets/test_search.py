"""The body in one frame: found wherever it stands and faces, and refused where there is none."""

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.marker_sets.equipment import EQUIPMENTS, equipped_weight
from mbkf.marker_sets.places import worn_places
from mbkf.marker_sets.posed_cloud import CloudProblem
from mbkf.marker_sets.search import FEWEST_POINTS, MOST_ROUGH, find_body
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from tests.marker_sets.worn import near, standing

BODY = load_body()
PLACES = worn_places(BODY, ["plug_in_gait"])


def segments(found):
    names = [segment.name for segment in BODY.segments]
    index = PLACES.segment_index
    shares = np.array([found.body.shares[:, index == s].sum(axis=1) for s in range(len(names))]).T
    return [names[s] for s in shares.argmax(axis=1)]


def facing(found):
    model = HumanModel(BODY, found.body.factors, 70.0)
    return model.placements(found.body.q)[0][model.root.joint_id][:2, 0]


@pytest.fixture(scope="module")
def worn():
    return standing("plug_in_gait", 1)


@pytest.fixture(scope="module")
def found(worn):
    return find_body(PLACES, worn.points_m)


def test_a_standing_person_is_found(worn, found):
    right = [
        near(one, worn.segments[name]) for one, name in zip(segments(found), worn.markers.names, strict=True)
    ]
    assert np.mean(right) >= 0.95
    assert facing(found)[0] > 0.95, "he faces along x"
    assert found.equipment.name == "the whole body"
    assert found.log_ratio_per_point > 1.0
    assert found.other_heading < found.log_posterior


def test_who_searches_a_frame_again_gets_the_body_that_was_found(worn, found):
    """Also with names that tell nothing; a name that tells something, or another frame, is a search of its own."""
    nothing = np.ones((len(worn.points_m), len(PLACES.segments)))
    assert find_body(PLACES, worn.points_m.copy(), nothing) is found
    for one in (found.body.q, found.body.factors, found.body.shares):
        assert not one.flags.writeable
    told = nothing.copy()
    told[0, np.array(PLACES.segments) == worn.segments[worn.markers.names[0]]] = 2.0
    assert find_body(PLACES, worn.points_m, told).log_posterior > found.log_posterior + 0.01, (
        "a name that tells the true segment"
    )
    assert find_body(PLACES, worn.points_m + 1e-6) is not found


def test_a_person_with_many_markers_is_found_by_some_of_them(worn):
    beside = np.random.default_rng(3).normal(0.0, 0.015, (4, *worn.points_m.shape))
    many = (worn.points_m + beside).reshape(-1, 3)
    assert len(many) > MOST_ROUGH
    found = find_body(PLACES, many)
    truth = [worn.segments[name] for name in worn.markers.names] * 4
    assert np.mean([near(one, true) for one, true in zip(segments(found), truth, strict=True)]) >= 0.9
    assert facing(found)[0] > 0.95


def test_bare_segments_have_no_share(worn):
    legs = [
        name
        for name, segment in worn.segments.items()
        if segment.endswith(("pelvis", "thigh", "shank", "foot"))
    ]
    rows = [worn.markers.names.index(name) for name in legs]
    found = find_body(PLACES, worn.points_m[rows])
    assert found.equipment.name == "pelvis and legs"
    assert found.body.shares.shape == (len(legs), len(PLACES.segments))
    assert not found.body.shares[:, found.equipment.bare(PLACES)].any()
    assert found.body.shares.sum() > 0.9 * len(legs)


def test_a_turned_and_shifted_cloud_has_the_turned_body(worn, found):
    angle = 1.9
    again = find_body(PLACES, worn.turned(angle, (3.0, -2.0, 0.3)).points_m)
    assert segments(again) == segments(found)
    np.testing.assert_allclose(
        facing(again),
        np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ facing(found),
        atol=0.03,
    )
    np.testing.assert_allclose(again.body.factors, found.body.factors, atol=0.02)
    assert again.log_posterior == pytest.approx(found.log_posterior, abs=1.0)


def test_names_are_weighed_point_by_point(worn):
    """A name that doubles the density of its own point takes half of that point's share off the body, of no other's."""
    weight = equipped_weight(PLACES, EQUIPMENTS[0])
    named = np.ones((3, len(weight)))
    named[1] = 2.0
    far = PLACES.position_m + 0.5  # so that points are as likely off the body
    plain, doubled = (
        CloudProblem(PLACES, worn.points_m[:3], weight * factor).shares(far, 0.2)[0].sum(axis=1)
        for factor in (1.0, named)
    )
    odds = plain / (1.0 - plain)
    np.testing.assert_allclose(doubled / (1.0 - doubled), odds * [1.0, 2.0, 1.0], rtol=1e-9)


def test_too_few_points_are_refused(worn):
    with pytest.raises(NotObservable, match=f"{FEWEST_POINTS - 1} points; fewer than {FEWEST_POINTS}"):
        find_body(PLACES, worn.points_m[: FEWEST_POINTS - 1])


@pytest.mark.parametrize("scale", [0.1, 10.0, 1000.0])
def test_clouds_of_no_persons_size_are_refused(worn, scale):
    with pytest.raises(NotObservable, match=r"no upright body is found: .* of height; .*--unit"):
        find_body(PLACES, scale * worn.points_m)


def test_scattered_points_speak_for_no_body(found):
    rng = np.random.default_rng(2)
    scattered = rng.uniform([-0.3, -0.4, 0.0], [0.3, 0.4, 1.7], (40, 3))
    assert find_body(PLACES, scattered).log_ratio_per_point < found.log_ratio_per_point - 0.5
