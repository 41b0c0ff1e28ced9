"""Meshes of shapes: closed, outwards, of the shapes' size, with unit normals."""

from collections import Counter

import numpy as np
import pytest

from mbkf.model.body_shapes import Shape, segment_shapes
from mbkf.model.shape_meshes import joined, shape_mesh
from tests.motions import random_model, reference_model

SHAPES = {
    "limb": Shape("limb", np.array([0.0, 0.0, 0.0, 0.05, 0.02, -0.4, 0.06, 0.04])),
    "ellipsoid": Shape("ellipsoid", np.array([0.01, 0.02, 0.1, 0.09, 0.07, 0.12])),
    "tube": Shape("tube", np.array([0, 0, 0.1, 0.15, 0.01, 0.2, 0.12, 0.17, 0.0, 0.4, 0.06, 0.08])),
    "outline": Shape("outline", np.array([-0.04, 0.05, -0.05, -0.08, 0.15, -0.08, 0.14, -0.04, 0.0, 0.02])),
}


def volume(mesh):
    p, q, r = mesh.vertices_m[mesh.triangles].transpose(1, 0, 2)
    return (p * np.cross(q, r)).sum() / 6.0


@pytest.mark.parametrize("kind", SHAPES)
def test_surfaces_are_closed_and_face_outwards(kind):
    mesh = shape_mesh(SHAPES[kind])
    places = np.round(mesh.vertices_m, 9)
    edges = Counter()
    for triangle in mesh.triangles:
        corners = [tuple(places[k]) for k in triangle]
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            edges[a, b] += 1
    assert all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items())
    assert len({corner for edge in edges for corner in edge}) - len(edges) // 2 + len(mesh.triangles) == 2
    assert volume(mesh) > 0.0


@pytest.mark.parametrize("kind", SHAPES)
def test_normals_are_units_on_the_side_their_triangles_face(kind):
    mesh = shape_mesh(SHAPES[kind])
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-12)
    p, q, r = mesh.vertices_m[mesh.triangles].transpose(1, 0, 2)
    facing = np.cross(q - p, r - p)
    for corner in range(3):
        assert ((facing * mesh.normals[mesh.triangles[:, corner]]).sum(axis=1) > 0.0).all()


def test_sizes_are_the_shapes():
    a, b, c = 0.09, 0.07, 0.12
    assert volume(shape_mesh(SHAPES["ellipsoid"])) == pytest.approx(4 / 3 * np.pi * a * b * c, rel=0.02)
    limb = shape_mesh(Shape("limb", np.array([0.0, 0, 0, 0, 0, -0.4, 0.05, 0.05]))).vertices_m
    np.testing.assert_allclose([limb[:, 2].min(), limb[:, 2].max()], [-0.45, 0.05], atol=1e-12)
    assert np.hypot(limb[:, 0], limb[:, 1]).max() == pytest.approx(0.055, rel=0.01)
    tube = shape_mesh(SHAPES["tube"]).vertices_m
    np.testing.assert_allclose([tube[:, 2].min(), tube[:, 2].max()], [0.0, 0.4], atol=1e-12)
    for z, x, depth, breadth in ((0.0, 0.0, 0.1, 0.15), (0.2, 0.01, 0.12, 0.17), (0.4, 0.0, 0.06, 0.08)):
        ring = tube[np.isclose(tube[:, 2], z)]
        np.testing.assert_allclose([ring[:, 0].min(), ring[:, 0].max()], [x - depth, x + depth], atol=1e-9)
        np.testing.assert_allclose(np.abs(ring[:, 1]).max(), breadth, rtol=1e-9)
    foot = shape_mesh(SHAPES["outline"]).vertices_m
    np.testing.assert_allclose([foot[:, 1].min(), foot[:, 1].max()], [-0.04, 0.05], atol=1e-12)
    assert foot[:, 2].min() == pytest.approx(-0.085)
    on_the_side = foot[np.isclose(foot[:, 1], 0.05)]
    assert on_the_side[:, 2].min() == pytest.approx(-0.08)


def test_every_segment_of_every_person_has_one():
    for model in (reference_model(), random_model(np.random.default_rng(2))):
        for name, shapes in segment_shapes(model).items():
            mesh = joined(shape_mesh(shape) for shape in shapes)
            assert mesh.triangles.max() == len(mesh.vertices_m) - 1, name
            assert volume(mesh) == pytest.approx(sum(volume(shape_mesh(shape)) for shape in shapes)), name
            for shape in shapes:
                part = shape_mesh(shape)
                p, q, r = part.vertices_m[part.triangles].transpose(1, 0, 2)
                flat = np.linalg.norm(np.cross(q - p, r - p), axis=1)
                assert volume(part) > 1e-5 and flat.min() > 0.0, name


def test_the_caps_of_feet_do_not_fold_over():
    """All triangles of a side face that side, so the fan about its middle covers it once."""
    for name, shapes in segment_shapes(reference_model()).items():
        for shape in shapes:
            if shape.kind == "outline":
                mesh = shape_mesh(shape)
                for end, out in ((shape.numbers[0], -1.0), (shape.numbers[1], 1.0)):
                    on = np.isclose(mesh.vertices_m[mesh.triangles][:, :, 1], end, atol=1e-12).all(axis=1)
                    assert on.sum() == len(shape.numbers[2:]) // 2, name
                    np.testing.assert_allclose(mesh.normals[mesh.triangles[on, 0], 1], out, atol=1e-12)
