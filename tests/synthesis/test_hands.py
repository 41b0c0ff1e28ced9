"""Hands at a place in space: they hang at first, and are where they should be while they are held."""

import numpy as np
import pytest

from mbkf.conventions import SIDES
from mbkf.synthesis.curves import path
from mbkf.synthesis.hands import held_hand, palm, shoulder
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, InverseKinematics

HELD = path([(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 0.0)], smooth=3)


@pytest.mark.parametrize("side", [0, 1])
def test_a_hand_hangs_below_the_shoulder_and_turns_to_its_place(body, side):
    wrist = np.array([0.3, 0.0, 1.0])
    hand = held_hand(body, side, HELD, wrist, -50.0)(np.array([0.0, 1.5]))[SIDES[side]]
    assert hand.held.value == pytest.approx([0.0, 1.0])
    assert np.array_equal(hand.wrist.value, np.tile(wrist, (2, 1)))
    offset = InverseKinematics(body).offset
    length = sum(-offset[f"{SIDE_NAMES[SIDES[side]]}_{part}"][2] for part in ("forearm", "hand"))
    assert 0.97 * length < np.linalg.norm(hand.hanging) < length
    assert hand.hanging[2] < -0.95 * length
    fingers = hand.rotation.value @ [0.0, 0.0, -1.0]
    assert fingers[0, 2] < -0.9
    assert fingers[1] == pytest.approx([np.sin(np.deg2rad(50.0)), 0.0, -np.cos(np.deg2rad(50.0))])


def test_the_palm_lies_along_the_hand():
    wrist = np.array([0.1, 0.2, 0.9])
    assert palm(1.1, wrist, 0.0, 0.07) == pytest.approx([0.1, 0.2, 0.9 - 0.077])
    assert palm(1.0, wrist, -90.0, 0.07) == pytest.approx([0.17, 0.2, 0.9])


@pytest.mark.parametrize("side", [0, 1])
def test_the_shoulder_of_a_standing_person(body, side):
    _, origins = body.placements(body.neutral())
    joint = body.joint(f"{SIDE_NAMES[SIDES[side]]}_upper_arm").joint_id
    foot = body.joint(f"{SIDE_NAMES[SIDES[side]]}_foot")
    sole = body.axis_scale(body.description.segment(f"{SIDE_NAMES[SIDES[side]]}_foot"))[2]
    floor = origins[foot.joint_id, 2] + sole * body.description.sole.height_m
    found = shoulder(body, side)
    assert found[2] == pytest.approx(origins[joint, 2] - floor, abs=2e-3)
    assert found[:2] == pytest.approx((origins[joint] - origins[body.joint("pelvis").joint_id])[:2])
