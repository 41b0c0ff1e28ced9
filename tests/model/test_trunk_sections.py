"""The trunk's moment at levels of the spine against sums over segments, top-down and bottom-up."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import NewtonEuler
from mbkf.model.trunk_sections import TrunkSections
from tests.dynamics import random_state
from tests.motions import assert_near, moderate_pose, random_model, worst

seeds = pytest.mark.parametrize("seed", range(4))
DOWN = np.array([0.0, 0.0, -GRAVITY_M_S2])
UPPER = (
    "torso",
    "neck",
    "head",
    *(f"{s}_{p}" for s in ("right", "left") for p in ("upper_arm", "forearm", "hand")),
)
NOTHING = np.zeros((3, 6))


def made(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    return model, TrunkSections(model), random_state(model, rng)


def closed(model, s):
    """(12,) wrenches on the feet with which the whole body obeys Newton's law, split in some way."""
    balance = NewtonEuler(model)
    w = s.w.copy()
    J = model.spatial_jacobian(s.q)[:, :6]
    w[6:] += np.linalg.solve(J.T, balance.tau(s.q, s.v, s.a, w)[:6])
    return w


def needed(model, sections, k, q, v, a, upper):
    """(6,) force and moment about the world's origin that a half of the body needs: its segments' changes of momentum
    less their weight, one by one."""
    data = model.pin_model.createData()
    pin.forwardKinematics(model.pin_model, data, q, v, a)
    part, total = sections.part(k), np.zeros(6)
    for segment, joint in model.joints.items():
        inertia = model.pin_model.inertias[joint.joint_id]
        if segment == "pelvis":
            rest = inertia.toDynamicParameters() - part.toDynamicParameters()
            inertia = part if upper else pin.Inertia.FromDynamicParameters(rest)
        elif (segment in UPPER) != upper:
            continue
        place, motion = data.oMi[joint.joint_id], data.v[joint.joint_id]
        R, c = place.rotation, inertia.lever
        # of the centre of mass, world axes
        turning, turned = R @ motion.angular, R @ data.a[joint.joint_id].angular
        linear = R @ (data.a[joint.joint_id].linear + np.cross(motion.angular, motion.linear))
        centre, arm = place.translation + R @ c, R @ c
        acceleration = linear + np.cross(turned, arm) + np.cross(turning, np.cross(turning, arm))
        own = R @ inertia.inertia @ R.T
        force = inertia.mass * (acceleration - DOWN)
        moment = own @ turned + np.cross(turning, own @ turning)
        total += np.r_[force, moment + np.cross(centre, force)]
    return total


def about_level(model, sections, k, q, wrench):
    """(3,) moment of a wrench about the world's origin about the k-th level, in the torso's axes."""
    rotations, origins = model.placements(q)
    pelvis, torso = (model.joint(name).joint_id for name in ("pelvis", "torso"))
    middle = origins[pelvis] + rotations[pelvis] @ sections.places_m[k]
    return rotations[torso].T @ (wrench[3:] - np.cross(middle, wrench[:3]))


def at_rest(model, rng):
    """A posture without motion."""
    zero = np.zeros(model.nv)
    return moderate_pose(model, rng), zero, zero


