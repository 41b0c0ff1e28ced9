"""Joints read from Pinocchio: placements, chains, and joints that have no equations here."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from mbkf.errors import InvalidInput
from mbkf.model.symbolic.tree import SymbolicTree
from tests.motions import assert_near, random_model

MODEL = random_model(np.random.default_rng(7))
TREE = SymbolicTree.of(MODEL.pin_model)


def test_placements_are_those_of_the_body():
    q = pin.randomConfiguration(MODEL.pin_model, -np.ones(MODEL.nq), np.ones(MODEL.nq))
    rotations, origins = MODEL.placements(q)
    for pose, R, origin in zip(TREE.world(ca.SX(q)), rotations[1:], origins[1:], strict=True):
        assert_near(ca.DM(pose.rotation).full(), R, 1e-14)
        assert_near(ca.DM(pose.origin).full().ravel(), origin, 1e-14)


def test_a_chain_leads_from_a_joint_to_the_root():
    foot = MODEL.joint("left_foot").joint_id
    moved = MODEL.supports[foot]
    assert TREE.chain(foot)[-1] == 0
    assert sum(TREE.joints[i].v.stop - TREE.joints[i].v.start for i in TREE.chain(foot)) == moved.sum()


def test_a_hinge_about_any_axis_is_read():
    model, axis = pin.Model(), np.array([0.6, 0.0, 0.8])
    model.addJoint(0, pin.JointModelRevoluteUnaligned(axis), pin.SE3.Random(), "hinge")
    pose = SymbolicTree.of(model).world(ca.SX([0.4]))[0]
    data = model.createData()
    pin.forwardKinematics(model, data, np.array([0.4]))
    assert_near(ca.DM(pose.rotation).full(), data.oMi[1].rotation, 1e-14)


def test_a_joint_of_another_kind_is_refused_by_its_name():
    model = pin.Model()
    model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "rail")
    with pytest.raises(InvalidInput, match=r"'rail' is a JointModelPX; .* revolute joints"):
        SymbolicTree.of(model)
