"""Joint torques from motion and reactions: cases whose answer is known without the code."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.inverse_dynamics import inverse_dynamics, support_torques
from mbkf.model.newton_euler import NewtonEuler
from tests.motions import assert_near, moderate_pose, random_model, smooth_motion, track_of, worst

DOWN = np.array([0.0, 0.0, -GRAVITY_M_S2])


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture
def model(rng):
    return random_model(rng)


def pelvis_axes(model, q):
    return model.placements(q)[0][model.joint("pelvis").joint_id]


def still(model, q):
    zero = np.zeros((1, model.nv))
    return track_of(q[None], zero, zero)


def moving(model, rng, frames=6):
    return track_of(*smooth_motion(model, rng).frames(frames, 20.0))


def total_wrench(model, q, v, a):
    """(6,) force and moment about the world's origin that the ground must give for a motion."""
    root = model.inverse_dynamics(q, v, a)[:6]
    R = pelvis_axes(model, q)
    return np.r_[R @ root[:3], R @ root[3:] + np.cross(q[:3], R @ root[:3])]


def exact_foot_wrenches(model, motion, rng):
    """Any split of what the ground must give between the two feet."""
    wrench = np.zeros((len(motion.q), 2, 6))
    for t in range(len(motion.q)):
        wrench[t, 0] = rng.normal(size=6) * [100, 100, 500, 200, 200, 30]
        wrench[t, 1] = total_wrench(model, motion.q[t], motion.v[t], motion.a[t]) - wrench[t, 0]
    return wrench


def test_free_fall_needs_no_torque(model, rng):
    q = moderate_pose(model, rng)
    a = np.zeros((1, model.nv))
    a[0, :3] = pelvis_axes(model, q).T @ DOWN
    found = inverse_dynamics(model, track_of(q[None], 0 * a, a), np.zeros((1, 2, 6)))
    assert_near(found.tau, 0.0, 1e-12)
    assert_near(found.residual_force_n, 0.0, 1e-12)


def test_without_reactions_the_residual_carries_the_weight(model, rng):
    q = moderate_pose(model, rng)
    found = inverse_dynamics(model, still(model, q), np.zeros((1, 2, 6)))
    weight = model.mass_kg * DOWN
    assert_near(found.residual_force_n[0], -weight, 2e-12)
    assert_near(found.residual_moment_nm[0], -np.cross(model.centre_of_mass(q) - q[:3], weight), 2e-12)


def test_standing_still_the_feet_balance_the_weight(model, rng):
    """Both feet press towards the mass centre: no residual, and above the pelvis only gravity is held."""
    q = moderate_pose(model, rng, spread=0.2)
    weight, centre = model.mass_kg * DOWN, model.centre_of_mass(q)
    wrench = np.zeros((1, 2, 6))
    for side, share in enumerate((0.3, 0.7)):
        wrench[0, side] = np.r_[-share * weight, np.cross(centre, -share * weight)]
    found = inverse_dynamics(model, still(model, q), wrench)
    assert_near(found.residual_force_n, 0.0, 1e-12)
    assert_near(found.residual_moment_nm, 0.0, 1e-12)
    assert_near(found.tau[0, :6], 0.0, 1e-12)
    parts = ("torso", "neck", "head", "right_upper_arm", "right_hand", "left_upper_arm", "left_hand")
    above = np.r_[tuple(model.joint(part).v for part in parts)]
    assert_near(found.tau[0, above], model.gravity_torques(q)[above], 1e-13)


def test_with_the_exact_reactions_there_is_no_residual(model, rng):
    motion = moving(model, rng)
    found = inverse_dynamics(model, motion, exact_foot_wrenches(model, motion, rng))
    assert_near(found.tau[:, :6], 0.0, 1e-11)
    assert_near(found.residual_force_n, 0.0, 1e-11)
    assert_near(found.residual_moment_nm, 0.0, 1e-11)
    assert worst(found.tau[:, 6:]) > 50


def test_torques_equal_newton_euler_with_forces_on_the_feet(model, rng):
    """Pinocchio's recursive algorithm with external forces in the feet's own frames is the reference."""
    motion = moving(model, rng)
    wrench = exact_foot_wrenches(model, motion, rng)
    found = inverse_dynamics(model, motion, wrench)
    data = pin.Data(model.pin_model)
    for t in range(len(motion.q)):
        pin.forwardKinematics(model.pin_model, data, motion.q[t])
        outside = [pin.Force.Zero() for _ in range(model.pin_model.njoints)]
        for side, foot in enumerate(("right_foot", "left_foot")):
            joint = model.joint(foot).joint_id
            outside[joint] = data.oMi[joint].actInv(pin.Force(wrench[t, side]))
        expected = pin.rnea(model.pin_model, data, motion.q[t], motion.v[t], motion.a[t], outside)
        assert_near(found.tau[t], expected, 5e-12)


