"""A true motion is true: Newton and Euler, the ground's laws, human strength, exact derivatives."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.interpolate import CubicSpline

from mbkf.conventions import GRAVITY_M_S2, SIDES
from mbkf.errors import InvalidInput, UnknownName
from mbkf.synthesis.contact import FRICTION, sole_outline
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.strength import overloaded
from mbkf.synthesis.support import SEGMENTS

pytestmark = pytest.mark.slow


def momentum(body, motion):
    """(T, 6) linear momentum and angular momentum about the centre of mass."""
    data = pin.Data(body.pin_model)
    return np.array(
        [
            pin.computeCentroidalMomentum(body.pin_model, data, q, v).vector.copy()
            for q, v in zip(motion.q, motion.v, strict=True)
        ]
    )


def slopes(values, step, rate_hz):
    return (values[2 * step :] - values[: -2 * step]) * rate_hz / (2 * step)


def test_newton_and_euler_hold_at_every_frame(body, motion):
    for k in range(len(motion.q)):
        needed = body.inverse_dynamics(motion.q[k], motion.v[k], motion.a[k])
        for foot, side in enumerate(SIDES):
            jacobian = body.segment_jacobian(motion.q[k], f"{SIDE_NAMES[side]}_foot", np.zeros(3))
            needed = needed - jacobian.T @ motion.foot_wrench[k, foot]
        for name, wrench in zip(motion.support_names, motion.support_wrench[k], strict=True):
            needed = needed - body.segment_jacobian(motion.q[k], SEGMENTS[name], np.zeros(3)).T @ wrench
        assert np.abs(needed - motion.tau[k]).max() < 1e-9
        assert np.abs(motion.tau[k, :6]).max() < 1e-9


def test_acceleration_is_the_derivative_of_velocity_to_second_order(motion):
    far, mid, near = (
        np.abs(slopes(motion.v, step, motion.rate_hz) - motion.a[step:-step]) for step in (4, 2, 1)
    )
    for coarse, fine in ((far, mid[2:-2]), (mid, near[1:-1])):
        told = fine > 1e-9
        assert told.mean() > 0.5
        assert np.median(coarse[told] / fine[told]) == pytest.approx(4.0, rel=0.03)
    assert np.median(near) < 0.02


def test_velocity_is_the_derivative_of_configuration_to_second_order(body, motion):
    def error(step):
        q, v = motion.q, motion.v
        moved = np.array(
            [body.difference(q[k - step], q[k + step]) for k in range(step, len(q) - step, step)]
        )
        return np.abs(moved * motion.rate_hz / (2 * step) - v[step:-step:step])

    coarse, fine = error(2), error(1)
    assert np.median(coarse) / np.median(fine) == pytest.approx(4.0, rel=0.3)
    assert np.median(fine) < 1e-3


def test_momentum_changes_by_the_impulse_of_ground_and_weight(body, motion):
    every = round(motion.plate_rate_hz / motion.rate_hz)
    force = motion.plate_wrench[:, :, :3].sum(axis=1) - [0, 0, body.mass_kg * GRAVITY_M_S2]
    carried = motion.support_wrench[:, :, :3].sum(axis=1)
    force += CubicSpline(motion.times_s, carried)(np.arange(len(force)) / motion.plate_rate_hz)
    steps = 0.5 * (force[1:] + force[:-1]) / motion.plate_rate_hz
    impulse = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])[::every]
    change = momentum(body, motion)[:, :3]
    assert np.abs(change - change[0] - impulse).max() < 2e-3 * body.mass_kg


def test_ground_only_pushes_and_does_not_slip(motion):
    vertical = motion.plate_wrench[:, :, 2]
    assert vertical.min() >= 0
    assert (np.linalg.norm(motion.plate_wrench[:, :, :2], axis=2) <= FRICTION * vertical + 1e-9).all()


def test_pressure_stays_under_the_soles_and_carries_the_moment(body, motion):
    for foot, side in enumerate(SIDES):
        outline, joint = sole_outline(body, side), body.joint(f"{SIDE_NAMES[side]}_foot").joint_id
        loaded = motion.foot_wrench[:, foot, 2] > 0
        assert np.isnan(motion.centre_of_pressure[~loaded, foot]).all()
        for k in np.flatnonzero(loaded):
            rotations, origins = body.placements(motion.q[k])
            point = motion.centre_of_pressure[k, foot]
            assert outline.holds(rotations[joint].T @ (point - origins[joint]))
            force, moment = motion.foot_wrench[k, foot, :3], motion.foot_wrench[k, foot, 3:]
            assert np.abs((moment - np.cross(point, force))[:2]).max() < 1e-9


def test_people_are_strong_enough(body, motion):
    assert overloaded(body, motion.tau) == ""


def test_every_joint_moves(body, motion):
    assert (np.ptp(motion.v, axis=0) > 0).all()


def test_the_whole_body_turns_and_looks_ahead(body, motions):
    motion = motions["turn"]
    yaw = {name: np.unwrap([heading(body, q, name) for q in motion.q]) for name in ("pelvis", "head")}
    for name in ("pelvis", "right_foot", "left_foot"):
        turned = np.unwrap([heading(body, q, name) for q in motion.q[[0, len(motion.q) // 2, -1]]])
        assert 85 < abs(np.rad2deg(turned[-1] - turned[0])) < 125
    ahead = np.sign(yaw["pelvis"][-1] - yaw["pelvis"][0]) * (yaw["head"] - yaw["pelvis"])
    assert ahead[len(ahead) // 4 : -len(ahead) // 4].mean() > ahead[-20:].mean() + 0.05


def heading(body, q, segment):
    """Where a segment faces, rad."""
    rotation = body.placements(q)[0][body.joint(segment).joint_id]
    return np.arctan2(rotation[1, 0], rotation[0, 0])


def test_each_foot_carries_the_body_alone_with_the_other_one_raised(body, motions):
    motion = motions["one_foot"]
    for foot, side in enumerate(("left", "right")):
        alone = motion.foot_wrench[:, foot, 2] == 0
        assert 1.1 < alone.sum() / motion.rate_hz < 1.8
        joint = body.joint(f"{('right', 'left')[foot]}_foot").joint_id
        height = [body.placements(q)[1][joint, 2] for q in motion.q]
        assert 0.1 < max(height) - height[0] < 0.28
        assert np.ptp(motion.centre_of_pressure[alone, 1 - foot], axis=0)[:2].min() > 0.002, side


def test_the_pressure_lies_on_the_step_after_stepping_up(body, motions):
    motion = motions["step_up"]
    heights = motion.centre_of_pressure[:, :, 2]
    assert not heights[0].any()
    assert 0.15 <= heights[-1, 0] <= 0.20
    assert heights[-1, 0] == heights[-1, 1]
    assert (heights[~np.isnan(heights)] >= 0).all()
    rise = body.centre_of_mass(motion.q[-1])[2] - body.centre_of_mass(motion.q[0])[2]
    assert rise == pytest.approx(heights[-1, 0], abs=0.03)


def test_reaching_moves_load_and_pressure_but_not_the_feet(motions):
    motion = motions["reach"]
    assert (motion.foot_wrench[:, :, 2] > 0).all()
    assert np.ptp(motion.centre_of_pressure, axis=0).max() > 0.01


def test_a_general_movement_has_every_kind_of_support(motions):
    loaded, heights = (
        motions["general"].foot_wrench[:, :, 2] > 0,
        motions["general"].centre_of_pressure[:, :, 2],
    )
    for kind in ([True, True], [True, False], [False, True]):
        assert (loaded == kind).all(axis=1).mean() > 0.1
    assert (np.nan_to_num(heights) > 0).any(axis=1).mean() > 0.1
    both = loaded.all(axis=1)
    assert (np.abs(heights[both, 0] - heights[both, 1]) > 0.1).any()


def test_flight_is_free_fall_with_constant_angular_momentum(body, motions):
    motion = motions["jump"]
    off, down = motion.flight_s
    air = (motion.times_s > off) & (motion.times_s < down)
    assert down - off > 0.25
    assert not motion.foot_wrench[air].any()
    moving = momentum(body, motion)[air]
    assert np.abs(moving[:, 3:] - moving[0, 3:]).max() < 1e-8
    com = np.array([body.centre_of_mass(q) for q in motion.q[air]])
    times = motion.times_s[air] - motion.times_s[air][0]
    fall = com[0] + moving[0, :3] / body.mass_kg * times[:, None]
    fall[:, 2] -= 0.5 * GRAVITY_M_S2 * times**2
    assert np.abs(com - fall).max() < 1e-9
    joint = body.joint("right_toes").joint_id
    lowest = [body.placements(q)[1][joint, 2] for q in motion.q[air]]
    resting = body.placements(motion.q[0])[1][joint, 2]
    assert max(lowest) - resting > 0.05


def test_walking_is_walking(body, motions):
    motion = motions["walk"]
    speed = np.ptp(motion.q[:, 0]) / np.ptp(motion.times_s)
    assert 1.0 < speed < 1.4
    both = (motion.foot_wrench[:, :, 2] > 0).all(axis=1)
    assert 0.1 < both.mean() < 0.4
    assert (motion.foot_wrench[:, :, 2] > 0).any(axis=1).all()
    knee = body.joint("right_shank").q
    assert 50 < np.rad2deg(2 * np.arcsin(np.linalg.norm(motion.q[:, knee][:, :3], axis=1))).max() < 80


def test_seeds_repeat_and_differ(body, motions):
    again = synthesise_motion(body, "squat", 3.0, seed=5)
    other = synthesise_motion(body, "squat", 3.0, seed=6)
    assert np.array_equal(again.q, motions["squat"].q)
    assert np.abs(other.q - again.q).max() > 0.01


@pytest.mark.parametrize(
    ("name", "seconds", "rate_hz", "error"),
    [
        ("dance", 3.0, 100.0, UnknownName),
        ("squat", 0.0, 100.0, InvalidInput),
        ("squat", float("nan"), 100.0, InvalidInput),
        ("squat", 3.0, 5.0, InvalidInput),
        ("jump", 1.5, 100.0, InvalidInput),
    ],
)
def test_wrong_requests_are_refused(body, name, seconds, rate_hz, error):
    with pytest.raises(error):
        synthesise_motion(body, name, seconds, rate_hz)
