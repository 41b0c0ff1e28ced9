"""Pinocchio's geometry model has the viewer's surfaces, on the joints of their segments."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.io.subject import SubjectMarker
from mbkf.model.body_shapes import COLOURS, segment_shapes
from mbkf.model.geometry_model import geometry_model
from mbkf.model.human import HumanModel
from mbkf.model.shape_meshes import joined, shape_mesh

MARKER = SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.43]), 0.005, 0.0)


def test_every_segment_has_its_surface_and_every_marker_a_sphere():
    model = HumanModel.scaled({"right_thigh": 0.94}, 68.3)
    made = geometry_model(model, [MARKER])
    found = {one.name: one for one in made.geometryObjects}
    assert list(found) == [*model.joints, "marker_RKNE"]
    for name, shapes in segment_shapes(model).items():
        mesh = joined(shape_mesh(shape) for shape in shapes)
        one = found[name]
        assert one.parentJoint == model.joint(name).joint_id
        np.testing.assert_array_equal(one.geometry.vertices(), mesh.vertices_m)
        ends = [one.geometry.tri_indices(k) for k in (0, len(mesh.triangles) - 1)]
        corners = [[end[i] for i in range(3)] for end in ends]
        np.testing.assert_array_equal(corners, mesh.triangles[[0, -1]])
    np.testing.assert_allclose(found["left_hand"].meshColor, [*COLOURS["left"], 1.0])
    marker = found["marker_RKNE"]
    assert marker.parentJoint == model.joint("right_thigh").joint_id
    np.testing.assert_array_equal(marker.placement.translation, MARKER.position_m)


def test_a_marker_on_an_unknown_segment_is_refused():
    stray = SubjectMarker("T", "tail", np.zeros(3), 0.005, 0.0)
    with pytest.raises(UnknownName, match="tail"):
        geometry_model(HumanModel.scaled(), [stray])
