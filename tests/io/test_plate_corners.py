"""Corners of force plates: axes, normals, and corners that are those of no plate."""

import numpy as np
import pytest

from mbkf.io.plate_corners import has_area, plate_axes, plate_normal, plate_sides, upward_normal
from tests.io.c3d_builder import CORNERS_MM, PLATE_AXES

CORNERS_M = CORNERS_MM.T / 1e3


def test_axes_and_sides_of_a_plate():
    np.testing.assert_allclose(plate_axes(CORNERS_M), PLATE_AXES, atol=1e-15)
    x, y = plate_sides(CORNERS_M)
    np.testing.assert_allclose(x / 2, PLATE_AXES[:, 0] * 0.4, atol=1e-12)
    np.testing.assert_allclose(y / 2, PLATE_AXES[:, 1] * 0.6, atol=1e-12)


def test_the_normal_is_against_the_plates_own_z_and_upward_whatever_the_order():
    rng = np.random.default_rng(3)
    corners = CORNERS_M + rng.normal(0.0, 0.005, (4, 3))
    np.testing.assert_allclose(plate_normal(corners), -plate_axes(corners)[:, 2], atol=1e-12)
    np.testing.assert_allclose(plate_normal(corners[::-1]), -plate_normal(corners), atol=1e-12)
    np.testing.assert_allclose(upward_normal(corners[::-1]), upward_normal(corners), atol=1e-12)
    assert upward_normal(corners)[2] > 0.99


@pytest.mark.parametrize(
    "corners",
    [np.zeros((4, 3)), np.full((4, 3), np.nan), np.full((4, 3), np.inf), CORNERS_M * [1.0, 0.0, 0.0],
     CORNERS_M[[0, 0, 2, 3]], CORNERS_M[[0, 1, 2, 2]], CORNERS_M[[0, 2, 1, 3]], CORNERS_M[[0, 1, 3, 2]]],
)  # fmt: skip
def test_corners_of_no_plate(corners):
    assert not has_area(corners)


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 2, 1, 0], [2, 3, 0, 1]])
def test_corners_around_a_plate_in_either_sense(order):
    assert has_area(CORNERS_M[order] + np.random.default_rng(1).normal(0.0, 0.01, (4, 3)))


def test_corners_farther_than_a_laboratory_reaches():
    assert has_area(CORNERS_M, 1.0)
    assert not has_area(CORNERS_M + np.eye(3)[0], 1.0)
    assert has_area(CORNERS_M + np.eye(3)[0])
