"""Forward dynamics and wrenches by the kernel are Pinocchio's, near the world's origin and far from it."""

from itertools import product

import numpy as np
import pytest

from mbkf.kernel.loading import library
from mbkf.model.compiled_forces import Given
from mbkf.model.human_dynamics import FORCE_STATES, GIVEN_FRAME, WRENCH_FRAMES, HumanDynamics
from mbkf.sensors.foot_wrench import FootWrenchSensor
from tests.motions import moderate_pose, random_model, worst

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")
each_kind = pytest.mark.parametrize(
    ("force_state", "frame"), list(product(FORCE_STATES, (*WRENCH_FRAMES, GIVEN_FRAME)))
)
FIXED = (9, 10, 20)


def pair(force_state, frame, far_m=0.0, seed=3):
    """The same body by the kernel and by Pinocchio, and a state q, v, u."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    fixed = np.isin(np.arange(model.nv), FIXED)
    given = frame == GIVEN_FRAME
    compiled, reference = (
        HumanDynamics(model, fixed, "ankle" if given else frame, force_state, given) for _ in range(2)
    )
    reference.compiled = None
    q, v = moderate_pose(model, rng), 2.0 * rng.normal(size=model.nv)
    q[:2] += far_m
    a = np.where(reference.kinematic, 0.0, 10.0 * rng.normal(size=model.nv))
    wrench = rng.normal(size=(2, 6)) * np.array([80.0, 40.0, 500.0, 60.0, 60.0, 20.0])
    u = reference.forces(q, v, a, wrench)
    return compiled, reference, q, v, a, np.concatenate([u, wrench.ravel()]) if given else u


def assert_same(found, expected, tolerance=1e-11):
    assert np.shape(found) == np.shape(expected)
    assert worst(found - expected) <= tolerance * max(1e-3, worst(expected))


@each_kind
@pytest.mark.parametrize("far_m", [0.0, 20.0])
def test_forward_dynamics_and_their_derivatives(force_state, frame, far_m):
    compiled, reference, q, v, a, u = pair(force_state, frame, far_m)
    tolerance = 1e-9 if far_m else 1e-10
    assert_same(compiled.acceleration(q, v, u), a, tolerance)
    found, expected = (body.linearise(q, v, u) for body in (compiled, reference))
    for name in ("a", "by_q", "by_v", "by_u"):
        assert_same(getattr(found, name), getattr(expected, name), tolerance)
    for body in (compiled, reference):
        assert_same(body.force_response(q), expected.by_u, tolerance)
    assert not found.by_u[list(FIXED)].any()


@each_kind
def test_forces_of_a_state(force_state, frame):
    compiled, reference, q, v, a, u = pair(force_state, frame)
    assert_same(compiled.generalised(q, v, a, u), reference.generalised(q, v, a, u))
    assert_same(compiled.force_rows(q), reference.force_rows(q))
    for every, six in (
        (compiled.joint_forces, compiled.residual),
        (reference.joint_forces, reference.residual),
    ):
        expected = reference.joint_forces(q, v, u)
        for name in ("torque", "by_q", "by_v", "by_u"):
            assert_same(getattr(every(q, v, u), name), getattr(expected, name))
            assert_same(getattr(six(q, v, u), name), getattr(expected, name)[:6])


@each_kind
def test_wrenches_about_any_points(force_state, frame):
    compiled, reference, q, _, _, u = pair(force_state, frame)
    points = np.array([[0.3, -0.2, 0.1], [-1.0, 2.0, 0.5]])
    found, expected = (FootWrenchSensor(one).reading(q, u[-12:], points) for one in (compiled, reference))
    assert_same(found.wrench, expected.wrench)
    assert_same(found.by_state, expected.by_state)
    assert worst(found.by_q - expected.by_q) <= 1e-11 * worst(expected.wrench)


def test_the_latest_mass_matrix_is_kept():
    compiled, _, q, *_ = pair("inertial", "ankle")
    first = compiled.compiled.mass(q)
    assert compiled.compiled.mass(q.copy()) is first
    np.testing.assert_allclose(first[0], compiled.model.mass_matrix(q), atol=1e-12)
    q[-1] += 0.1  # a hinge, in the same array
    moved = compiled.compiled.mass(q)[0]
    np.testing.assert_allclose(moved, compiled.model.mass_matrix(q), atol=1e-12)
    assert worst(moved - first[0]) > 1e-6


def test_nothing_given():
    none = Given.nothing(4)
    assert [part.shape for part in (none.force, none.by_q, none.by_v, none.by_state)] == [
        (4,), (4, 4), (4, 4), (4, 12)
    ]  # fmt: skip
