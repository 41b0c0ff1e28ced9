"""OpenSim's bodies by name, and the common skeleton at zero."""

import numpy as np
import pytest

from mbkf.io.osim_joints import OsimJoint
from mbkf.model.body_file import load_body
from mbkf.trial.protocol.osim_bodies import COMMON_JOINTS, head_origin, poses_at_zero, segment_of


@pytest.mark.parametrize(
    ("body", "segment"),
    [
        ("pelvis", "pelvis"), ("sacrum", "pelvis"), ("torso", "torso"), ("thorax", "torso"), ("Spine", "torso"),
        ("femur_r", "right_thigh"), ("femur_l", "left_thigh"), ("r_femur", "right_thigh"), ("ThighL", "left_thigh"),
        ("tibia_r", "right_shank"), ("patella_l", "left_shank"), ("fibula_r", "right_shank"),
        ("talus_r", "right_foot"), ("calcn_l", "left_foot"), ("foot_r", "right_foot"), ("toes_r", "right_toes"),
        ("humerus_r", "right_upper_arm"), ("ulna_l", "left_forearm"), ("radius_r", "right_forearm"),
        ("hand_l", "left_hand"), ("hand_R", "right_hand"), ("right_forearm", "right_forearm"),
        ("scapula_r", "torso"), ("clavicle_l", "torso"), ("clavicle", "torso"), ("head", "head"), ("jaw", "head"),
        ("head_neck", "head"), ("cerv7", "neck"), ("C3", "neck"), ("T10", "torso"), ("thoracic12", "torso"),
        ("ground", ""), ("walker", ""), ("femur", ""), ("", ""),
    ],
)  # fmt: skip
def test_bodies_by_name(body, segment):
    assert segment_of(body)[0] == segment


def test_the_lumbar_spine_may_be_on_either_side():
    segment, probability, others = segment_of("lumbar5")
    assert (segment, [name for name, _ in others]) == ("pelvis", ["torso"])
    assert probability + others[0][1] == pytest.approx(1.0)
    assert segment_of("L3") == segment_of("lumbar5")


def test_the_common_skeleton_is_a_symmetric_person_of_the_reference_body_s_size():
    poses = poses_at_zero(())
    assert set(poses) == {"ground"} | {joint.child for joint in COMMON_JOINTS}
    for name, pose in poses.items():
        assert pose[:3, :3] == pytest.approx(np.eye(3))
        if name.endswith("_r"):
            assert pose[:3, 3] * [1, 1, -1] == pytest.approx(poses[name[:-1] + "l"][:3, 3])
    body = load_body("human18")
    for parent, child, segment in (
        ("femur", "tibia", "shank"),
        ("tibia", "talus", "foot"),
        ("humerus", "ulna", "forearm"),
    ):
        length = np.linalg.norm(poses[f"{child}_r"][:3, 3] - poses[f"{parent}_r"][:3, 3])
        assert length == pytest.approx(np.linalg.norm(body.segment(f"right_{segment}").origin_m), rel=0.1)


def test_a_model_s_joints_go_before_the_common_ones_and_loose_bodies_are_left_out():
    pose = np.eye(4)
    pose[:3, 3] = [1.0, 2.0, 3.0]
    mine = OsimJoint("pelvis", "femur_r", pose, np.eye(4))
    loose = (
        OsimJoint("nowhere", "box", pose, np.eye(4)),
        OsimJoint("a", "b", pose, np.eye(4)),
        OsimJoint("b", "a", pose, np.eye(4)),
    )
    poses = poses_at_zero((mine, *loose))
    assert poses["femur_r"][:3, 3] == pytest.approx([1.0, 2.0, 3.0])
    assert not {"box", "a", "b"} & set(poses)


@pytest.mark.parametrize(
    ("heights", "origin"),
    [
        ((0.24, 0.23, 0.22), 0.3715),
        ((0.54, 0.67), 0.0),
        ((0.48, 0.54, 0.59, 0.56), 0.0),
        ((0.06, 0.07, 0.14), 0.5435),
    ],
)
def test_a_head_begins_where_its_markers_come_to_the_head(heights, origin):
    """Heights of public sets: of Clouthier 2021, of Pose2Sim, and of a frame in the skull."""
    assert head_origin(np.array(heights)) == origin


def test_joints_that_hang_on_nothing_or_each_other_leave_the_common_ones():
    common = poses_at_zero(())
    pose = np.eye(4)
    loops = [("nowhere", "femur_r"), ("toes_l", "tibia_l"), ("mast", "boom"), ("boom", "mast")]
    joints = tuple(OsimJoint(parent, child, pose, np.eye(4)) for parent, child in loops)
    found = poses_at_zero(joints)
    assert found.keys() == common.keys()
    for body, place in common.items():
        np.testing.assert_array_equal(found[body], place)
