"""Tables of joint centres and skin: mirrored, and refused where a spread cannot be one."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.model.body_file import load_body
from mbkf.model.spread_tables import joint_centres, segment_skin, shoulder_girdle

SEGMENTS, PATH = ("pelvis", "right_thigh", "left_thigh", "right_shank", "left_shank"), Path("body.toml")
CENTRE = {"segment": "right_thigh", "sd_mm": [8.0, 6.0, 7.0]}
SKIN = {
    "segment": "right_thigh",
    "flexions": [["right_thigh"], ["right_shank"]],
    "common_mm": 12.0,
    "own_mm": 6.0,
}
GIRDLE = {
    "segment": "right_upper_arm",
    "mean_mm": [-30.0, 20.0, 40.0],
    "sd_mm": [15.0, 12.0, 15.0],
    "held_mm": [10.0, 10.0, 20.0],
}


def test_shoulders_are_mirrored_and_must_be_spherical_and_possible():
    segments = load_body().segments
    right, left = shoulder_girdle([GIRDLE], segments, PATH)
    assert (right.segment, left.segment) == ("right_upper_arm", "left_upper_arm")
    np.testing.assert_allclose([right.mean_m, left.mean_m], [[-0.03, 0.02, 0.04], [-0.03, -0.02, 0.04]])
    np.testing.assert_allclose([left.sd_m, left.held_m], [[0.015, 0.012, 0.015], [0.01, 0.01, 0.02]])
    for wrong in ({"sd_mm": [15.0, 0.0, 15.0]}, {"mean_mm": [0.0, 200.0, 0.0]}, {"held_mm": [1.0, 2.0]}):
        with pytest.raises(FileFormatError, match="girdle of right_upper_arm: mean_mm"):
            shoulder_girdle([GIRDLE | wrong], segments, PATH)
    with pytest.raises(FileFormatError, match="its joint must be spherical"):
        shoulder_girdle([GIRDLE | {"segment": "right_toes"}], segments, PATH)


def test_the_right_side_is_mirrored():
    right, left = joint_centres([CENTRE], SEGMENTS, PATH)
    assert (right.segment, left.segment) == ("right_thigh", "left_thigh")
    np.testing.assert_allclose([right.sd_m, left.sd_m], [[0.008, 0.006, 0.007]] * 2)
    skin = segment_skin([SKIN], SEGMENTS, PATH)
    assert skin["left_thigh"].flexions == (("left_thigh",), ("left_shank",))
    assert (skin["left_thigh"].common_m, skin["left_thigh"].own_m) == (0.012, 0.006)


@pytest.mark.parametrize("sd_mm", [[8.0, 6.0], [8.0, 0.0, 7.0], [8.0, 6.0, 200.0], [8.0, -1.0, 7.0]])
def test_impossible_centres_are_refused(sd_mm):
    with pytest.raises(FileFormatError, match="joint_centre of right_thigh"):
        joint_centres([CENTRE | {"sd_mm": sd_mm}], SEGMENTS, PATH)


@pytest.mark.parametrize("wrong", [{"own_mm": 0.0}, {"common_mm": 150.0}, {"flexions": [[]]}])
def test_impossible_skin_is_refused(wrong):
    with pytest.raises(FileFormatError, match="skin of right_thigh"):
        segment_skin([SKIN | wrong], SEGMENTS, PATH)


def test_unknown_segments_are_named():
    with pytest.raises(UnknownName, match="right_thigh"):
        joint_centres([CENTRE | {"segment": "right_tigh"}], SEGMENTS, PATH)
    with pytest.raises(UnknownName, match="right_shank"):
        segment_skin([SKIN | {"flexions": [["right_shak"]]}], SEGMENTS, PATH)
