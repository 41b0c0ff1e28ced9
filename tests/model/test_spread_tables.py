"""Tables of joint centres and skin: mirrored, and refused where a spread cannot be one."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.model.spread_tables import joint_centres, segment_skin

SEGMENTS, PATH = ("pelvis", "right_thigh", "left_thigh", "right_shank", "left_shank"), Path("body.toml")
CENTRE = {"segment": "right_thigh", "sd_mm": [8.0, 6.0, 7.0]}
SKIN = {
    "segment": "right_thigh",
    "flexions": [["right_thigh"], ["right_shank"]],
    "common_mm": 12.0,
    "own_mm": 6.0,
}


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
