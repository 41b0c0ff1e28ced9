"""The body: Table 4.2 and its scaling laws, mirror symmetry, and the mechanics against first principles."""

import tomllib

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, data_folder
from mbkf.errors import InvalidInput, ShapeError, UnknownName
from mbkf.model.human import HumanModel
from mbkf.model.sides import mirrored
from tests.motions import (
    assert_near,
    central_difference,
    moderate_pose,
    random_model,
    reference_model,
    smooth_motion,
    worst,
)

TABLE_4_2 = {  # mass kg, com m, inertia 1e-2 kg m²; shank's y and z of the com corrected
    "pelvis": (14.200, (0, 0, -0.211), (26.220, 13.450, 26.220)),
    "torso": (24.950, (0, 0, 0.101), (24.640, 37.190, 19.210)),
    "neck": (1.061, (0, 0, 0.061), (0.268, 0.215, 0.215)),
    "head": (4.241, (0.051, 0, 0.020), (2.453, 2.249, 2.034)),
    "right_upper_arm": (1.992, (0.005, 0.008, -0.133), (1.666, 1.775, 0.340)),
    "right_forearm": (1.402, (0.003, -0.003, -0.104), (0.687, 0.639, 0.106)),
    "right_hand": (0.489, (0, 0, -0.093), (0.148, 0.146, 0.067)),
    "right_thigh": (9.843, (-0.018, -0.014, -0.186), (15.592, 16.686, 4.171)),
    "right_shank": (3.626, (-0.021, -0.003, -0.180), (5.479, 5.479, 0.699)),
    "right_foot": (1.093, (0.050, -0.005, -0.033), (0.090, 0.430, 0.430)),
    "right_toes": (0.089, (0.039, 0.002, -0.005), (0.006, 0.003, 0.010)),
}

TABLE_4_1 = {  # numbers of the factors on x, y, z, from 1
    "pelvis": (1, 2, 18), "torso": (1, 4, 3), "neck": (5, 5, 5), "head": (5, 5, 5),
    "right_upper_arm": (6, 6, 6), "right_forearm": (7, 7, 7), "right_hand": (7, 7, 7),
    "left_upper_arm": (8, 8, 8), "left_forearm": (9, 9, 9), "left_hand": (9, 9, 9),
    "right_thigh": (10, 10, 10), "right_shank": (11, 11, 11), "right_foot": (12, 13, None),
    "right_toes": (12, 13, None), "left_thigh": (14, 14, 14), "left_shank": (15, 15, 15),
    "left_foot": (16, 17, None), "left_toes": (16, 17, None),
}  # fmt: skip

MIRROR = np.array([1.0, -1.0, 1.0])
FACTORS = st.lists(st.floats(0.5, 1.6), min_size=18, max_size=18)
RNG_SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])


def body_of(model, segment):
    return model.pin_model.inertias[model.joint(segment).joint_id]


def file_table():
    return tomllib.loads((data_folder("models") / "human18.toml").read_text(encoding="utf-8"))


def test_18_segments_52_dof():
    model = reference_model()
    assert len(model.joints) == 18
    assert model.nv == 6 + 3 + 2 + 3 + 6 * 3 + 6 * 3 + 2 == 52
    assert model.nq == 52 + 1 + sum(joint.kind == "spherical" for joint in model.joints.values())
    assert model.pin_model.check(pin.Data(model.pin_model))


def test_joints_tile_configuration_and_tangent_space():
    joints = list(reference_model().joints.values())
    for attribute, size in (("q", 67), ("v", 52)):
        slices = [getattr(joint, attribute) for joint in joints]
        assert [s.start for s in slices] == [0, *(s.stop for s in slices[:-1])]
        assert slices[-1].stop == size


def test_the_reference_body_weighs_what_the_table_says():
    total = sum(TABLE_4_2[s][0] * (2 if s.startswith("right_") else 1) for s in TABLE_4_2)
    assert total == pytest.approx(81.52, abs=1e-9)
    assert reference_model().mass_kg == 81.52


@given(FACTORS, st.floats(20.0, 200.0))
@settings(max_examples=40, deadline=None)
def test_total_mass_is_the_subjects(scale, mass):
    model = HumanModel(reference_model().description, np.array(scale), mass)
    assert sum(i.mass for i in model.pin_model.inertias) == pytest.approx(mass, abs=1e-9)


@pytest.mark.parametrize("segment", TABLE_4_2)
def test_table_4_2_at_scale_one(segment):
    mass, com, inertia = TABLE_4_2[segment]
    body = body_of(reference_model(), segment)
    assert body.mass == pytest.approx(mass, rel=1e-12)
    assert_near(body.lever, com, 1e-12)
    rounding = 5e-6 if segment == "right_toes" else 1e-12  # the toes' moments round to the printed ones
    assert_near(np.diag(body.inertia), 1e-2 * np.array(inertia), rounding)
    assert worst(body.inertia - np.diag(np.diag(body.inertia))) == 0.0


