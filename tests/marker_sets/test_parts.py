"""Parts of a body in words: seen and bare ones, and names of the upper body alone."""

from dataclasses import replace

import pytest

from mbkf.marker_sets.names import read_names
from mbkf.marker_sets.parts import parts_in_words, segments_named, upper_body_only
from mbkf.model.body_file import load_body

WHOLE = {"pelvis": 4, "torso": 5, "right_thigh": 3, "left_thigh": 3, "head": 4}


@pytest.mark.parametrize(
    ("segments", "seen", "bare"),
    [
        (("head",), "head", "trunk, pelvis, arms, hands, legs, feet"),
        (("right_hand", "right_forearm"), "right arm, right hand", "head, trunk, pelvis, legs, feet"),
        (
            ("torso", "left_upper_arm", "right_forearm", "left_foot"),
            "trunk, arms, left foot",
            "head, pelvis, hands, legs",
        ),
        ((), "", "head, trunk, pelvis, arms, hands, legs, feet"),
    ],
)
def test_parts_with_and_without_markers(segments, seen, bare):
    assert parts_in_words(segments) == (seen, bare)


def test_names_are_counted_by_the_segment_that_they_mean():
    names = ("RASI", "LASI", "RKNE", "LKNE", "RFIN", "Box1", "M07", "CentreOfMass")
    assert segments_named(read_names(names)) == {
        "pelvis": 2,
        "right_thigh": 1,
        "left_thigh": 1,
        "right_hand": 1,
    }


def test_the_upper_body_alone_may_have_a_misread_name():
    upper, roles = {"right_hand": 19, "right_forearm": 2}, load_body().roles
    assert upper_body_only(upper, roles) == upper
    assert upper_body_only({**upper, "right_shank": 1}, roles) == upper
    assert upper_body_only({**upper, "right_shank": 4}, roles) == {}
    assert upper_body_only(WHOLE, roles) == {}
    assert upper_body_only({}, roles) == {}


def test_the_lower_body_is_known_by_its_roles_under_any_names():
    names = {"feet": ("calcn_r", "calcn_l"), "toes": ("toes_r",), "legs": ("femur_r", "tibia_r")}
    roles = replace(load_body().roles, root="hips", **names)
    for lower in ("hips", "femur_r", "calcn_l", "toes_r"):
        assert upper_body_only({"torso": 5, lower: 3}, roles) == {}
    assert upper_body_only({"torso": 5, "pelvis": 3}, roles) == {"torso": 5, "pelvis": 3}
