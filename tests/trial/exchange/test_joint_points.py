"""Joints as points: names, order and signs of their numbers."""

import pytest

from mbkf.model.clinical_table import Angle, ClinicalJoint
from mbkf.trial.exchange.joint_points import TURNED, joint_points
from tests.motions import reference_model


def points():
    return {point.stem: point for point in joint_points(reference_model().description.clinical_joints)}


def test_every_joint_of_the_body_has_its_point_and_every_coordinate_stands_in_one():
    found, joints = points(), reference_model().description.clinical_joints
    assert len(found) == len(joints) + 1  # the pelvis has two
    assert {"RHip", "LHip", "RKnee", "LAnkle", "RToe", "Spine", "LowerNeck", "UpperNeck", "LPelvis"} <= set(
        found
    )
    placed = [c.coordinate for p in found.values() for c in p.components if c and p.stem != "LPelvis"]
    assert sorted(placed) == sorted(angle.name for joint in joints for angle in joint.angles)


@pytest.mark.parametrize(
    ("stem", "coordinates"),
    [
        ("RWrist", ("wrist_flex_r", "wrist_dev_r", "wrist_rotation_r")),
        ("LowerNeck", ("neck_extension", "neck_bending", None)),
        ("LToe", ("mtp_angle_l", None, None)),
        ("RShoulder", ("arm_flex_r", "arm_add_r", "arm_rot_r")),
    ],
)
def test_flexion_comes_first_whatever_axis_it_is_about(stem, coordinates):
    assert tuple(c and c.coordinate for c in points()[stem].components) == coordinates


def test_turned_signs_name_coordinates_that_exist():
    known = {angle.name for joint in reference_model().description.clinical_joints for angle in joint.angles}
    assert {name for name, _ in TURNED} <= known
    for point in points().values():
        for c in point.components:
            side = point.stem[0] if point.root else ""
            assert c is None or (c.sign == -1.0) == ((c.coordinate, side) in TURNED)


def test_joints_of_other_bodies_are_named_after_themselves():
    angles = (Angle("bend", "z", 1), Angle("lean", "x", 1), Angle("roll", "y", -1))
    joint = ClinicalJoint("tail_base_l", "pelvis", "tail", "zxy", "bend", angles, ())
    (point,) = joint_points((joint,))
    assert point.stem == "LTailBase"
    assert [c.coordinate for c in point.components] == ["bend", "lean", "roll"]
    assert point.signs == "X+ bend, Y+ lean, Z+ roll"
