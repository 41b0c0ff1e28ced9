"""Recursions against each other and against Pinocchio: torques, accelerations, mass matrix, Jacobians."""

import casadi as ca
import numpy as np
import pinocchio as pin

from mbkf.model.symbolic.recursions import (
    forward_dynamics,
    inverse_dynamics,
    mass_matrix,
    solved_positive,
    world_jacobian,
)
from mbkf.model.symbolic.tree import SymbolicTree
from tests.motions import assert_near, moderate_pose, random_model

RNG = np.random.default_rng(11)
MODEL = random_model(RNG)
TREE = SymbolicTree.of(MODEL.pin_model)
HAND = MODEL.joint("left_hand").joint_id
Q, (V, A) = moderate_pose(MODEL, RNG), RNG.normal(size=(2, MODEL.nv)) * [[3.0], [20.0]]
LOAD = 100.0 * RNG.normal(size=6)
LOADS = {HAND: ca.SX(LOAD)}


def numbers(expression):
    found = ca.DM(expression).full()
    return found.ravel() if found.shape[1] == 1 else found


def test_torques_are_those_of_pinocchio_less_the_pull_of_a_load():
    pull = MODEL.segment_jacobian(Q, "left_hand", np.zeros(3)).T @ LOAD
    found = numbers(inverse_dynamics(TREE, ca.SX(Q), ca.SX(V), ca.SX(A), LOADS))
    assert_near(found, pin.rnea(MODEL.pin_model, MODEL.pin_model.createData(), Q, V, A) - pull, 1e-10)


def test_accelerations_undo_torques():
    tau = inverse_dynamics(TREE, ca.SX(Q), ca.SX(V), ca.SX(A), LOADS)
    assert_near(numbers(forward_dynamics(TREE, ca.SX(Q), ca.SX(V), tau, LOADS)), A, 1e-9)


def test_the_mass_matrix_is_that_of_the_body():
    assert_near(numbers(mass_matrix(TREE, ca.SX(Q))), MODEL.mass_matrix(Q), 1e-11)


def test_a_jacobian_is_that_of_the_segment_at_the_origin():
    J = numbers(world_jacobian(TREE, TREE.world(ca.SX(Q)), HAND))
    assert_near(J, MODEL.segment_jacobian(Q, "left_hand", np.zeros(3)), 1e-12)


def test_small_systems_are_solved():
    root = RNG.normal(size=(6, 6))
    A6, B = root @ root.T + np.eye(6), RNG.normal(size=(6, 4))
    assert_near(numbers(solved_positive(ca.SX(A6), ca.SX(B))), np.linalg.solve(A6, B), 1e-12)
