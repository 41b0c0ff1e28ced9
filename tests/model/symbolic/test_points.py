"""Points on segments: velocities are the derivatives of positions, rates of segments those of Pinocchio."""

import casadi as ca
import numpy as np
import pinocchio as pin

from mbkf.model.symbolic.points import point_kinematics, segment_rates
from mbkf.model.symbolic.tree import SymbolicTree
from tests.motions import assert_near, moderate_pose, random_model

RNG = np.random.default_rng(13)
MODEL = random_model(RNG)
TREE = SymbolicTree.of(MODEL.pin_model)
JOINTS = [MODEL.joint(name).joint_id for name in ("head", "right_hand", "left_toes")]
PLACES = RNG.normal(size=(3, 3))


def test_velocities_are_the_rates_of_positions():
    q, v, t = ca.SX.sym("q", TREE.nq), ca.SX.sym("v", TREE.nv), ca.SX.sym("t")
    _, velocity = point_kinematics(TREE, q, v, JOINTS, PLACES)
    moved, _ = point_kinematics(TREE, TREE.integrate(q, t * v), v, JOINTS, PLACES)
    rate = ca.reshape(ca.jacobian(ca.vec(moved), t), 3, 3)
    both = ca.Function("both", [q, v, t], [velocity, rate])(
        moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv), 0.0
    )
    assert_near(both[0].full(), both[1].full(), 1e-12)


def test_segments_turn_as_in_pinocchio():
    q, v = moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv)
    model, data = MODEL.pin_model, MODEL.pin_model.createData()
    pin.forwardKinematics(model, data, q, v)
    rates = segment_rates(TREE, TREE.world(ca.SX(q)), ca.SX(v))
    for index, (travel, turn) in enumerate(rates, 1):
        theirs = pin.getVelocity(model, data, index, pin.LOCAL_WORLD_ALIGNED)
        assert_near(ca.DM(ca.vertcat(travel, turn)).full().ravel(), theirs.vector, 1e-12)
