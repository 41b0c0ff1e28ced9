"""A segment's surface as a VTP file: the mesh stands in it as the format states it."""

from xml.etree import ElementTree as ET

import numpy as np

from mbkf.model.shape_meshes import Mesh
from mbkf.model.vtp import vtp_text

TETRAHEDRON = Mesh(
    np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.25, 0], [0, 0, 1.5]]),
    np.array([[-1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + 0.0,
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)


def test_points_and_polygons_stand_in_the_file():
    root = ET.fromstring(vtp_text(TETRAHEDRON))
    assert (root.tag, root.get("type")) == ("VTKFile", "PolyData")
    (piece,) = root.iter("Piece")
    assert (piece.get("NumberOfPoints"), piece.get("NumberOfPolys")) == ("4", "4")
    arrays = {one.get("Name"): np.array(one.text.split(), float) for one in piece.iter("DataArray")}
    np.testing.assert_allclose(arrays["Points"].reshape(-1, 3), TETRAHEDRON.vertices_m, atol=1e-7)
    np.testing.assert_allclose(arrays["Normals"].reshape(-1, 3), TETRAHEDRON.normals, atol=1e-7)
    corners = np.split(arrays["connectivity"].astype(int), arrays["offsets"].astype(int)[:-1])
    np.testing.assert_array_equal(corners, TETRAHEDRON.triangles)
