"""Spatial algebra: transforms and crosses against Pinocchio, constants with structural zeros."""

import casadi as ca
import numpy as np
import pinocchio as pin

from mbkf.model.symbolic.spatial import constant, motion_cross, motion_transform, rotation_about, rotation_of
from tests.motions import assert_near

RNG = np.random.default_rng(5)


def numbers(expression):
    return ca.DM(expression).full()


def test_a_motion_is_seen_from_a_frame_as_pinocchio_sees_it():
    place, motion = pin.SE3.Random(), RNG.normal(size=6)
    X = numbers(motion_transform(ca.SX(place.rotation), ca.SX(place.translation)))
    assert_near(X @ motion, place.actInv(pin.Motion(motion)).vector, 1e-14)


def test_crosses_are_those_of_motions_and_forces():
    v, m, f = RNG.normal(size=(3, 6))
    X = numbers(motion_cross(ca.SX(v)))
    assert_near(X @ m, pin.Motion(v).cross(pin.Motion(m)).vector, 1e-14)
    assert_near(-X.T @ f, pin.Motion(v).cross(pin.Force(f)).vector, 1e-14)


def test_rotations_of_a_quaternion_and_about_an_axis():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    turn = pin.exp3(0.7 * axis)
    assert_near(numbers(rotation_about(axis, ca.SX(0.7))), turn, 1e-14)
    assert_near(numbers(rotation_of(ca.SX(pin.Quaternion(turn).coeffs()))), turn, 1e-14)


def test_zeros_of_constants_are_structural():
    assert constant(np.diag([1.0, 0.0, 2.0])).nnz() == 2
