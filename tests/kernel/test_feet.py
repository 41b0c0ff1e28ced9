"""The kernel's feet and their rows are those of the readable code, to rounding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.feet import CompiledFeet, foot_rows, walked
from mbkf.kernel.loading import library
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.soles import sole_locals
from tests.motions import moderate_pose, random_model, worst

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

often = settings(max_examples=30, deadline=None)
seeds = given(st.integers(0, 10**6))


def about(c):
    """(6, 6) that takes a wrench about the world's origin to one about c."""
    X = np.eye(6)
    X[3:, :3] = -np.array([[0.0, -c[2], c[1]], [c[2], 0.0, -c[0]], [-c[1], c[0], 0.0]])
    return X


@often
@seeds
def test_soles_move_as_their_feet_do(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    segments, local = sole_locals(model)
    joints = [model.joint(segment).joint_id for segment in model.roles.feet]
    q, v = moderate_pose(model, rng), rng.normal(size=model.nv)
    found = CompiledFeet(library(), model.tree, (*joints, model.root.joint_id), local).at(q, v)
    rotations, origins = model.placements(q)
    on = [model.joint(segment).joint_id for segment in segments]
    points = np.einsum("kij,kj->ki", rotations[on], local) + origins[on]
    velocities = [
        model.segment_jacobian(q, segment, place)[:3] @ v
        for segment, place in zip(segments, points, strict=True)
    ]
    assert worst(np.reshape(found.points, (6, 3)) - points) <= 1e-13
    assert worst(np.reshape(found.velocities, (6, 3)) - velocities) <= 1e-12
    assert worst(found.middles_m - 0.5 * (points[[0, 3]] + points[[2, 5]])) <= 1e-13
    assert worst(found.up - rotations[joints][:, 2, 2]) <= 1e-14
    assert worst(found.root - origins[model.root.joint_id]) <= 1e-14


@often
@given(st.integers(0, 10**6), st.sampled_from([0, 1]))
def test_rows_read_wrenches_about_their_centres(seed, first):
    rng = np.random.default_rng(seed)
    centres, weights = rng.normal(size=(2, 3)), rng.uniform(0.1, 10.0, (2, 6))
    expected, w = 300.0 * rng.normal(size=(2, 6)), 300.0 * rng.normal(size=12)
    rows, values = foot_rows(centres, weights, expected, w, first)
    X = np.zeros((2, 6, 12))
    for foot in (0, 1):
        X[foot, :, 6 * foot : 6 * foot + 6] = weights[foot][:, None] * about(centres[foot])
    whole = X[[first, 1 - first]].reshape(12, 12)
    assert worst(rows - whole) <= 1e-13 * worst(whole)
    assert worst(values - whole @ (expected.ravel() - w)) <= 1e-12 * worst(whole) * worst(w)


@often
@given(st.integers(0, 10**6), st.sampled_from("CF"))
def test_wrenches_wander_about_their_centres(seed, order):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(20, 20))
    P, centres, sd = np.array(root @ root.T, order=order), rng.normal(size=(2, 3)), rng.uniform(1.0, 9.0, 6)
    expected = P.copy()
    for foot in (0, 1):
        own = slice(5 + 6 * foot, 11 + 6 * foot)
        back = np.linalg.inv(about(centres[foot]))
        expected[own, own] += back @ np.diag(sd**2) @ back.T
    assert walked(centres, sd, 5, P)
    assert worst(P - expected) <= 1e-12 * worst(expected)


def test_a_foot_whose_points_are_elsewhere_is_left_to_the_reference():
    model = random_model(np.random.default_rng(1))
    assert FeetOnBody(model)._compiled is not None
    with pytest.raises(ValueError, match="not the tree's"):
        CompiledFeet(library(), model.tree, (1, 2, 99), np.zeros((6, 3))).at(
            model.neutral(), np.zeros(model.nv)
        )


def test_arrays_that_do_not_fit_are_refused():
    centres, six, w = np.zeros((2, 3)), np.ones(6), np.zeros(12)
    with pytest.raises(ValueError, match="in the covariance"):
        walked(centres, six, 5, np.eye(16))
    with pytest.raises(ValueError, match="0 or 1"):
        foot_rows(centres, np.ones((2, 6)), np.zeros((2, 6)), w, 2)
    with pytest.raises(ValueError, match="type or size"):
        foot_rows(centres, np.ones((2, 6)), np.zeros((2, 6)), w[:6], 0)


@pytest.mark.usefixtures("reference_kernel")
def test_the_reference_has_no_compiled_feet():
    model = random_model(np.random.default_rng(2))
    assert FeetOnBody(model)._compiled is None
    assert foot_rows(np.zeros((2, 3)), np.ones((2, 6)), np.zeros((2, 6)), np.zeros(12), 0) is None
    assert not walked(np.zeros((2, 3)), np.ones(6), 0, np.eye(12))