@seeds
def test_at_rest_both_ways_carry_the_weight_above(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    sections, (q, v, a) = TrunkSections(model), at_rest(model, rng)
    state = random_state(model, rng)
    state = type(state)(q, v, a, state.w, state.P, state.extra)
    w = closed(model, state)
    residual = NewtonEuler(model).tau(q, v, a, w)[:6]
    found = sections.moments(q, v, a, NOTHING, residual)
    assert_near(found[0], found[1], 1e-9)
    rotations, origins = model.placements(q)
    for k in range(3):
        weight = np.zeros(6)
        for segment, joint in model.joints.items():
            j, inertia = joint.joint_id, model.pin_model.inertias[joint.joint_id]
            inertia = sections.part(k) if segment == "pelvis" else inertia
            if segment in (*UPPER, "pelvis"):
                force = inertia.mass * DOWN
                weight += np.r_[force, np.cross(origins[j] + rotations[j] @ inertia.lever, force)]
        assert_near(found[0, k], -about_level(model, sections, k, q, weight), 1e-9)


@seeds
def test_in_motion_each_way_is_the_sum_over_its_own_half(seed):
    """The lower half alone gives the same moment as the upper half alone, since the whole obeys Newton's law."""
    model, sections, s = made(seed)
    w = closed(model, s)
    residual = NewtonEuler(model).tau(s.q, s.v, s.a, w)[:6]
    assert worst(residual) < 1e-9 * worst(w)
    found = sections.moments(s.q, s.v, s.a, NOTHING, residual)
    for k in range(3):
        above = needed(model, sections, k, s.q, s.v, s.a, upper=True)
        below = w[:6] + w[6:] - needed(model, sections, k, s.q, s.v, s.a, upper=False)
        assert_near(found[0, k], about_level(model, sections, k, s.q, above), 1e-9 * worst(above))
        assert_near(found[1, k], about_level(model, sections, k, s.q, below), 1e-9 * worst(above))


@seeds
def test_a_load_in_the_hands_that_is_not_known_is_missing_top_down_only(seed):
    model, sections, s = made(seed)
    w = closed(model, s)
    box = np.r_[5.0, -3.0, -150.0, np.cross([0.4, 0.1, 0.9], [5.0, -3.0, -150.0])]
    w[:6] -= box  # the feet bear it, too
    residual = NewtonEuler(model).tau(s.q, s.v, s.a, w)[:6]
    unknown = sections.moments(s.q, s.v, s.a, NOTHING, residual)
    J = model.spatial_jacobian(s.q)[:, :6]
    known = sections.moments(s.q, s.v, s.a, np.tile(box, (3, 1)), residual - J.T @ box)
    assert_near(known[0], known[1], 1e-8)
    assert_near(unknown[1], known[1], 1e-8)
    for k in range(3):
        assert_near(known[0, k] - unknown[0, k], -about_level(model, sections, k, s.q, box), 1e-8)
    assert worst(known[0] - unknown[0]) > 10.0


@seeds
def test_from_level_to_level_the_force_times_the_distance_and_the_weight_between_are_added(seed):
    """Varignon: without mass between them two levels differ by the lever of the force."""
    model, sections, s = made(seed)
    (nothing_above,) = (one for one in sections.levels if one.part_mass_kg == 0.0)
    assert nothing_above.name == "T12/L1"
    state = sections.state(s.q, s.v, s.a, NOTHING, np.zeros(6), np.zeros((6, 3 * model.nv + 12)))
    R = model.placements(s.q)[0]
    turn = R[model.joint("torso").joint_id].T @ R[model.joint("pelvis").joint_id]
    force, at_origin = state.wrench[0, 0, :3], state.wrench[0, 0, 3:]
    for k, place in enumerate(sections.places_m):
        moved = turn @ (at_origin - np.cross(place, force))
        wrench = np.r_[force, at_origin]
        assert_near(state.by_root[k] @ wrench, moved, 1e-9 * worst(at_origin))


@seeds
def test_at_the_bodys_own_joint_it_is_the_joints_torque_with_its_derivatives(seed):
    rng = np.random.default_rng(seed)
    reference = random_model(rng)
    centres = 0.01 * rng.normal(size=3 * len(reference.description.joint_centres))
    model = HumanModel(reference.description, reference.scale, reference.mass_kg, centres_m=centres)
    sections, s = TrunkSections(model), random_state(model, rng)
    whole = NewtonEuler(model).torques(s.q, s.v, s.a, s.w)
    torso = model.joint("torso").v
    state = sections.state(s.q, s.v, s.a, NOTHING, whole.tau[:6], whole.by_state[:6])
    scale = worst(whole.tau)
    assert_near(state.moment[0, 0], whole.tau[torso], 1e-10 * scale)
    assert_near(state.by_state[0, 0], whole.by_state[torso], 1e-10 * worst(whole.by_state))
    moments = sections.moments(s.q, s.v, s.a, NOTHING, whole.tau[:6])
    assert_near(state.moment, moments, 1e-10 * scale)


def test_derivatives_are_slopes():
    model, sections, s = made(0)
    balance, h, nv = NewtonEuler(model), 1e-6, model.nv
    carried = np.tile([4.0, 2.0, -80.0, -30.0, 20.0, 5.0], (3, 1)) * [[0.0], [1.0], [1.0]]

    def moments(step):
        q = model.integrate(s.q, step[:nv])
        v, a, w = s.v + step[nv : 2 * nv], s.a + step[2 * nv : 3 * nv], s.w + step[3 * nv :]
        return sections.moments(q, v, a, carried, balance.tau(q, v, a, w)[:6])

    whole = balance.torques(s.q, s.v, s.a, s.w)
    found = sections.state(s.q, s.v, s.a, carried, whole.tau[:6], whole.by_state[:6]).by_state
    rng = np.random.default_rng(3)
    for _ in range(6):
        step = rng.normal(size=3 * nv + 12)
        slope = (moments(h * step) - moments(-h * step)) / (2 * h)
        assert_near(found @ step, slope, 1e-6 * worst(slope))


def test_the_parts_above_a_level_are_trunk_head_and_arms():
    model, sections, _ = made(0)
    joints = {model.joint(name).joint_id for name in UPPER}
    for level in sections.levels:
        assert joints <= sections.joints_above(level)
        assert model.joint("right_thigh").joint_id not in sections.joints_above(level)
        bears = dict(zip(model.description.bearings, sections.bears_above(level), strict=True))
        assert bears["right_hand"] and bears["torso"] and not bears["pelvis"] and not bears["left_knee"]


def test_the_part_above_grows_with_the_person():
    body = random_model(np.random.default_rng(2)).description
    large = HumanModel(body, np.full(len(body.scale_factors), 1.2), 2.0 * body.reference_mass_kg)
    part, level = TrunkSections(large).part(2), body.levels[2]
    assert part.mass == pytest.approx(2.0 * level.part_mass_kg)
    np.testing.assert_allclose(part.lever, 1.2 * level.part_com_m)
    np.testing.assert_allclose(np.diag(part.inertia), 2.0 * 1.2**2 * level.part_inertia_kg_m2)


@seeds
def test_the_kernel_gives_the_references_loads_and_derivatives(seed, monkeypatch):
    model, sections, s = made(seed)
    whole = NewtonEuler(model).torques(s.q, s.v, s.a, s.w)
    by_state = np.pad(whole.by_state[:6], ((0, 0), (0, 6)), constant_values=0.3)
    carried = np.random.default_rng(seed).normal(size=(3, 6))
    found = sections.state(s.q, s.v, s.a, carried, whole.tau[:6], by_state)
    monkeypatch.setattr(TrunkSections, "_compiled", lambda *_: None)
    expected = sections.state(s.q, s.v, s.a, carried, whole.tau[:6], by_state)
    for name in ("wrench", "moment", "by_state", "by_root"):
        one, other = getattr(found, name), getattr(expected, name)
        assert_near(one, other, 1e-12 * worst(other))


@seeds
def test_moments_and_forces_that_the_kernel_differentiates_together_are_those_one_by_one(seed, monkeypatch):
    model, sections, s = made(seed)
    balance = NewtonEuler(model)
    found = balance.compiled_loads(s.q, s.v, s.a, s.w, sections.table)
    if found is None:
        pytest.skip("the kernel is not compiled here")
    whole = balance.torques(s.q, s.v, s.a, s.w)
    monkeypatch.setattr(TrunkSections, "_compiled", lambda *_: None)
    moments = sections.state(s.q, s.v, s.a, NOTHING, whole.tau[:6], whole.by_state[:6]).by_state
    assert_near(found[:18], moments.reshape(18, -1), 1e-12 * worst(moments))
    np.testing.assert_array_equal(found[18:], whole.by_state)


@seeds
def test_wrenches_above_levels_in_a_motion_are_those_of_the_parts_frame_by_frame(seed, monkeypatch):
    model, sections, s = made(seed)
    motion = [np.array([one, 0.5 * one]) for one in (s.q, s.v, s.a)]
    motion[0][1] = model.neutral()
    found = sections.upper_wrenches(*motion)
    monkeypatch.setattr(HumanModel, "tree", None)
    expected = TrunkSections(model).upper_wrenches(*motion)
    assert_near(found, expected, 1e-12 * worst(expected))
