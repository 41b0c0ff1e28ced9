"""Clinical angles: what a positive angle does to the body; rates and moments against their definitions."""

import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput, ShapeError, UnknownName
from mbkf.model.angle_reading import AngleReading, JointAxes, Line
from mbkf.model.clinical import ClinicalAngles, dof_names
from mbkf.model.human import HumanModel


@pytest.fixture(scope="module")
def model():
    return HumanModel.scaled({"right_thigh": 1.05}, 70.0)


@pytest.fixture(scope="module")
def clinical(model):
    return ClinicalAngles(model)


def random_posture(model, rng, spread=0.6):
    return model.integrate(model.neutral(), rng.uniform(-spread, spread, model.nv))


def pose(model, clinical, name, value):
    """The neutral posture with one coordinate set, found through the rate matrix alone."""
    q, column = model.neutral(), clinical.names.index(name)
    for _ in range(20):
        target = np.zeros(model.nv)
        target[column] = value
        error = target - clinical.angles(q[None])[0]
        q = model.integrate(q, np.linalg.solve(clinical.rate_matrix(q), error))
    return q


def displacement(model, q, segment, point):
    """World displacement from the neutral posture of a point of a segment."""
    points = []
    for configuration in (model.neutral(), q):
        R, p = model.placements(configuration)
        j = model.joint(segment).joint_id
        points.append(p[j] + R[j] @ np.array(point))
    return points[1] - points[0]


DOWN, UP, FRONT = [0, 0, -0.3], [0, 0, 0.3], [0.2, 0, 0]
MEANINGS = [  # coordinate, segment, its point, world direction in which a positive value moves it
    ("pelvis_tilt", "pelvis", FRONT, [0, 0, 1]),
    ("pelvis_list", "pelvis", [0, 0.2, 0], [0, 0, 1]),
    ("pelvis_rotation", "pelvis", FRONT, [0, 1, 0]),
    ("pelvis_tx", "torso", UP, [1, 0, 0]),
    ("pelvis_ty", "torso", UP, [0, 0, 1]),
    ("pelvis_tz", "torso", UP, [0, -1, 0]),
    ("lumbar_extension", "torso", UP, [-1, 0, 0]),
    ("lumbar_bending", "torso", UP, [0, -1, 0]),
    ("lumbar_rotation", "torso", FRONT, [0, 1, 0]),
    ("neck_extension", "neck", UP, [-1, 0, 0]),
    ("neck_bending", "neck", UP, [0, -1, 0]),
    ("head_extension", "head", FRONT, [0, 0, 1]),
    ("head_bending", "head", UP, [0, -1, 0]),
    ("head_rotation", "head", FRONT, [0, 1, 0]),
]
SIDED = [  # on the right side; on the left the direction is mirrored in y
    ("arm_flex", "upper_arm", DOWN, [1, 0, 0]),
    ("arm_add", "upper_arm", DOWN, [0, 1, 0]),
    ("arm_rot", "upper_arm", FRONT, [0, 1, 0]),
    ("elbow_flex", "forearm", DOWN, [1, 0, 0]),
    ("elbow_adduction", "forearm", DOWN, [0, 1, 0]),
    ("pro_sup", "forearm", FRONT, [0, 1, 0]),
    ("wrist_flex", "hand", DOWN, [0, 1, 0]),
    ("wrist_dev", "hand", DOWN, [-1, 0, 0]),
    ("wrist_rotation", "hand", FRONT, [0, 1, 0]),
    ("hip_flexion", "thigh", DOWN, [1, 0, 0]),
    ("hip_adduction", "thigh", DOWN, [0, 1, 0]),
    ("hip_rotation", "thigh", FRONT, [0, 1, 0]),
    ("knee_angle", "shank", DOWN, [-1, 0, 0]),
    ("knee_adduction", "shank", DOWN, [0, 1, 0]),
    ("knee_rotation", "shank", FRONT, [0, 1, 0]),
    ("ankle_angle", "foot", FRONT, [0, 0, 1]),
    ("subtalar_angle", "foot", [0, 0.1, 0], [0, 0, 1]),
    ("ankle_rotation", "foot", FRONT, [0, 1, 0]),
    ("mtp_angle", "toes", FRONT, [0, 0, 1]),
]
for coordinate, part, place, way in SIDED:
    MEANINGS.append((f"{coordinate}_r", f"right_{part}", place, way))
    mirror = np.array([1, -1, 1])
    MEANINGS.append((f"{coordinate}_l", f"left_{part}", place * mirror, way * mirror))


