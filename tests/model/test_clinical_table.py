"""The table of clinical angles: complete, mirrored, and strict about damage."""

import copy

import numpy as np
import pytest

from mbkf.model.body_file import load_body
from mbkf.model.clinical_table import clinical_joints, opensim_zeros_rad, positive_senses

KNEE = {
    "name": "knee_r",
    "mirror": True,
    "proximal": "right_thigh",
    "distal": "right_shank",
    "order": "yx",
    "main": "flexion_r",
    "angle": [{"name": "flexion_r", "axis": "y", "sign": 1}, {"name": "varus_r", "axis": "x", "sign": 1}],
}


def test_every_joint_of_the_body_stands_in_the_table_with_its_parent():
    body = load_body()
    for segment, joint in zip(body.segments, body.clinical_joints, strict=True):
        assert (joint.proximal, joint.distal) == (segment.parent, segment.name)
        assert len(joint.order) == {"hinge": 1, "universal": 2}.get(segment.joint, 3)


def test_left_signs_mirror_the_right_ones():
    joints = {joint.name: joint for joint in load_body().clinical_joints}
    for name, right in joints.items():
        if name.endswith("_r"):
            left = joints[name.removesuffix("_r") + "_l"]
            assert [a.name for a in left.angles] == [a.name.removesuffix("_r") + "_l" for a in right.angles]
            for one, other in zip(right.angles, left.angles, strict=True):
                assert other.sign == (one.sign if one.axis == "y" else -one.sign)
                assert bool(one.opensim) == bool(other.opensim)
                assert one.title == other.title


def test_titles_and_opensim_names_may_be_left_out():
    right, left = clinical_joints([KNEE])
    assert (left.name, left.proximal, left.distal, left.main) == (
        "knee_l",
        "left_thigh",
        "left_shank",
        "flexion_l",
    )
    assert [(a.opensim, a.title) for a in right.angles + left.angles] == [("", "")] * 4


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("order", "xy", "follow its order"),
        ("main", "bend", "main angle bend"),
        ("angle", [{"name": "flexion_r", "axis": "y", "sign": 2}], "order|sign"),
        (
            "angle",
            [
                {"name": "flexion_r", "axis": "y", "sign": 1, "zero_sd_deg": -1.0},
                {"name": "varus_r", "axis": "x", "sign": 1},
            ],
            "zero_sd_deg of flexion_r",
        ),
        ("mirror", False, None),
    ],
)
def test_a_damaged_table_is_refused(key, value, message):
    entry = copy.deepcopy(KNEE) | {key: value}
    if message is None:
        assert len(clinical_joints([entry])) == 1
        return
    with pytest.raises(ValueError, match=message):
        clinical_joints([entry])


def test_both_sides_have_the_spread_of_a_zero():
    joints = {joint.name: joint for joint in load_body().clinical_joints}
    for side in "rl":
        spread = {angle.name: angle.zero_sd_deg for angle in joints[f"elbow_{side}"].angles}
        assert spread[f"elbow_flex_{side}"] > 0.0 == spread[f"pro_sup_{side}"]


def test_two_coordinates_of_one_name_are_refused():
    with pytest.raises(ValueError, match="flexion_r stands twice"):
        clinical_joints([KNEE | {"mirror": False}, KNEE | {"mirror": False, "name": "other"}])


def test_opensim_counts_pronation_from_the_supinated_forearm():
    """A palm that faces in is half way from supination (0°) to a palm down (180°)."""
    zeros = opensim_zeros_rad(load_body().clinical_joints)
    assert zeros == {"pro_sup_r": pytest.approx(np.pi / 2), "pro_sup_l": pytest.approx(np.pi / 2)}


def test_the_positive_sense_of_every_coordinate_that_the_body_file_explains():
    senses = positive_senses(load_body().clinical_joints)
    assert senses["hip_flexion_l"] == "thigh forward" and senses["pelvis_ty"] == "up"
    assert set(senses) == {a.name for joint in load_body().clinical_joints for a in joint.coordinates}
