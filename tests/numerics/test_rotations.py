"""Rotation vectors of quaternions against SciPy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mbkf.numerics.rotations import (
    exponential_and_left_jacobian,
    nearest_rotations,
    quaternion_of,
    skew,
    travel_by_turn,
)

VECTORS = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)
ANGLES = st.floats(0, np.pi - 1e-6)
MANY_ANGLES = [0.0, 1e-12, 1e-9, 1e-6, 0.9e-4, 1.1e-4, 0.01, 1.0, 2.5, 3.1, 3.14]


def rotation_vector(direction, angle):
    return angle * direction / np.linalg.norm(direction)


@given(VECTORS, VECTORS)
def test_skew_is_the_cross_product(a, b):
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), rtol=0, atol=1e-15)


def test_skew_of_many():
    vectors = np.random.default_rng(1).normal(size=(4, 2, 3))
    np.testing.assert_array_equal(skew(vectors)[2, 1], skew(vectors[2, 1]))
    np.testing.assert_array_equal(skew(vectors), -skew(vectors).swapaxes(-1, -2))


@given(VECTORS, st.floats(0, np.pi))
def test_the_quaternion_of_a_matrix_turns_as_the_matrix_does(direction, angle):
    matrix = Rotation.from_rotvec(rotation_vector(direction, angle)).as_matrix()
    quaternion = quaternion_of(matrix)
    np.testing.assert_allclose(Rotation.from_quat(quaternion).as_matrix(), matrix, rtol=0, atol=1e-14)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0, rel=1e-15)
    assert quaternion[np.abs(quaternion).argmax()] > 0.0


def test_many_matrices_have_the_quaternions_of_each():
    matrices = Rotation.random(24, rng=np.random.default_rng(1)).as_matrix().reshape(6, 4, 3, 3)
    each = [[quaternion_of(one) for one in row] for row in matrices]
    np.testing.assert_allclose(quaternion_of(matrices), each, rtol=0, atol=1e-15)
    assert quaternion_of(matrices[:0]).shape == (0, 4, 4)


@pytest.mark.parametrize("axis", range(3))
def test_half_a_turn_about_an_axis_has_no_scalar_part(axis):
    matrix = 2.0 * np.diag(np.eye(3)[axis]) - np.eye(3)
    np.testing.assert_array_equal(quaternion_of(matrix), np.eye(4)[axis])


def test_nearest_rotations_are_rotations():
    matrices = np.random.default_rng(0).normal(size=(20, 3, 3))
    found = nearest_rotations(matrices)
    assert np.allclose(found @ found.transpose(0, 2, 1), np.eye(3))
    assert np.allclose(np.linalg.det(found), 1.0)
    assert np.allclose(nearest_rotations(found), found)


def travelled(u, w):
    """(3,) how far exp(u, w) goes, in extended precision by the exponential's own series."""
    u, w = np.asarray(u, dtype=np.longdouble), np.asarray(w, dtype=np.longdouble)
    total, term = np.zeros(3, dtype=np.longdouble), u
    for k in range(1, 40):
        total = total + term
        term = np.cross(w, term) / (k + 1)
    return total


@pytest.mark.parametrize("angle", [0.0, 1e-6, 1e-3, 0.1, 0.149, 0.151, 0.5, 1.5, 3.0])
def test_travel_changes_with_the_turn_as_its_differences_do(angle):
    """In the axes that the screw motion ends in, by right turns: exp(w + J⁻¹ δ) ≈ exp(w) exp(δ)."""
    rng = np.random.default_rng(9)
    u, w = rng.normal(size=3), rotation_vector(rng.normal(size=3), angle)
    step, back = np.longdouble(1e-6), Rotation.from_rotvec(-w).as_matrix()
    by_vector = np.array(
        [(travelled(u, w + step * e) - travelled(u, w - step * e)) / (2 * step) for e in np.eye(3)],
        dtype=float,
    ).T
    np.testing.assert_allclose(travel_by_turn(u, w), back @ by_vector, rtol=0, atol=2e-12)


@pytest.mark.parametrize("size", [0.0, 1e-4, 0.149, 0.151, 2.0, 3.1])
def test_the_left_jacobian_turns_a_change_of_a_rotation_vector_into_a_turn(size):
    vectors = size * np.array([[1.0, 0.0, 0.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]])
    exponential, left = exponential_and_left_jacobian(vectors)
    np.testing.assert_allclose(exponential, Rotation.from_rotvec(vectors).as_matrix(), atol=1e-14)
    for change in 1e-6 * np.eye(3):
        ahead, back = (Rotation.from_rotvec(vectors + sign * change) for sign in (1.0, -1.0))
        np.testing.assert_allclose(left @ change, 0.5 * (ahead * back.inv()).as_rotvec(), atol=1e-15)