@pytest.mark.parametrize(("name", "segment", "point", "direction"), MEANINGS, ids=[m[0] for m in MEANINGS])
def test_a_positive_value_moves_the_body_as_its_meaning_says(
    model, clinical, name, segment, point, direction
):
    q = pose(model, clinical, name, 0.3)
    moved = displacement(model, q, segment, point)
    assert moved @ direction > 0.9 * np.linalg.norm(moved) > 0.01
    others = np.delete(clinical.angles(q[None])[0], clinical.names.index(name))
    np.testing.assert_allclose(others, 0.0, atol=1e-10)


def test_every_coordinate_has_its_meaning_tested(clinical):
    assert sorted(clinical.names) == sorted(m[0] for m in MEANINGS)


def test_coordinates_are_as_many_as_dofs_and_zero_in_the_neutral_posture(model, clinical):
    assert len(clinical.names) == len(set(clinical.names)) == model.nv == 52
    np.testing.assert_allclose(clinical.angles(model.neutral()[None]), 0.0, atol=1e-15)
    assert clinical.units.count("m") == 3
    names = dof_names(model)
    assert len(set(names)) == 52
    assert names[:6] == ("pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_x", "pelvis_y", "pelvis_z")
    assert names[model.joint("left_toes").v] == ("left_toes_y",)
    assert names[model.joint("neck").v] == ("neck_x", "neck_y")


def test_rates_are_the_finite_difference_of_the_angles(model, clinical):
    rng, step = np.random.default_rng(0), 1e-6
    for _ in range(20):
        q, v = random_posture(model, rng), rng.normal(size=model.nv)
        pair = np.array([model.integrate(q, s * step * v) for s in (-1, 1)])
        expected = (clinical.angles(pair[1:])[0] - clinical.angles(pair[:1])[0]) / (2 * step)
        np.testing.assert_allclose(clinical.rate_matrix(q) @ v, expected, rtol=1e-6, atol=1e-7)


def test_one_angle_by_name_and_its_rate(model, clinical):
    """The derivative of each, tests/derivatives_of_bodies.py checks on the manifold."""
    rng, step = np.random.default_rng(8), 1e-6
    q, v = random_posture(model, rng), rng.normal(size=model.nv)
    for name, expected in zip(clinical.names, clinical.angles(q[None])[0], strict=True):
        assert clinical.value(name, q) == expected
        after, before = (clinical.value(name, model.integrate(q, s * step * v)) for s in (1, -1))
        assert clinical.rate(name, q, v) == pytest.approx((after - before) / (2 * step), rel=1e-6, abs=1e-7)


def test_an_unknown_angle_is_refused_with_the_known_ones(model, clinical):
    with pytest.raises(UnknownName, match=r"knee_flexion.*did you mean"):
        clinical.value("knee_flexion_r", model.neutral())


def test_power_of_moments_equals_power_of_torques_joint_by_joint(model, clinical):
    rng = np.random.default_rng(1)
    q = np.array([random_posture(model, rng) for _ in range(30)])
    v, tau = rng.normal(size=(2, 30, model.nv))
    rates = np.einsum("tij,tj->ti", clinical.rate_matrices(q), v)
    moments = clinical.moments(q, tau)
    column = 0
    for joint, place in zip(clinical.joints, model.joints.values(), strict=True):
        columns = slice(column, column + len(joint.coordinates))
        column = columns.stop
        power = (moments[:, columns] * rates[:, columns]).sum(1)
        np.testing.assert_allclose(power, (tau[:, place.v] * v[:, place.v]).sum(1), rtol=1e-10, atol=1e-10)


