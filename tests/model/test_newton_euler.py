"""Newton–Euler of the whole body: forward against inverse dynamics, and the balance of momentum."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree
from mbkf.model.newton_euler import NewtonEuler
from tests.dynamics import random_state
from tests.motions import assert_near, random_model, worst

seeds = pytest.mark.parametrize("seed", range(4))


def made(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    return model, NewtonEuler(model), random_state(model, rng)


def pushed(model, q, wrenches):
    """(nv,) generalised forces of wrenches about the world's origin on right and left foot."""
    jacobians = [model.segment_jacobian(q, foot, np.zeros(3)) for foot in model.roles.feet]
    return sum(J.T @ w for J, w in zip(jacobians, wrenches.reshape(2, 6), strict=True))


@seeds
def test_torques_and_wrenches_cause_the_motion(seed):
    """Inverse, then forward dynamics by articulated bodies returns the acceleration."""
    model, balance, s = made(seed)
    tau = balance.tau(s.q, s.v, s.a, s.w)
    data = pin.Data(model.pin_model)
    a = pin.aba(model.pin_model, data, s.q, s.v, tau + pushed(model, s.q, s.w))
    assert worst(a - s.a) < 1e-8 * worst(s.a)


@seeds
def test_the_pelvis_rows_are_the_residual(seed):
    _, balance, s = made(seed)
    root, all_rows = balance.root(s.q, s.v, s.a, s.w), balance.torques(s.q, s.v, s.a, s.w)
    assert_near(root.residual, all_rows.tau[:6], 1e-9)
    assert_near(root.by_state, all_rows.by_state[:6], 1e-9)


@seeds
def test_torques_are_the_same_with_and_without_derivatives(seed):
    _, balance, s = made(seed)
    assert_near(balance.tau(s.q, s.v, s.a, s.w), balance.torques(s.q, s.v, s.a, s.w).tau, 1e-9)


@pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")
@seeds
def test_the_kernel_finds_the_same_torques_and_derivatives(seed, monkeypatch):
    model, compiled, s = made(seed)
    monkeypatch.setattr(CompiledTree, "where_built", lambda model: None)
    reference = NewtonEuler(model)
    expected, found = reference.torques(s.q, s.v, s.a, s.w), compiled.torques(s.q, s.v, s.a, s.w)
    assert_near(found.tau, expected.tau, 1e-12)
    assert_near(found.by_state, expected.by_state, 1e-12)
    assert_near(compiled.tau(s.q, s.v, s.a, s.w), expected.tau, 1e-12)
    motion = [np.array([one, one]) for one in (s.q, s.v, s.a, s.w)]
    for way in (compiled, reference):
        assert_near(way.motion_tau(*motion), np.array([expected.tau, expected.tau]), 1e-12)
    hand = model.joint("right_hand").joint_id
    assert_near(compiled.jacobian(hand), reference.jacobian(hand), 1e-12)


@seeds
def test_the_residual_is_what_the_momentum_lacks(seed):
    """Rate of momentum about the centre of mass − weight − wrenches, moved to the pelvis and into its axes."""
    model, balance, s = made(seed)
    data = pin.Data(model.pin_model)
    pin.computeCentroidalMomentumTimeVariation(model.pin_model, data, s.q, s.v, s.a)
    rate, com, total = data.dhg, data.com[0], s.w[:6] + s.w[6:]
    force = rate.linear - model.mass_kg * model.pin_model.gravity.linear - total[:3]
    about_com = rate.angular - (total[3:] - np.cross(com, total[:3]))
    moment = about_com + np.cross(com - s.q[:3], force)
    R = model.placements(s.q)[0][model.joint("pelvis").joint_id]
    assert_near(balance.root(s.q, s.v, s.a, s.w).residual, np.concatenate([R.T @ force, R.T @ moment]), 1e-8)


def test_a_body_in_free_fall_asks_for_nothing():
    model, balance, _ = made(1)
    q, still = model.neutral(), np.zeros(model.nv)
    a = still.copy()
    a[:3] = model.pin_model.gravity.linear
    assert worst(balance.tau(q, still, a, np.zeros(12))) < 1e-10


def test_a_wrench_on_one_foot_asks_nothing_of_the_other_leg():
    model, balance, s = made(3)
    more = s.w + np.r_[np.zeros(6), np.ones(6)]
    change = balance.tau(s.q, s.v, s.a, more) - balance.tau(s.q, s.v, s.a, s.w)
    moves = model.supports[model.joint("left_foot").joint_id]
    np.testing.assert_array_equal(change[~moves], 0.0)
    assert (np.abs(change[moves]) > 0).all()


@seeds
def test_a_load_on_any_segment_counts_as_the_ground_s_wrenches_do(seed):
    model, balance, s = made(seed)
    expected = balance.torques(s.q, s.v, s.a, s.w)
    found = balance.torques(s.q, s.v, s.a, np.zeros(12))
    feet = [model.joint(foot).joint_id for foot in model.roles.feet]
    balance.loaded(found, dict(zip(feet, s.w.reshape(2, 6), strict=True)))
    assert_near(found.tau, expected.tau, 1e-9)
    nv = model.nv
    assert_near(found.by_state[:, : 3 * nv], expected.by_state[:, : 3 * nv], 1e-9)


def test_later_calls_leave_torques_alone():
    model, balance, s = made(0)
    found = balance.torques(s.q, s.v, s.a, s.w)
    kept = [part.copy() for part in (found.tau, found.by_q, found.by_v, found.by_a, found.by_wrench)]
    balance.torques(model.neutral(), 0 * s.v, 0 * s.a, 0 * s.w)
    for part, before in zip(
        (found.tau, found.by_q, found.by_v, found.by_a, found.by_wrench), kept, strict=True
    ):
        np.testing.assert_array_equal(part, before)