@pytest.mark.parametrize("segment", TABLE_4_2)
def test_moments_belong_to_a_real_body(segment):
    a, b, c = np.sort(np.diag(body_of(reference_model(), segment).inertia))
    assert a > 0
    assert c <= a + b


def test_printed_values_stay_visible_beside_the_corrected_ones():
    segments = {entry["name"]: entry for entry in file_table()["segment"]}
    for side, sign in (("right", 1), ("left", -1)):
        shank, toes = segments[f"{side}_shank"], segments[f"{side}_toes"]
        assert shank["com_printed_m"] == [-0.021, -0.030 * sign, 0.180]
        assert shank["com_m"] == [-0.021, -0.003 * sign, -0.180]
        assert toes["inertia_printed_kg_m2"] == [6e-5, 3e-5, 10e-5]
        np.testing.assert_array_equal(np.round(toes["inertia_kg_m2"], 5), toes["inertia_printed_kg_m2"])
        assert shank["com_correction"]
        assert toes["inertia_correction"]


def test_every_number_names_its_source():
    table = file_table()
    for entry in table["segment"]:
        assert entry["origin_source"].strip(), entry["name"]
        assert entry["inertia_source"].strip(), entry["name"]
    for entry in table["landmark"]:
        assert entry["source"].strip(), entry["name"]
    for entry in table["skin"]:
        assert entry["spread_source"].strip(), entry["segment"]


@given(FACTORS)
@settings(max_examples=30, deadline=None)
def test_table_4_1_says_which_factor_scales_which_axis(values):
    scale = np.array(values)
    model = HumanModel(reference_model().description, scale, 81.52)
    assert set(TABLE_4_1) == set(model.joints)
    for name, numbers in TABLE_4_1.items():
        mean = (scale[numbers[0] - 1] + scale[numbers[1] - 1]) / 2
        expected = [mean if number is None else scale[number - 1] for number in numbers]
        np.testing.assert_allclose(model.axis_scale(model.description.segment(name)), expected, rtol=1e-15)


@given(FACTORS, st.floats(20.0, 200.0))
@settings(max_examples=30, deadline=None)
def test_scaling_laws(values, mass):
    """Masses by k_m, centres of mass by k, inertias by k_m k² (thesis eqs. 4.2–4.4), joint places by the parent's k."""
    description, scale = reference_model().description, np.array(values)
    model, k_m = HumanModel(description, scale, mass), mass / 81.52
    length = {"pelvis": 18, "torso": 3} | {
        n: t[0] for n, t in TABLE_4_1.items() if n not in ("pelvis", "torso")
    }
    for segment in description.segments:
        body, reference = body_of(model, segment.name), body_of(reference_model(), segment.name)
        axes, k = model.axis_scale(segment), scale[length[segment.name] - 1]
        assert body.mass == pytest.approx(k_m * reference.mass, rel=1e-12)
        assert_near(body.lever, axes * reference.lever, 1e-15)
        np.testing.assert_allclose(body.inertia, k_m * k**2 * reference.inertia, rtol=1e-12)
    _, at_one = reference_model().placements(reference_model().neutral())
    _, scaled = model.placements(model.neutral())
    for segment in description.segments[1:]:
        child, parent = (model.joint(n).joint_id for n in (segment.name, segment.parent))
        axes = model.axis_scale(description.segment(segment.parent))
        assert_near(scaled[child] - scaled[parent], axes * (at_one[child] - at_one[parent]), 1e-14)


def test_left_mirrors_right():
    description = reference_model().description
    for right in description.segments:
        left = description.segment(mirrored(right.name))
        assert left.parent == mirrored(right.parent)
        assert (left.joint, left.mass_kg) == (right.joint, right.mass_kg)
        for vector in ("origin_m", "com_m"):
            np.testing.assert_array_equal(getattr(left, vector), getattr(right, vector) * MIRROR)
        for same in ("inertia_kg_m2", "posture_sd_rad", "acceleration_sd"):
            np.testing.assert_array_equal(getattr(left, same), getattr(right, same))
        swap = [description.scale_factors.index(mirrored(name)) for name in description.scale_factors]
        np.testing.assert_array_equal(left.scale_matrix, right.scale_matrix[:, swap])
        assert left.length_index == swap[right.length_index]
    for name, right in description.landmarks.items():
        left = description.landmark(mirrored(name))
        assert left.segment == mirrored(right.segment)
        np.testing.assert_array_equal(left.position_m, right.position_m * MIRROR)