def test_arm_raised_sideways_beyond_the_singularity(model, clinical):
    lift = np.deg2rad(150.0) * np.sin(np.linspace(0, np.pi / 2, 80))
    q = np.tile(model.neutral(), (80, 1))
    vector = np.zeros((80, model.nv))
    vector[:, model.joint("right_upper_arm").v.start] = -lift
    q = np.array([model.integrate(a, b) for a, b in zip(q, vector, strict=True)])
    angles = clinical.angles(q)
    column = clinical.names.index("arm_add_r")
    np.testing.assert_allclose(angles[:, column], -lift, atol=1e-9)
    np.testing.assert_allclose(np.delete(angles, column, axis=1), 0.0, atol=1e-9)
    flags = clinical.singular(angles)
    np.testing.assert_array_equal(flags[:, column], np.abs(np.rad2deg(lift) - 90.0) < 10.0)
    assert flags.any(axis=0).sum() == 3
    v = np.zeros(model.nv)
    v[model.joint("right_upper_arm").v.start] = -1.0
    rates = clinical.rate_matrices(q, angles) @ v
    np.testing.assert_allclose(rates[:, column], -1.0, atol=1e-9)
    tau = np.tile(v, (80, 1))
    np.testing.assert_allclose(clinical.moments(q, tau, angles)[:, column], -1.0, atol=1e-9)


def test_a_stream_continues_as_the_whole_motion_and_missing_frames_stay_missing(model, clinical):
    t = np.linspace(0, 3, 90)
    turn = np.zeros((90, model.nv))
    turn[:, 5] = 4.0 * t
    q = np.array([model.integrate(model.neutral(), v) for v in turn])
    q[30:33] = np.nan
    whole, last, stream = clinical.angles(q), None, []
    for frame in q:
        stream.append(clinical.angles(frame[None], last)[0])
        last = stream[-1] if np.isfinite(stream[-1]).all() else last
    np.testing.assert_array_equal(whole, stream)
    assert np.isnan(whole[30:33]).all()
    assert whole[-1, clinical.names.index("pelvis_rotation")] == pytest.approx(12.0)


def test_a_frame_takes_less_than_half_a_millisecond(model, clinical):
    q = random_posture(model, np.random.default_rng(2))
    times = []
    for _ in range(50):
        start = time.perf_counter()
        clinical.rate_matrix(q)
        times.append(time.perf_counter() - start)
    assert np.min(times) < 1e-3


def test_wrong_shapes_are_refused(model, clinical):
    with pytest.raises(ShapeError, match="q must have shape"):
        clinical.angles(model.neutral())
    with pytest.raises(ShapeError, match="tau"):
        clinical.moments(model.neutral()[None], np.zeros((1, 3)))
    with pytest.raises(ShapeError, match="tau_sd"):
        clinical.moments_sd(model.neutral()[None], np.zeros((2, model.nv)))
    with pytest.raises(ShapeError, match="q must have shape"):
        clinical.angles(model.neutral()[None, None])
    with pytest.raises(ShapeError, match="angles"):
        clinical.rate_matrices(model.neutral()[None], np.zeros((2, model.nv)))


def turned(seed, most=0.4):
    return Rotation.from_rotvec(np.random.default_rng(seed).uniform(-most, most, 3)).as_matrix()


LINE = Line(turned(5), turned(6))
READING = AngleReading(
    "made up",
    {
        "pelvis": JointAxes(np.eye(3), turned(1)),
        "hip_r": JointAxes(turned(1), turned(2)),
        "knee_l": JointAxes(turned(2), turned(3), "xzy"),
        "ankle_r": JointAxes(turned(3), turned(4), "yzx", LINE),
    },
)


