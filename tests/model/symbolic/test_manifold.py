"""Steps and differences of joints: Pinocchio's numbers, one the reverse of the other, derivatives at every turn."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from mbkf.model.symbolic import manifold
from tests.motions import assert_near

FREE, SPHERICAL = pin.liegroups.SE3(), pin.liegroups.SO3()
X0, X1 = ca.SX.sym("x0", 7), ca.SX.sym("x1", 7)
STEP = ca.SX.sym("step", 6)
STEP_POSE = ca.Function("step_pose", [X0, STEP], [manifold.stepped_pose(X0, STEP)])
STEP_TURN = ca.Function("step_turn", [X0, STEP], [manifold.stepped_rotation(X0[3:], STEP[3:])])
POSES = ca.Function("poses", [X0, X1], [manifold.pose_difference(X0, X1)])
TURNS = ca.Function("turns", [X0, X1], [manifold.rotation_difference(X0[3:], X1[3:])])

ANGLES = (0.0, 1e-9, 1e-4, np.sqrt(manifold.NEAR) * (1 - 1e-9), np.sqrt(manifold.NEAR) * (1 + 1e-9), 1.0, 3.0)
"""About the switch between series and formula, and on both sides of it, rad."""


def step_of(angle, seed=1):
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=3)
    return np.concatenate([rng.normal(size=3), angle * turn / np.linalg.norm(turn)])


def numbers(expression):
    return ca.DM(expression).full().ravel()


@pytest.mark.parametrize("angle", [*ANGLES, 4.5, 6.0])
def test_steps_are_those_of_pinocchio(angle):
    x, step = FREE.random(), step_of(angle)
    assert_near(numbers(STEP_POSE(x, step)), FREE.integrate(x, step), 1e-13)
    assert_near(numbers(STEP_TURN(x, step)), SPHERICAL.integrate(x[3:], step[3:]), 1e-13)


@pytest.mark.parametrize("angle", ANGLES)
def test_differences_undo_steps_and_are_those_of_pinocchio(angle):
    x, step = FREE.random(), step_of(angle)
    other = FREE.integrate(x, step)
    assert_near(numbers(POSES(x, other)), step, 1e-13)
    assert_near(numbers(TURNS(x, -other)), step[3:], 1e-13)
    assert_near(numbers(POSES(x, other)), FREE.difference(x, other), 1e-12)


@pytest.mark.parametrize("angle", ANGLES)
def test_derivatives_exist_at_every_turn(angle):
    """Against Pinocchio's, through the tangent space: d difference(x, x ⊕ δ) / dδ is the identity."""
    chained = ca.jacobian(manifold.pose_difference(X0, manifold.stepped_pose(X0, STEP)), STEP)
    found = ca.Function("chained", [X0, STEP], [chained])(FREE.random(), step_of(angle)).full()
    assert_near(found, np.eye(6), 1e-10)


def test_second_derivatives_at_rest():
    """q ⊕ δ of the identity has the quaternion (δ/2, 1 − |δ|²/8)."""
    w = manifold.stepped_rotation(X0[3:], STEP[3:])[3]
    hessian = ca.Function("hessian", [X0, STEP], [ca.hessian(w, STEP[3:])[0]])
    found = hessian(np.r_[np.zeros(6), 1.0], np.zeros(6)).full()
    assert_near(found, -0.25 * np.eye(3), 1e-12)
