"""Readings of a joint's rotation: constant axes on both segments, and segments of which only a line is read."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.model.angle_reading import AngleReading, JointAxes, Line


def rotations(count, seed, most=0.8):
    rng = np.random.default_rng(seed)
    return Rotation.from_rotvec(rng.uniform(-most, most, (count, 3))).as_matrix()


A_P, A_D, G_P, G_D = rotations(4, 0)
TURNED = JointAxes(A_P, A_D)
LINED = JointAxes(A_P, A_D, "yzx", Line(G_P, G_D))


def test_a_reading_of_the_model_has_no_axes():
    assert AngleReading().name == "model" and not AngleReading().joints


def test_constant_axes_turn_both_sides():
    R = rotations(5, 1)
    np.testing.assert_allclose(TURNED.rotations(R), [A_P.T @ one @ A_D for one in R], atol=1e-15)


def test_axes_compose():
    """Axes read of a motion in other axes are the axes in those axes."""
    R, B_P, B_D = rotations(5, 2), *rotations(2, 3)
    once = JointAxes(A_P @ B_P, A_D @ B_D).rotations(R)
    np.testing.assert_allclose(JointAxes(B_P, B_D).rotations(TURNED.rotations(R)), once, atol=1e-14)


def test_what_is_read_of_a_line_does_not_turn_with_it():
    R = rotations(6, 4)
    about_line = Rotation.from_rotvec(np.outer(np.linspace(-1, 1, 6), [1, 0, 0])).as_matrix()
    turned = R @ G_D @ about_line @ G_D.T
    np.testing.assert_allclose(LINED.rotations(turned), LINED.rotations(R), atol=1e-13)


def test_a_line_points_where_it_points():
    """A_p A Aᵀ_d-side brings back the line; the third axis stays at a right angle to the proximal y."""
    R = rotations(6, 5)
    stands = A_P @ LINED.rotations(R) @ A_D.T @ G_D
    np.testing.assert_allclose(stands[..., 0], (R @ G_D)[..., 0], atol=1e-13)
    np.testing.assert_allclose(stands[..., 2] @ G_P[:, 1], 0.0, atol=1e-13)


@pytest.mark.parametrize("axes", [TURNED, LINED])
def test_velocities_by_finite_differences(axes):
    rng, h = np.random.default_rng(6), 1e-6
    R, omega = rotations(5, 7), rng.normal(size=(5, 3))
    before, after = (
        axes.rotations(R @ Rotation.from_rotvec(sign * h * omega).as_matrix()) for sign in (-1.0, 1.0)
    )
    turned = np.einsum("tji,tjk->tik", before, after)
    slopes = Rotation.from_matrix(turned).as_rotvec() / (2 * h)
    W = axes.velocities(R)
    np.testing.assert_allclose(np.einsum("tij,tj->ti", W, omega), slopes, atol=1e-8)
