"""Boxes, cylinders and spheres fill the surfaces that they stand for."""

import numpy as np
import pytest

from mbkf.model.body_shapes import Shape, segment_shapes
from mbkf.model.human import HumanModel
from mbkf.model.primitive_shapes import LEAST_M, primitives
from mbkf.model.shape_meshes import shape_mesh

SHAPES = [(name, shape) for name, shapes in segment_shapes(HumanModel.scaled()).items() for shape in shapes]


def corners(solid):
    """Points on a solid's surface, in the segment's frame."""
    rng = np.random.default_rng(0)
    if solid.kind == "box":
        points = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * solid.size_m
    elif solid.kind == "sphere":
        points = rng.normal(size=(400, 3))
        points *= solid.size_m[0] / np.linalg.norm(points, axis=1, keepdims=True)
    else:
        radius, length = solid.size_m
        turn, ends = np.linspace(0, 2 * np.pi, 40), np.repeat([-0.5, 0.5], 20) * length
        points = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), ends])
    return points @ solid.placement[:3, :3].T + solid.placement[:3, 3]


@pytest.mark.parametrize(("name", "shape"), SHAPES, ids=[name for name, _ in SHAPES])
def test_a_shape_and_its_solids_reach_equally_far(name, shape):
    surface = shape_mesh(shape).vertices_m
    solids = np.concatenate([corners(one) for one in primitives(shape)])
    np.testing.assert_allclose(solids.min(axis=0), surface.min(axis=0), atol=0.025)
    np.testing.assert_allclose(solids.max(axis=0), surface.max(axis=0), atol=0.025)


def test_a_limb_is_a_cylinder_from_joint_to_joint_between_two_spheres():
    start, end = np.array([0.01, 0.0, 0.02]), np.array([0.05, -0.1, -0.4])
    first, second, between = primitives(Shape("limb", np.concatenate([start, end, [0.05, 0.03]])))
    assert (first.kind, first.size_m) == ("sphere", (0.05,))
    assert (second.kind, second.size_m) == ("sphere", (0.03,))
    assert (between.kind, between.size_m) == ("cylinder", (0.04, pytest.approx(np.linalg.norm(end - start))))
    np.testing.assert_allclose(between.placement[:3, 3], 0.5 * (start + end))
    np.testing.assert_allclose(between.placement[:3, 2], (end - start) / np.linalg.norm(end - start))
    assert np.linalg.det(between.placement[:3, :3]) == pytest.approx(1.0)


def test_an_ellipsoid_keeps_its_length_and_the_area_across():
    n = np.array([0.01, 0.0, -0.085, 0.036, 0.019, 0.09])
    first, second, between = primitives(Shape("ellipsoid", n))
    radius = np.sqrt(0.036 * 0.019)
    assert between.size_m[0] == first.size_m[0] == second.size_m[0] == pytest.approx(radius)
    assert between.size_m[1] + 2 * radius == pytest.approx(0.18)


def test_a_round_ellipsoid_is_a_sphere():
    solids = primitives(Shape("ellipsoid", np.array([0.0, 0.0, 0.1, 0.05, 0.05, 0.05])))
    assert {one.kind for one in solids} == {"sphere"}


def test_a_stretch_of_a_tube_has_the_area_of_its_ellipse():
    (box,) = primitives(Shape("tube", np.array([0.0, 0.1, 0.08, 0.12, 0.02, 0.3, 0.10, 0.16])))
    assert box.size_m[0] * box.size_m[1] == pytest.approx(np.pi * 0.09 * 0.14)
    assert box.size_m[2] == pytest.approx(0.2)
    np.testing.assert_allclose(box.placement[:3, 3], [0.01, 0.0, 0.2])


def test_a_foot_is_three_boxes_that_slope_with_its_side_view():
    side = [[-0.1, -0.08], [0.2, -0.08], [0.2, -0.05], [-0.1, 0.01]]
    boxes = primitives(Shape("outline", np.concatenate([[-0.05, 0.04], np.ravel(side)])))
    tops = [one.placement[2, 3] + 0.5 * one.size_m[2] for one in boxes]
    np.testing.assert_allclose(tops, [0.0, -0.02, -0.04], atol=1e-12)
    assert [one.size_m[:2] for one in boxes] == [pytest.approx((0.1, 0.09))] * 3


def test_flat_solids_are_left_out():
    flat = Shape("tube", np.array([0.0, 0.1, 0.08, 0.12, 0.0, 0.1 + 0.5 * LEAST_M, 0.1, 0.16]))
    assert primitives(flat) == ()
