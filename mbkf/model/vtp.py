"""A segment's surface as a VTP file (VTK's polygons in XML), which OpenSim and ParaView draw."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np

from mbkf.io.written import MARK
from mbkf.model.shape_meshes import Mesh

CORNERS = 3


def vtp_text(mesh: Mesh) -> str:
    """The text of a VTP file, in the mesh's axes and m.

    Args:
        mesh: The surface.
    """
    root = ET.Element("VTKFile", type="PolyData", version="0.1", byte_order="LittleEndian")
    sizes = {"NumberOfVerts": 0, "NumberOfLines": 0, "NumberOfStrips": 0}
    sizes |= {"NumberOfPoints": len(mesh.vertices_m), "NumberOfPolys": len(mesh.triangles)}
    piece = ET.SubElement(
        ET.SubElement(root, "PolyData"), "Piece", {name: str(one) for name, one in sizes.items()}
    )
    _array(ET.SubElement(piece, "PointData", Normals="Normals"), "Normals", mesh.normals)
    _array(ET.SubElement(piece, "Points"), "Points", mesh.vertices_m)
    polygons = ET.SubElement(piece, "Polys")
    _array(polygons, "connectivity", mesh.triangles)
    _array(polygons, "offsets", CORNERS * np.arange(1, len(mesh.triangles) + 1))
    return f'<?xml version="1.0"?>\n<!-- {MARK} -->\n' + ET.tostring(root, encoding="unicode") + "\n"


def _array(parent: ET.Element, name: str, values: np.ndarray) -> None:
    """A DataArray of vectors (n, 3), or of whole numbers."""
    whole = np.issubdtype(values.dtype, np.integer)
    entries = {"type": "Int32" if whole else "Float32", "Name": name, "format": "ascii"}
    if not whole:
        entries["NumberOfComponents"] = str(CORNERS)
    rows = np.atleast_2d(values).tolist()
    element = ET.SubElement(parent, "DataArray", entries)
    element.text = "\n".join(" ".join(f"{one}" if whole else f"{one:.6g}" for one in row) for row in rows)