def supported(model, motion, rng):
    """(T, B, 6) loads on all parts that may bear them."""
    return rng.normal(size=(len(motion.q), len(model.description.bearings), 6)) * [60, 60, 200, 50, 50, 20]


def test_loads_on_other_parts_count_as_those_on_the_feet(model, rng):
    """Against Pinocchio's recursive algorithm with external forces in the segments' own frames."""
    motion = moving(model, rng)
    wrench, support = exact_foot_wrenches(model, motion, rng), supported(model, motion, rng)
    found = inverse_dynamics(model, motion, wrench, support)
    parts = model.description.bearings.values()
    data = pin.Data(model.pin_model)
    for t in range(len(motion.q)):
        pin.forwardKinematics(model.pin_model, data, motion.q[t])
        outside = [pin.Force.Zero() for _ in range(model.pin_model.njoints)]
        loads = [*zip(("right_foot", "left_foot"), wrench[t], strict=True)]
        loads += [(part.segment, own) for part, own in zip(parts, support[t], strict=True)]
        for segment, load in loads:
            joint = model.joint(segment).joint_id
            outside[joint] += data.oMi[joint].actInv(pin.Force(load))
        expected = pin.rnea(model.pin_model, data, motion.q[t], motion.v[t], motion.a[t], outside)
        assert_near(found.tau[t], expected, 5e-12)


def test_a_load_on_a_part_does_its_work_where_the_part_moves(model, rng):
    q, v = moderate_pose(model, rng), rng.normal(size=model.nv)
    support = rng.normal(size=(len(model.description.bearings), 6))
    power = sum(
        load @ model.segment_jacobian(q, part.segment, np.zeros(3)) @ v
        for part, load in zip(model.description.bearings.values(), support, strict=True)
    )
    assert support_torques(model, q, support) @ v == pytest.approx(power, abs=1e-10)


def test_parts_that_bear_nothing_or_are_not_asked_change_nothing(model, rng):
    motion = moving(model, rng, frames=3)
    wrench = exact_foot_wrenches(model, motion, rng)
    alone = inverse_dynamics(model, motion, wrench).tau
    for nothing in (0.0, np.nan):
        support = np.full((3, len(model.description.bearings), 6), nothing)
        np.testing.assert_array_equal(inverse_dynamics(model, motion, wrench, support).tau, alone)


def test_the_power_of_torques_and_reactions_changes_the_energy(model, rng):
    """d/dt (½ vᵀ M v + m g z) = τ·v + Σ (F·v_o + M·ω) of the feet."""
    source, t, h = smooth_motion(model, rng), 0.35, 1e-5
    q, v, a = source.q(t), source.v(t), source.a(t)
    motion = track_of(q[None], v[None], a[None])
    wrench = exact_foot_wrenches(model, motion, rng)

    def energy(at):
        M = model.mass_matrix(source.q(at))
        return 0.5 * source.v(at) @ M @ source.v(at) - model.mass_kg * DOWN @ model.centre_of_mass(
            source.q(at)
        )

    power = inverse_dynamics(model, motion, wrench).tau[0] @ v
    for side, foot in enumerate(("right_foot", "left_foot")):
        power += wrench[0, side] @ model.segment_jacobian(q, foot, np.zeros(3)) @ v
    assert power == pytest.approx((energy(t + h) - energy(t - h)) / (2 * h), abs=3e-7)


def test_residual_is_the_first_six_torques_in_world_axes(model, rng):
    motion = moving(model, rng, frames=2)
    found = inverse_dynamics(model, motion, np.zeros((2, 2, 6)))
    for t in range(2):
        R = pelvis_axes(model, motion.q[t])
        assert_near(found.residual_force_n[t], R @ found.tau[t, :3], 1e-10)
        assert_near(found.residual_moment_nm[t], R @ found.tau[t, 3:6], 1e-10)


def test_frames_not_followed_stay_nan(model, rng):
    motion = moving(model, rng, frames=3)
    motion.a[1] = np.nan
    found = inverse_dynamics(model, motion, np.zeros((3, 2, 6)))
    for values in (found.tau, found.residual_force_n, found.residual_moment_nm):
        assert np.isnan(values[1]).all()
        assert np.isfinite(values[[0, 2]]).all()


def test_one_instant_and_a_whole_trial_agree(model, rng):
    motion = moving(model, rng, frames=3)
    wrench, balance = exact_foot_wrenches(model, motion, rng), NewtonEuler(model)
    found = inverse_dynamics(model, motion, wrench)
    for t in range(3):
        one = balance.tau(motion.q[t], motion.v[t], motion.a[t], wrench[t].ravel())
        np.testing.assert_array_equal(one, found.tau[t])