def test_axes_that_do_not_turn_give_the_models_angles(model, clinical):
    rng = np.random.default_rng(20)
    q = np.array([random_posture(model, rng) for _ in range(6)])
    same = JointAxes(np.eye(3), np.eye(3))
    other = ClinicalAngles(model, AngleReading("same", {joint.name: same for joint in clinical.joints}))
    np.testing.assert_allclose(other.angles(q), clinical.angles(q), atol=1e-14)
    np.testing.assert_allclose(other.rate_matrices(q), clinical.rate_matrices(q), atol=1e-13)


def test_only_the_joints_of_a_reading_are_read_otherwise(model, clinical):
    q = random_posture(model, np.random.default_rng(21))[None]
    found = ClinicalAngles(model, READING).angles(q)[0] - clinical.angles(q)[0]
    changed = {
        name.rsplit("_", 2)[0] for name, by in zip(clinical.names, found, strict=True) if abs(by) > 1e-9
    }
    assert {"hip", "knee", "ankle", "pelvis"} & {name.split("_")[0] for name in changed} == {
        "hip", "knee", "ankle", "pelvis",
    }  # fmt: skip
    for name in (
        "hip_flexion_l",
        "knee_angle_r",
        "ankle_angle_l",
        "lumbar_extension",
        "pelvis_tx",
        "mtp_angle_r",
    ):
        assert found[clinical.names.index(name)] == 0.0


def test_rates_of_a_reading_by_finite_differences(model):
    """θ̇ = E v with axes turned, an order of their own, and a foot of which a line is read."""
    rng, h = np.random.default_rng(22), 1e-6
    read = ClinicalAngles(model, READING)
    for _ in range(5):
        q, v = random_posture(model, rng), rng.normal(size=model.nv)
        before, after = read.angles(np.array([model.integrate(q, s * h * v) for s in (-1, 1)]))
        np.testing.assert_allclose(read.rate_matrix(q) @ v, (after - before) / (2 * h), rtol=0, atol=2e-7)


def test_a_laboratory_turned_about_the_vertical_turns_the_pelvis_only(model):
    """The pelvis's tilt and list stay, too; its rotation grows by the angle."""
    rng, angle = np.random.default_rng(23), 0.3
    read = ClinicalAngles(
        model, AngleReading("heading first", {"pelvis": JointAxes(np.eye(3), turned(1), "zyx")})
    )
    q = np.array([random_posture(model, rng) for _ in range(4)])
    change = read.angles(read.against(np.full(4, -angle), q)) - read.angles(q)
    expected = np.zeros_like(change)
    expected[:, read.names.index("pelvis_rotation")] = angle
    np.testing.assert_allclose(change, expected, atol=1e-12)


def test_spreads_of_a_reading_by_finite_differences(model):
    """Var θ = J P Jᵀ with the covariance of each joint's rotation."""
    rng, h = np.random.default_rng(24), 1e-6
    read = ClinicalAngles(model, READING)
    q = random_posture(model, rng)
    A = 0.1 * rng.normal(size=(model.nv, model.nv))
    P = A @ A.T
    steps = h * np.eye(model.nv)
    J = np.column_stack([
        np.diff(read.angles(np.array([model.integrate(q, s * step) for s in (-1, 1)])), axis=0)[0] / (2 * h)
        for step in steps
    ])  # fmt: skip
    turns = read.ball_turns
    spread = read.ball_spread(q[None], read.angles(q[None]), P[turns[:, :, None], turns[:, None, :]][None])[0]
    columns = read.ball_columns.ravel()
    np.testing.assert_allclose(spread[columns], np.sqrt(np.diag(J @ P @ J.T))[columns], rtol=1e-6)
    others = np.setdiff1d(np.arange(len(spread)), columns)
    assert np.isnan(spread[others]).all()


def test_moments_belong_to_the_bodys_own_axes(model):
    with pytest.raises(InvalidInput, match="own axes"):
        ClinicalAngles(model, READING).moments(model.neutral()[None], np.zeros((1, model.nv)))
