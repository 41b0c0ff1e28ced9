"""The density of marker places: a mixture, built from landmarks, protocols and the skin."""

import numpy as np
import pytest

from mbkf.marker_sets.places import SKIN_ABOVE_M, SKIN_SHARE, UNUSED_LANDMARK, worn_places
from mbkf.model.body_file import load_body
from mbkf.model.protocol import protocol_names

BODY = load_body()
ALL = protocol_names()


@pytest.fixture(scope="module")
def places():
    return worn_places(BODY)


@pytest.fixture(scope="module")
def bare():
    """The density of who knows no protocol: landmarks and skin."""
    return worn_places(BODY, ALL)


def test_the_shares_sum_to_one(places, bare):
    for one in (places, bare, worn_places(BODY, ["plug_in_gait"])):
        assert one.weight.sum() == pytest.approx(1.0, abs=1e-12)
        assert (one.weight >= 0.0).all()
        assert (one.sd_m > 0.0).all()
        assert (one.noise_m > 0.0).all()


def test_components_name_their_segments(places):
    names = [segment.name for segment in BODY.segments]
    assert tuple(names[k] for k in places.segment_index) == places.segments


def test_some_of_the_components_are_as_they_were(places):
    chosen = np.array([name.endswith("hand") for name in places.segments])
    some = places.only(chosen)
    assert set(some.segments) == {"right_hand", "left_hand"}
    assert some.landmarks == tuple(name for name, kept in zip(places.landmarks, chosen, strict=True) if kept)
    for field in ("position_m", "sd_m", "weight", "noise_m", "segment_index"):
        np.testing.assert_array_equal(getattr(some, field), getattr(places, field)[chosen])


def test_landmarks_are_where_the_body_has_them(places):
    on = [k for k, name in enumerate(places.landmarks) if name]
    assert sorted(places.landmarks[k] for k in on) == sorted(BODY.landmarks)
    for k in on:
        landmark = BODY.landmark(places.landmarks[k])
        assert places.segments[k] == landmark.segment
        np.testing.assert_array_equal(places.position_m[k], landmark.position_m)


def test_the_skin_has_its_share_of_every_segment(bare):
    """Without protocols whatever is no landmark is skin."""
    landmarks = np.array([bool(name) for name in bare.landmarks])
    for s in range(len(BODY.segments)):
        own = bare.segment_index == s
        skin, whole = bare.weight[own & ~landmarks].sum(), bare.weight[own].sum()
        if skin > 0.0 and whole > skin:
            assert skin / whole == pytest.approx(SKIN_SHARE)


def test_landmarks_that_no_protocol_uses_weigh_alike(bare):
    weight = bare.weight[[bool(name) for name in bare.landmarks]]
    np.testing.assert_allclose(weight, weight[0])


def test_every_protocol_adds_one_to_a_landmark(places, bare):
    """Their weights differ by whole numbers, in units of what an unused landmark has."""
    on = [k for k, name in enumerate(places.landmarks) if name]
    unit = places.weight[on].min() / UNUSED_LANDMARK
    votes = places.weight[on] / unit - UNUSED_LANDMARK
    np.testing.assert_allclose(votes, np.round(votes), atol=1e-9)
    assert votes.max() > len(ALL) / 2, "the most used landmark is that of most laboratories"
    assert votes.max() <= 2 * len(ALL)


def test_points_of_the_skin_lie_above_it(bare):
    shape, end = BODY.shapes["right_thigh"], BODY.segment("right_shank").origin_m
    own = [k for k, s in enumerate(bare.segments) if s == "right_thigh" and not bare.landmarks[k]]
    points = bare.position_m[own]
    level = points[:, 2] / end[2]
    radius = np.linalg.norm(points - level[:, None] * end, axis=1)
    np.testing.assert_allclose(radius, np.interp(level, [0, 1], shape.numbers[:2]) + SKIN_ABOVE_M)
    assert (level > 0.0).all()
    assert (level < 1.0).all()


@pytest.mark.parametrize("segment", ["thigh", "shank", "upper_arm", "forearm"])
def test_left_skin_mirrors_the_right(bare, segment):
    def skin(side):
        own = [
            s == f"{side}_{segment}" and not name
            for s, name in zip(bare.segments, bare.landmarks, strict=True)
        ]
        return bare.position_m[own]

    image = skin("left") * [1.0, -1.0, 1.0]
    apart = np.linalg.norm(image[:, None] - skin("right"), axis=2)
    assert apart.min(axis=0).max() < 1e-9
    assert apart.min(axis=1).max() < 1e-9


def test_a_protocol_left_out_does_not_count(places):
    without = worn_places(BODY, ["autolabel62"])
    assert len(without.weight) < len(places.weight)
    named = set(zip(places.segments, map(tuple, places.position_m), strict=True))
    assert len(named - set(zip(without.segments, map(tuple, without.position_m), strict=True))) > 0
    assert worn_places(BODY, ["autolabel62"]) is without, "kept, since it takes long"