def mirror_pose(model, q):
    """The pose as seen in a mirror across the plane y = 0: rotations about x and z change sign, sides swap."""
    out = q.copy()
    for joint in model.joints.values():
        own = q[joint.q].copy()
        signs = {
            "free": [1, -1, 1, -1, 1, -1, 1],
            "spherical": [-1, 1, -1, 1],
            "universal": [-1, 1],
            "hinge": [1],
        }
        out[model.joint(mirrored(joint.segment)).q] = own * signs[joint.kind]
    return out


def test_a_mirrored_pose_has_its_mass_centre_mirrored():
    model, rng = reference_model(), np.random.default_rng(4)
    q = moderate_pose(model, rng)
    assert_near(model.centre_of_mass(mirror_pose(model, q)), model.centre_of_mass(q) * MIRROR, 1e-13)


@RNG_SEEDS
def test_difference_undoes_integrate(seed):
    model, rng = reference_model(), np.random.default_rng(seed)
    q, step = moderate_pose(model, rng), rng.uniform(-1, 1, model.nv)
    assert_near(model.difference(q, model.integrate(q, step)), step, 1e-12)


@RNG_SEEDS
@pytest.mark.parametrize("segment", ["pelvis", "head", "left_hand", "right_toes"])
def test_segment_jacobian_against_finite_differences(seed, segment):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    q, local, joint = moderate_pose(model, rng), rng.uniform(-0.2, 0.2, 3), model.joint(segment).joint_id

    def point(at):
        rotations, origins = model.placements(at)
        return origins[joint] + rotations[joint] @ local

    def turned(at):
        return Rotation.from_matrix(model.placements(at)[0][joint] @ R0.T).as_rotvec()

    R0 = model.placements(q)[0][joint]
    jacobian = model.segment_jacobian(q, segment, point(q))
    turn = central_difference(model, turned, q)
    assert_near(jacobian[:3], central_difference(model, point, q), 2e-9)
    assert_near(jacobian[3:], turn, 2e-9)


@RNG_SEEDS
def test_mass_matrix_is_that_of_the_kinetic_energy(seed):
    """½ vᵀ M v = Σ ½ m |v_c|² + ½ ωᵀ I ω, with velocities from finite differences of the placements."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    q, v, h = moderate_pose(model, rng), rng.normal(size=model.nv), 1e-5
    before, after = (model.placements(model.integrate(q, sign * h * v)) for sign in (-1, 1))
    energy = 0.0
    for joint, body in enumerate(model.pin_model.inertias):
        centre = [origins[joint] + rotations[joint] @ body.lever for rotations, origins in (before, after)]
        spin = Rotation.from_matrix(before[0][joint].T @ after[0][joint]).as_rotvec() / (2 * h)
        velocity = (centre[1] - centre[0]) / (2 * h)
        energy += 0.5 * body.mass * velocity @ velocity + 0.5 * spin @ body.inertia @ spin
    M = model.mass_matrix(q)
    assert 0.5 * v @ M @ v == pytest.approx(energy, rel=1e-9)
    np.testing.assert_array_equal(M, M.T)
    assert np.linalg.eigvalsh(M).min() > 0


@RNG_SEEDS
def test_gravity_torques_are_the_gradient_of_potential_energy(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    q = moderate_pose(model, rng)
    gradient = central_difference(
        model, lambda at: model.mass_kg * GRAVITY_M_S2 * model.centre_of_mass(at)[2], q
    )
    assert_near(model.gravity_torques(q), gradient, 1e-7)


@RNG_SEEDS
def test_inverse_dynamics_is_mass_times_acceleration_plus_forces_at_rest_acceleration(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    q, v, a = moderate_pose(model, rng), rng.normal(size=model.nv), 5 * rng.normal(size=model.nv)
    bias = model.inverse_dynamics(q, v, np.zeros(model.nv))
    assert_near(model.inverse_dynamics(q, v, a), model.mass_matrix(q) @ a + bias, 2e-12)
    still = np.zeros(model.nv)
    assert_near(model.inverse_dynamics(q, still, still), model.gravity_torques(q), 1e-11)


@RNG_SEEDS
def test_root_rows_balance_linear_and_angular_momentum(seed):
    """The root's force is d/dt Σ m v_c − m g and its moment that of the angular momentum about the pelvis origin."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    motion, t, h = smooth_motion(model, rng), 0.3, 1e-4

    def bodies(at):
        rotations, origins = model.placements(motion.q(at))
        return [
            (b, origins[j] + rotations[j] @ b.lever, rotations[j])
            for j, b in enumerate(model.pin_model.inertias)
        ]

    def momentum(at):
        """Linear momentum and angular momentum about the world's origin, from positions alone."""
        p, L = np.zeros(3), np.zeros(3)
        for (b, after, R1), (_, before, R0) in zip(bodies(at + h), bodies(at - h), strict=True):
            velocity = (after - before) / (2 * h)
            spin = R0 @ Rotation.from_matrix(R0.T @ R1).as_rotvec() / (2 * h)
            R = R0 @ Rotation.from_rotvec(0.5 * Rotation.from_matrix(R0.T @ R1).as_rotvec()).as_matrix()
            p += b.mass * velocity
            L += np.cross(0.5 * (after + before), b.mass * velocity) + R @ b.inertia @ R.T @ spin
        return p, L

    (p1, L1), (p0, L0) = momentum(t + h), momentum(t - h)
    q = motion.q(t)
    weight = np.array([0, 0, -model.mass_kg * GRAVITY_M_S2])
    force = (p1 - p0) / (2 * h) - weight
    moment = (L1 - L0) / (2 * h) - np.cross(model.centre_of_mass(q), weight) - np.cross(q[:3], force)
    root = model.inverse_dynamics(q, motion.v(t), motion.a(t))[:6]
    R = model.placements(q)[0][1]
    assert_near(R @ root[:3], force, 2e-4)
    assert_near(R @ root[3:], moment, 2e-4)


