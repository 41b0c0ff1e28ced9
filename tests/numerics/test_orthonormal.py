"""Axes from two directions are right-handed rotations with the stated axis and plane."""

from itertools import permutations

import numpy as np
import pytest

from mbkf.numerics.orthonormal import axes_from


@pytest.mark.parametrize(("first", "second"), list(permutations("xyz", 2)))
def test_axes_are_a_rotation_with_the_given_axis_and_plane(first, second):
    along, near = np.random.default_rng(4).normal(size=(2, 3))
    axes = axes_from(first, along, second, near)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    i, j = "xyz".index(first), "xyz".index(second)
    np.testing.assert_allclose(axes[:, i], along / np.linalg.norm(along), atol=1e-14)
    assert axes[:, j] @ near > 0.0
    assert axes[:, 3 - i - j] @ near == pytest.approx(0.0, abs=1e-14)


def test_given_axes_come_back():
    for first, second in permutations("xyz", 2):
        i, j = "xyz".index(first), "xyz".index(second)
        np.testing.assert_array_equal(axes_from(first, np.eye(3)[i], second, np.eye(3)[j]), np.eye(3))
