"""The kernel's kinematics and dynamics are Pinocchio's, to rounding."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.loading import library
from mbkf.kernel.tree import FREE, HINGE, CompiledTree
from mbkf.model.human import HumanModel
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.posture_sensor import PostureSensor
from tests.motions import random_model, reference_model, worst

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

ROUNDING = 1e-12
seeds = given(st.integers(0, 10**6))
often = settings(max_examples=30, deadline=None)


def branched(rng):
    """A Pinocchio model of every kind of joint, turned against one another, with whole inertias."""
    model = pin.Model()
    kinds = [pin.JointModelFreeFlyer(), pin.JointModelSpherical(), pin.JointModelRX(), pin.JointModelRY()]
    kinds += [pin.JointModelRZ(), pin.JointModelRevoluteUnaligned(*_unit(rng))]
    for i, kind in enumerate([*kinds, *kinds[1:]]):
        # The last of a chain bears the next, or one before it; each subtree stands in one piece.
        parent = i if i < 4 else (2 if i == 4 else i)
        joint = model.addJoint(parent, kind, pin.SE3.Random(), f"joint {i}")
        if i != 2:
            model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    model.gravity.linear = rng.normal(size=3)
    return model


def _unit(rng):
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def moving(seed, body=None):
    """A body, its compiled equations, and a state anywhere on its manifold."""
    rng = np.random.default_rng(seed)
    if body is None:
        body = [reference_model().pin_model, random_model(rng).pin_model, branched(rng)][seed % 3]
    q = pin.integrate(body, pin.neutral(body), 2.0 * rng.normal(size=body.nv))
    v, a, w = 3.0 * rng.normal(size=body.nv), 20.0 * rng.normal(size=body.nv), 300.0 * rng.normal(size=12)
    return SimpleNamespace(
        model=body, data=body.createData(), tree=CompiledTree.where_built(body), rng=rng, q=q, v=v, a=a, w=w
    )


def assert_same(found, expected, tolerance=ROUNDING):
    assert found.shape == expected.shape
    assert worst(found - expected) <= tolerance * worst(expected)


def crossed(w):
    """(6, 6) of the force product: m x* w = crossed(w) m."""
    n, f = pin.skew(w[3:]), pin.skew(w[:3])
    return -np.block([[np.zeros((3, 3)), f], [f, n]])


@often
@seeds
def test_frames_and_jacobian_are_pinocchio_s(seed):
    s = moving(seed)
    frames, jacobian = s.tree.frames_and_jacobian(s.q)
    expected = pin.computeJointJacobians(s.model, s.data, s.q)
    places = [np.vstack([place.rotation.T, place.translation]) for place in s.data.oMi]
    assert_same(jacobian, expected)
    assert_same(frames, np.vstack(places))


@often
@seeds
def test_the_root_s_equations_are_pinocchio_s(seed):
    s = moving(seed)
    wrench, nv = s.w[:6], s.model.nv
    residual, by_state = s.tree.root(s.q, s.v, s.a, wrench)
    by_q, by_v, by_a = (x[:6].copy() for x in pin.computeRNEADerivatives(s.model, s.data, s.q, s.v, s.a))
    axes = s.data.J[:, :6]
    by_q[:, :6] -= (axes.T @ crossed(wrench) @ axes).T
    assert_same(residual, s.data.tau[:6] - axes.T @ wrench)
    assert_same(by_state[:, :nv], by_q)
    assert_same(by_state[:, nv : 2 * nv], by_v)
    assert_same(by_state[:, 2 * nv : 3 * nv], by_a)
    assert_same(by_state[:, 3 * nv :], np.tile(-axes.T, 2))


@often
@seeds
def test_the_root_s_readings_are_its_equations_whitened_with_further_loads(seed):
    s = moving(seed)
    extra, by_extra, sharp = s.rng.normal(size=5), s.rng.normal(size=(6, 5)), s.rng.uniform(0.1, 9.0, 6)
    rows, innovation = s.tree.law(s.q, s.v, s.a, s.w, extra, by_extra, sharp)
    residual, by_state = s.tree.root(s.q, s.v, s.a, s.w[:6] + s.w[6:])
    assert_same(rows, np.hstack([by_state * sharp[:, None], by_extra]))
    assert_same(innovation, -sharp * residual - by_extra @ extra)


@often
@seeds
def test_the_centre_of_mass_is_pinocchio_s(seed):
    s = moving(seed)
    assert_same(s.tree.centre_of_mass(s.q), pin.centerOfMass(s.model, s.data, s.q))


@often
@seeds
def test_torques_and_their_derivatives_are_pinocchio_s(seed):
    """Each foot hangs on any joint; its wrench stands still in the world."""
    s = moving(seed)
    nv, feet = s.model.nv, s.rng.integers(1, s.model.njoints, size=2)
    joint_of = np.repeat(np.arange(1, s.model.njoints), [joint.nv for joint in s.model.joints[1:]])
    below = np.array([np.isin(joint_of, list(joint)) for joint in s.model.supports])  # dofs that move a joint
    moves = below[feet]
    tau, by_state, jacobian = s.tree.torques(s.q, s.v, s.a, moves, s.w)
    by_q, by_v, by_a = pin.computeRNEADerivatives(s.model, s.data, s.q, s.v, s.a)
    expected, by_q = s.data.tau.copy(), by_q.copy()
    assert_same(jacobian, s.data.J)
    for foot, own in zip((slice(6), slice(6, 12)), moves, strict=True):
        J = s.data.J * own
        turns = (J.T @ crossed(s.w[foot]) @ J).T
        by_q -= turns * below[joint_of]
        expected -= J.T @ s.w[foot]
        assert_same(by_state[:, 3 * nv :][:, foot], -J.T)
    assert_same(tau, expected)
    assert_same(s.tree.tau(s.q, s.v, s.a, moves, s.w), expected)
    assert_same(by_state[:, :nv], by_q)
    assert_same(by_state[:, nv : 2 * nv], by_v)
    assert_same(by_state[:, 2 * nv : 3 * nv], by_a)


@often
@seeds
def test_heights_change_as_their_joints_velocities_say(seed):
    s = moving(seed)
    joints = np.arange(1, s.model.njoints, dtype=np.int32)
    pin.computeJointJacobians(s.model, s.data, s.q)
    expected = [
        pin.getJointJacobian(s.model, s.data, int(joint), pin.LOCAL_WORLD_ALIGNED)[2] for joint in joints
    ]
    assert_same(s.tree.height_jacobian(s.q, joints), np.array(expected))


@pytest.mark.parametrize("frames", [0, 1, 3])
def test_frames_of_a_motion_are_those_of_each_frame_by_itself(frames):
    s = moving(2)
    nv = s.model.nv
    steps = s.rng.normal(size=(frames, nv))
    q = np.array([pin.integrate(s.model, s.q, step) for step in steps]).reshape(frames, s.model.nq)
    v, a, w = (s.rng.normal(size=(frames, size)) for size in (nv, nv, 12))
    moves = s.rng.random((2, nv)) < 0.5
    placed, jacobians = s.tree.frames_and_jacobians(q)
    tau = s.tree.motion_tau(q, v, a, moves, w)
    assert len(placed) == len(jacobians) == len(tau) == frames
    for t in range(frames):
        frame, jacobian = s.tree.frames_and_jacobian(q[t])
        assert np.array_equal(placed[t], frame) and np.array_equal(jacobians[t], jacobian)
        assert np.array_equal(tau[t], s.tree.tau(q[t], v[t], a[t], moves, w[t]))


def test_rows_of_tables_and_whole_numbers_are_read():
    s = moving(0)
    every_other = np.repeat(s.q, 2).reshape(-1, 2)[:, 0]
    np.testing.assert_array_equal(
        s.tree.frames_and_jacobian(every_other)[0], s.tree.frames_and_jacobian(s.q)[0]
    )
    still = np.zeros(s.model.nv)
    found = s.tree.root(s.q, np.zeros(s.model.nv, dtype=int), still, np.zeros(6))
    np.testing.assert_array_equal(found[1], s.tree.root(s.q, still, still, np.zeros(6))[1])


def test_models_of_other_joints_or_without_a_free_root_are_left_to_the_reference():
    slide, hinge = pin.Model(), pin.Model()
    root = slide.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    slide.addJoint(root, pin.JointModelPX(), pin.SE3.Identity(), "slide")
    hinge.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    assert CompiledTree.where_built(slide) is None
    assert CompiledTree.where_built(hinge) is None
    assert CompiledTree.where_built(pin.Model()) is None


def test_a_body_uses_the_kernel_only_where_it_is_wanted(either_kernel):
    assert (HumanModel.scaled().tree is None) == (either_kernel == "reference")
    assert (reference_model().tree is None) == (either_kernel == "reference")


@pytest.mark.usefixtures("reference_kernel")
def test_the_reference_has_no_tree():
    assert CompiledTree.where_built(reference_model().pin_model) is None


@pytest.mark.parametrize(
    "change", [{"parent": [0, 2, 1]}, {"kind": [0, 1, 2]}, {"first_q": [0, 2, 7]}, {"first_v": [0, 2, 6]}]
)
def test_joints_that_make_no_tree_are_refused(change):
    joints = {"parent": [0, 0, 1], "kind": [0, FREE, HINGE], "first_q": [0, 0, 7], "first_v": [0, 0, 6]}
    made = tree_of(**joints)
    assert made is not None
    with pytest.raises(ValueError, match="make_tree: the joints do not make a tree"):
        tree_of(**joints | change)


def tree_of(**joints):
    """A tree of two joints without mass."""
    indices = (np.array(joints[name], dtype=np.int32) for name in ("parent", "kind", "first_q", "first_v"))
    vectors, matrices = np.zeros((3, 3)), np.zeros((3, 3, 3))
    numbers = (vectors, matrices, vectors, np.zeros(3), vectors, matrices, np.zeros(6))
    return library().make_tree(8, 7, *indices, *numbers)


@often
@seeds
def test_steps_and_their_derivatives_are_pinocchio_s(seed):
    """Short steps and steps beyond half a turn."""
    s = moving(seed)
    for size in (0.0, 1e-4, 0.04, 0.2, 1.0, 3.0):
        step = size * s.rng.normal(size=s.model.nv)
        assert_same(s.tree.integrate(s.q, step), pin.integrate(s.model, s.q, step))
        by_q, by_step = s.tree.integration_derivatives(step)
        expected_by_q, expected_by_step = pin.dIntegrate(s.model, s.q, step)
        assert_same(by_q, expected_by_q)
        assert_same(by_step[6:], expected_by_step[6:])
        # Pinocchio's is off by 1e-9 here for small turns; the series is not.
        assert_same(by_step[:6], np.hstack([right_jacobian(step[:6]), np.zeros((6, s.model.nv - 6))]))


def right_jacobian(step):
    """(6, 6) of exp6: Σ (−ad)ᵏ / (k + 1)!, by scaling and squaring of a larger exponential."""
    v, w = pin.skew(step[:3]), pin.skew(step[3:])
    ad = np.block([[w, v], [np.zeros((3, 3)), w]])
    return scipy.linalg.expm(np.block([[-ad, np.eye(6)], [np.zeros((6, 12))]]))[:6, 6:]


@often
@seeds
def test_deviations_are_pinocchio_s_differences_from_neutral(seed):
    """With the inverse of the turn's right Jacobian; Pinocchio's own is off by 1e-9 for small turns."""
    s = moving(seed)
    neutral = pin.neutral(s.model)
    for size in (0.0, 1e-9, 3e-4, 0.02, 0.4):
        q = pin.integrate(s.model, neutral, size * s.rng.normal(size=s.model.nv))
        q[:7] = neutral[:7]
        deviation, jacobian = s.tree.deviation(q)
        np.testing.assert_allclose(deviation, pin.difference(s.model, neutral, q), rtol=0, atol=1e-14)
        expected = np.eye(s.model.nv)
        expected[:6, :6] = 0.0
        for joint in s.model.joints[2:]:
            if joint.nv == 3:
                dofs = slice(joint.idx_v, joint.idx_v + 3)
                turn = np.r_[np.zeros(3), deviation[dofs]]
                expected[dofs, dofs] = np.linalg.inv(right_jacobian(turn)[3:, 3:])
        assert_same(jacobian, expected)
    deviation, jacobian = s.tree.deviation(s.q)
    assert not deviation[:6].any()
    assert not jacobian[:6].any()


@often
@seeds
def test_information_of_turns_is_that_of_their_stacked_readings(seed):
    s = moving(seed)
    deviation, jacobian = s.tree.deviation(s.q)
    weights = s.rng.uniform(0.0, 30.0, s.model.nv) * (s.rng.random(s.model.nv) < 0.7)
    matrix, vector = s.tree.posture_information(deviation, jacobian, weights)
    rows = weights[:, None] * jacobian
    np.testing.assert_array_equal(matrix, matrix.T)
    assert_same(matrix, rows.T @ rows)
    assert_same(vector, -(deviation * weights) @ rows)


@often
@seeds
def test_limits_are_passed_as_the_reference_says(seed):
    """Narrow limits and wide ones; some spherical joints lie within theirs only the other way round."""
    rng = np.random.default_rng(seed)
    sensor, nothing = PostureSensor(reference_model()), np.zeros(reference_model().nv, dtype=bool)
    limits = JointLimits(sensor, nothing)
    limits.lower, limits.upper = limits.lower * rng.uniform(0.2, 2.0), limits.upper * rng.uniform(0.2, 2.0)
    q = reference_model().integrate(
        reference_model().neutral(), rng.uniform(0.1, 2.0) * rng.normal(size=len(nothing))
    )
    deviation, jacobian = sensor.deviation(q)
    found, sensor.tree = limits.information(deviation, jacobian), None
    expected = limits.information(deviation, jacobian)
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert_same(found.matrix, expected.matrix)
        assert_same(found.vector, expected.vector)


@often
@seeds
def test_deviations_from_another_configuration_are_pinocchio_s_differences(seed):
    """With the root set aside."""
    s = moving(seed)
    start = pin.integrate(s.model, s.q, 0.3 * s.rng.normal(size=s.model.nv))
    deviation, jacobian = s.tree.deviation(s.q, start)
    expected, slope = pin.difference(s.model, start, s.q), pin.dDifference(s.model, start, s.q, pin.ARG1)
    np.testing.assert_allclose(deviation[6:], expected[6:], rtol=0, atol=1e-13)
    np.testing.assert_allclose(jacobian[6:, 6:], slope[6:, 6:], rtol=0, atol=1e-8)
    assert not deviation[:6].any() and not jacobian[:6].any()


@often
@seeds
def test_the_mass_matrix_and_its_inverse(seed):
    """Pinocchio's; the inverse is that of the moving dofs' part alone."""
    s = moving(seed)
    moves = s.rng.random(s.model.nv) < 0.8
    mass, inverse = s.tree.mass_inverse(s.q, moves)
    expected = np.triu(pin.crba(s.model, s.data, s.q))
    expected += np.triu(expected, 1).T
    assert_same(mass, expected)
    part = np.linalg.inv(expected[np.ix_(moves, moves)])
    size = np.sqrt(np.diag(part))
    assert worst((inverse[np.ix_(moves, moves)] - part) / np.outer(size, size)) < 1e-8
    assert not inverse[~moves].any() and not inverse[:, ~moves].any()


def test_a_body_without_mass_has_no_inverse():
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    with pytest.raises(np.linalg.LinAlgError, match="mass matrix"):
        CompiledTree.where_built(model).mass_inverse(pin.neutral(model), np.ones(6, dtype=bool))