def test_the_power_of_inverse_dynamics_is_the_change_of_energy():
    rng = np.random.default_rng(5)
    model = random_model(rng)
    motion, t, h = smooth_motion(model, rng), 0.7, 1e-5

    def energy(at):
        q, v = motion.q(at), motion.v(at)
        return 0.5 * v @ model.mass_matrix(q) @ v + model.mass_kg * GRAVITY_M_S2 * model.centre_of_mass(q)[2]

    power = model.inverse_dynamics(motion.q(t), motion.v(t), motion.a(t)) @ motion.v(t)
    assert power == pytest.approx((energy(t + h) - energy(t - h)) / (2 * h), abs=1e-6)


def test_the_analytic_motion_of_the_tests_has_its_own_derivatives():
    model, rng = reference_model(), np.random.default_rng(6)
    motion, t, h = smooth_motion(model, rng), 0.4, 1e-5
    v = model.difference(motion.q(t - h), motion.q(t + h)) / (2 * h)
    a = (motion.v(t + h) - motion.v(t - h)) / (2 * h)
    assert_near(motion.v(t), v, 1e-8)
    assert_near(motion.a(t), a, 1e-7)


def test_supports_says_which_dofs_move_a_segment():
    model, rng = reference_model(), np.random.default_rng(7)
    q = moderate_pose(model, rng)
    before = model.placements(q)
    for dof in range(model.nv):
        after = model.placements(model.integrate(q, 0.1 * np.eye(model.nv)[dof]))
        moved = [
            max(worst(after[i][j] - before[i][j]) for i in range(2)) > 1e-9 for j in range(len(before[0]))
        ]
        np.testing.assert_array_equal(moved, model.supports[:, dof])


@pytest.mark.parametrize("mass", [0.0, -70.0, np.nan, np.inf])
def test_impossible_masses_are_refused(mass):
    with pytest.raises(InvalidInput, match="mass must be positive"):
        HumanModel.scaled(mass_kg=mass)


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_impossible_factors_are_refused(factor):
    with pytest.raises(InvalidInput, match="scale factors must be positive"):
        HumanModel.scaled({"head": factor})


def test_wrong_shapes_and_names_are_refused():
    with pytest.raises(ShapeError, match=r"\(18,\)"):
        HumanModel(reference_model().description, np.ones(16), 70.0)
    with pytest.raises(UnknownName, match="did you mean right_thigh"):
        HumanModel.scaled({"right_tigh": 1.1})
    with pytest.raises(UnknownName, match="did you mean right_foot"):
        reference_model().joint("rightfoot")
    with pytest.raises(UnknownName, match="human18"):
        HumanModel.scaled(body="human19")


def test_a_named_factor_lands_in_its_place():
    model = HumanModel.scaled({"left_shank": 1.2}, 70.0)
    assert model.mass_kg == 70.0
    assert np.flatnonzero(model.scale != 1).tolist() == [14]
    assert not model.scale.flags.writeable


def test_frames_are_the_placements():
    """Axes and origin of every joint one below the other: a point lies at [place, 1] times its joint's rows."""
    model, rng = reference_model(), np.random.default_rng(12)
    q, place = moderate_pose(model, rng), rng.normal(size=3)
    R, p = model.placements(q)
    frames, jacobian = model.frames_and_jacobian(q)
    np.testing.assert_array_equal(frames, model.frames(q))
    np.testing.assert_array_equal(jacobian, model.placements_and_jacobian(q)[2])
    for joint in range(len(R)):
        assert_near(np.r_[place, 1.0] @ frames[4 * joint : 4 * joint + 4], R[joint] @ place + p[joint], 1e-14)
