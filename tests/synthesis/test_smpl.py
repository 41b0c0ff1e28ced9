"""SMPL joint rotations on our body: segments turn as the skeleton's parts, and rates are those of the course."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.amass import JOINTS, SmplMotion
from mbkf.model.human import HumanModel
from mbkf.synthesis.smpl import SEGMENTS, motion_of_smpl
from tests.smpl_files import RATE_HZ, UPRIGHT, walked, waves

MODEL = HumanModel.scaled()
MADE = SmplMotion(RATE_HZ, waves(1.0), walked(100))
MOVED = motion_of_smpl(MODEL, MADE)
EXACT = [segment for segment in SEGMENTS if segment != "neck" and not segment.endswith("toes")]
LEG = [f"{side}_{part}" for side in ("left", "right") for part in ("hip", "knee", "ankle")]


def posed(**turns_deg):
    """Places of the segments' origins of a person who faces +x, with joints turned about SMPL's axes (deg)."""
    rotations = np.zeros((6, 22, 3))
    rotations[:, 0] = Rotation.from_matrix(UPRIGHT).as_rotvec()
    for joint, turn in turns_deg.items():
        rotations[:, JOINTS.index(joint)] = np.radians(turn)
    q = motion_of_smpl(MODEL, SmplMotion(RATE_HZ, rotations, np.zeros((6, 3)))).q[0]
    origins = MODEL.placements(q)[1]
    return {segment: origins[joint.joint_id] for segment, joint in MODEL.joints.items()}


def placed(frame):
    """Rotation of every segment in the world."""
    R = MODEL.placements(MOVED.q[frame])[0]
    return {segment: Rotation.from_matrix(R[joint.joint_id]) for segment, joint in MODEL.joints.items()}


def skeleton(frame):
    """Rotation of every SMPL part in the world, down the chains as the skeleton names them."""
    turn = {joint: Rotation.from_rotvec(np.array(MADE.rotations[frame, k])) for k, joint in enumerate(JOINTS)}
    spine = turn["pelvis"] * turn["spine1"] * turn["spine2"] * turn["spine3"]
    parts = {"pelvis": turn["pelvis"], "spine3": spine, "head": spine * turn["neck"] * turn["head"]}
    for side in ("left", "right"):
        shoulder = spine * turn[f"{side}_collar"]
        for names, at in (
            (("hip", "knee", "ankle"), turn["pelvis"]),
            (("shoulder", "elbow", "wrist"), shoulder),
        ):
            for name in (f"{side}_{name}" for name in names):
                parts[name] = at = at * turn[name]  # noqa: PLW2901 (down the chain)
    return parts


@pytest.mark.parametrize("frame", [0, 37, 99])
def test_segments_turn_as_the_skeletons_parts(frame):
    """From any segment to any other: the turn of the parts, seen in the segments' axes at rest."""
    found, wanted = placed(frame), skeleton(frame)
    rest = Rotation.from_matrix(UPRIGHT)
    for segment in EXACT:
        side, _, part = segment.partition("_")
        arm = {"left": 90.0, "right": -90.0}[side] if part in ("upper_arm", "forearm", "hand") else 0.0
        hanging = rest.inv() * Rotation.from_euler("x", arm, degrees=True)
        assert (found[segment].inv() * wanted[SEGMENTS[segment]] * hanging).magnitude() < 1e-6, segment


def test_joint_rotations_of_the_legs_are_those_of_the_file():
    for frame in (0, 50):
        found = placed(frame)
        parents = {"hip": "pelvis", "knee": "thigh", "ankle": "shank"}
        for joint in LEG:
            side, _, name = joint.partition("_")
            parent = "pelvis" if name == "hip" else f"{side}_{parents[name]}"
            segment = next(one for one, carried in SEGMENTS.items() if carried == joint)
            turn = found[parent].inv() * found[segment]
            axes = Rotation.from_matrix(UPRIGHT).inv()
            in_smpl = axes * turn * axes.inv()
            np.testing.assert_allclose(
                in_smpl.as_rotvec(), MADE.rotations[frame, JOINTS.index(joint)], atol=1e-6, rtol=0
            )


def test_the_rest_has_its_arms_to_the_sides_palms_down():
    at = posed()
    arm = at["left_hand"] - at["left_upper_arm"]
    np.testing.assert_allclose(arm / np.linalg.norm(arm), [0, 1, 0], atol=1e-9)
    assert at["right_hand"][1] < -0.5 < 0.5 < at["left_hand"][1]
    assert np.allclose(0.5 * (at["left_thigh"] + at["right_thigh"]), 0.0, atol=1e-12)
    assert at["head"][2] > 0.5 and at["left_foot"][2] < -0.7
    assert at["left_toes"][0] > 0.05 and at["right_toes"][0] > 0.05


def test_known_turns_move_limbs_where_they_do_in_smpl():
    """About SMPL's x (left) the hip lifts the knee and the knee takes the foot back; about its z the arm hangs."""
    rest, knee, hip = posed(), posed(left_knee=(90, 0, 0)), posed(right_hip=(-90, 0, 0))
    assert knee["left_foot"][0] < rest["left_shank"][0] - 0.3
    assert hip["right_shank"][0] > rest["right_thigh"][0] + 0.3
    hung = posed(left_shoulder=(0, 0, -90), right_shoulder=(0, 0, 90))
    for side in ("left", "right"):
        assert hung[f"{side}_hand"][2] < hung[f"{side}_upper_arm"][2] - 0.4
    palms = motion_of_smpl(MODEL, SmplMotion(RATE_HZ, hanging(), np.zeros((6, 3)))).q[0]
    joint = MODEL.joint("left_upper_arm")
    np.testing.assert_allclose(
        np.abs(palms[joint.q]), [0, 0, 0, 1], atol=1e-9
    )  # as ours stands: palms face in


def hanging():
    rotations = np.zeros((6, 22, 3))
    rotations[:, 0] = Rotation.from_matrix(UPRIGHT).as_rotvec()
    rotations[:, JOINTS.index("left_shoulder"), 2] = -0.5 * np.pi
    return rotations


def test_a_world_with_y_up_is_turned():
    rotations = np.zeros((6, 22, 3))
    q = motion_of_smpl(MODEL, SmplMotion(RATE_HZ, rotations, np.tile([1.0, 2.0, 3.0], (6, 1))), up="y").q[0]
    origins = MODEL.placements(q)[1]
    middle = 0.5 * sum(origins[MODEL.joint(f"{side}_thigh").joint_id] for side in ("left", "right"))
    np.testing.assert_allclose(middle, [3.0, 1.0, 2.0], atol=1e-12)
    assert origins[MODEL.joint("head").joint_id][2] > middle[2] + 0.5


def test_velocities_and_accelerations_are_those_of_the_course():
    dt = 1.0 / RATE_HZ
    for frame in (3, 50, 96):
        q, v, a = MOVED.q, MOVED.v, MOVED.a
        near, far = (MODEL.difference(q[frame - k], q[frame + k]) for k in (1, 2))
        change = (8.0 * near - far) / (12.0 * dt)
        np.testing.assert_allclose(v[frame], change, atol=2e-3)
        np.testing.assert_allclose(a[frame], (v[frame + 1] - v[frame - 1]) / (2 * dt), atol=0.05)


def test_other_axes_and_short_motions_are_refused():
    with pytest.raises(UnknownName, match="--up"):
        motion_of_smpl(MODEL, MADE, "x")
    with pytest.raises(InvalidInput, match="5 frames"):
        motion_of_smpl(MODEL, SmplMotion(RATE_HZ, np.zeros((5, 22, 3)), np.zeros((5, 3))))
