"""BVH as text: the tree's lines, its numbers, and what is refused."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput, ShapeError
from mbkf.io.bvh import BvhJoint, bvh_text
from tests.trial.exchange.bvh_reading import places, read

ORIGIN, UP = np.zeros(3), np.array([0.0, 0.5, 0.0])
CHAIN = (BvhJoint("hip", -1, ORIGIN), BvhJoint("knee", 0, -UP), BvhJoint("ankle", 1, -UP, 0.2 * UP),
         BvhJoint("chest", 0, UP, UP))  # fmt: skip


def test_the_text_is_the_format_s():
    text = bvh_text(CHAIN[:1], np.array([[0.01, 1.0, 0.02]]), np.eye(3)[None, None], 100.0)
    assert " ".join(text.split()) == (
        "HIERARCHY ROOT hip { OFFSET 0.000000 0.000000 0.000000 "
        "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation "
        "End Site { OFFSET 0.000000 0.000000 0.000000 } } "
        "MOTION Frames: 1 Frame Time: 0.01 1.000000 100.000000 2.000000 0.000000 0.000000 0.000000"
    )


def test_any_rotations_come_back():
    rng = np.random.default_rng(0)
    rotations = Rotation.random(40, random_state=1).as_matrix().reshape(10, 4, 3, 3)
    nodes, rows, _ = read(bvh_text(CHAIN, rng.normal(size=(10, 3)), rotations, 50.0))
    for row, R in zip(rows, rotations, strict=True):
        found = places(nodes, row)
        np.testing.assert_allclose(found["ankle"][0], R[0] @ R[1] @ R[2], atol=1e-7)
        np.testing.assert_allclose(found["chest"][0], R[0] @ R[3], atol=1e-7)
        np.testing.assert_allclose(
            found["chest/end"][1] - found["chest"][1], 100 * R[0] @ R[3] @ UP, atol=1e-4
        )


def test_angles_turn_on_without_jumps_through_the_middle_angle_s_singularity():
    bend = np.linspace(0.0, np.deg2rad(170.0), 60)
    rotations = Rotation.from_euler("X", bend[:, None]).as_matrix()[:, None]
    _, rows, _ = read(bvh_text(CHAIN[:1], np.zeros((60, 3)), rotations, 50.0))
    assert np.abs(np.diff(rows[:, 3:], axis=0)).max() < 3.0


def test_zeros_have_no_sign():
    small = Rotation.from_euler("ZXY", [[-1e-9, 1e-9, -1e-9]]).as_matrix()[:, None]
    text = bvh_text(CHAIN[:1], np.full((1, 3), -1e-10), small, 50.0)
    assert text.splitlines()[-1] == " ".join(["0.000000"] * 6)


def test_what_is_no_tree_is_refused():
    still = np.tile(np.eye(3), (2, 4, 1, 1))
    with pytest.raises(ShapeError, match="rotations"):
        bvh_text(CHAIN[:2], np.zeros((2, 3)), still, 50.0)
    with pytest.raises(ShapeError, match="root_m"):
        bvh_text(CHAIN, np.zeros((3, 3)), still, 50.0)
    for joints in (
        (CHAIN[0], CHAIN[1], CHAIN[3], BvhJoint("late", 1, UP)),
        (*CHAIN[:3], BvhJoint("second", -1, UP)),
        (BvhJoint("first", 0, UP), *CHAIN[1:]),
        (BvhJoint("two words", -1, UP), *CHAIN[1:]),
    ):
        with pytest.raises(InvalidInput):
            bvh_text(joints, np.zeros((2, 3)), still, 50.0)
