"""Writing a moving tree of rigid parts as GLB, the binary form of glTF 2.0 (Khronos Group; ISO/IEC 12113:2022).

Lengths are in m, y is up. A file is a header, a chunk of JSON and a chunk of numbers, which JSON's accessors describe;
sections named here are those of the specification.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, ShapeError

MAGIC, JSON_CHUNK, NUMBERS_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
"""Section 4.4: "glTF", "JSON" and "BIN"."""

FLOAT, UINT16, UINT32 = 5126, 5123, 5125
VERTICES, INDICES = 34962, 34963
"""Section 5.11: purpose of a buffer view."""

_TYPES = {"<f4": FLOAT, "<u2": UINT16, "<u4": UINT32}
_SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


@dataclass(frozen=True)
class GlbMesh:
    """The surface of a part.

    Attributes:
        vertices_m: (V, 3) places in the part's frame.
        normals: (V, 3) unit vectors outwards.
        triangles: (N, 3) vertices of each, counter-clockwise seen from outside.
        material: Place of its material in the list.
    """

    vertices_m: Array
    normals: Array
    triangles: NDArray[np.int64]
    material: int


@dataclass(frozen=True)
class GlbNode:
    """A part of the tree: its name, the place of its parent (−1 for none), its place there (3,) m, its surface."""

    name: str
    parent: int
    offset_m: Array
    mesh: GlbMesh | None = None


@dataclass(frozen=True)
class GlbMaterial:
    """A colour: sRGB, each of three numbers 0 to 1; and how rough the surface is, 0 to 1."""

    name: str
    srgb: tuple[float, float, float]
    roughness: float


@dataclass(frozen=True)
class GlbMotion:
    """Motion of the parts.

    Attributes:
        name: Of the animation.
        times_s: (F,) times from 0 on.
        root_m: (F, 3) places of the first part.
        quaternions: (F, N, 4) turn of every part in its parent, (x, y, z, w).
    """

    name: str
    times_s: Array
    root_m: Array
    quaternions: Array


def glb_bytes(
    nodes: Sequence[GlbNode], materials: Sequence[GlbMaterial], motion: GlbMotion, generator: str
) -> bytes:
    """The bytes of a file.

    Args:
        nodes: N parts, the root first, each after its parent.
        materials: Materials of their surfaces.
        motion: Their motion.
        generator: Name of the program that writes the file.

    Raises:
        ShapeError: The motion does not belong to these parts.
        InvalidInput: A part stands before its parent, or times do not increase as 32-bit numbers.
    """
    if motion.quaternions.shape != (len(motion.times_s), len(nodes), 4):
        raise ShapeError("quaternions", f"({len(motion.times_s)}, {len(nodes)}, 4)", motion.quaternions.shape)
    if motion.root_m.shape != (len(motion.times_s), 3):
        raise ShapeError("root_m", f"({len(motion.times_s)}, 3)", motion.root_m.shape)
    if any((node.parent == -1) != (k == 0) or node.parent >= k for k, node in enumerate(nodes)):
        raise InvalidInput("the parts of a glTF file form one tree, each after its parent")
    numbers = _Numbers()
    meshes = [_mesh(node.name, node.mesh, numbers) for node in nodes if node.mesh is not None]
    animation = _animation(motion, numbers)
    scene: dict[str, object] = {
        "asset": {"version": "2.0", "generator": generator},
        "scene": 0,
        "scenes": [{"name": motion.name, "nodes": [0]}],
        "nodes": _nodes(nodes, motion),
        "materials": [_material(material) for material in materials],
        "animations": [animation],
        "accessors": numbers.accessors,
        "bufferViews": numbers.views,
        "buffers": [{"byteLength": len(numbers.content)}],
    }
    if meshes:
        scene["meshes"] = meshes
    return _file(json.dumps(scene, separators=(",", ":"), allow_nan=False), bytes(numbers.content))


class _Numbers:
    """The chunk of numbers as it grows, with a buffer view and an accessor for each array."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, object]] = []
        self.accessors: list[dict[str, object]] = []

    def put(self, values: NDArray, kind: str, target: int | None = None, bounds: bool = False) -> int:
        """Number of the accessor of an array (n,) or (n, width) that is added.

        Args:
            values: The array.
            kind: Type in the file: "<f4", "<u2" or "<u4".
            target: Purpose of its view; None for an animation.
            bounds: Add least and greatest values.
        """
        stored = np.ascontiguousarray(values, dtype=kind)
        data = stored.tobytes()
        view: dict[str, object] = {"buffer": 0, "byteOffset": len(self.content), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self.views.append(view)
        self.content += data + bytes(-len(data) % 4)
        table = stored.reshape(len(stored), -1)
        accessor: dict[str, object] = {
            "bufferView": len(self.views) - 1,
            "componentType": _TYPES[kind],
            "count": len(stored),
            "type": _SHAPES[table.shape[1]],
        }
        if bounds:
            accessor |= {"min": table.min(axis=0).tolist(), "max": table.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _mesh(name: str, mesh: GlbMesh, numbers: _Numbers) -> dict[str, object]:
    # The greatest index of a type is kept for restarts (section 3.7.2.1).
    kind = "<u2" if len(mesh.vertices_m) < 65536 else "<u4"
    primitive = {
        "attributes": {
            "POSITION": numbers.put(mesh.vertices_m, "<f4", VERTICES, bounds=True),
            "NORMAL": numbers.put(mesh.normals, "<f4", VERTICES),
        },
        "indices": numbers.put(mesh.triangles.ravel(), kind, INDICES),
        "material": mesh.material,
    }
    return {"name": name, "primitives": [primitive]}


def _nodes(nodes: Sequence[GlbNode], motion: GlbMotion) -> list[dict[str, object]]:
    """The tree at rest: the root in its first place, nothing turned."""
    found: list[dict[str, object]] = []
    meshes = 0
    for k, node in enumerate(nodes):
        place = node.offset_m if k else motion.root_m[0]
        entry: dict[str, object] = {"name": node.name, "translation": place.tolist()}
        children = [j for j, other in enumerate(nodes) if other.parent == k]
        if children:
            entry["children"] = children
        if node.mesh is not None:
            entry["mesh"] = meshes
            meshes += 1
        found.append(entry)
    return found


def _animation(motion: GlbMotion, numbers: _Numbers) -> dict[str, object]:
    times = motion.times_s.astype(np.float32)
    if not len(times) or times[0] < 0.0 or (np.diff(times) <= 0.0).any():
        raise InvalidInput("the times of an animation begin at 0 or later and increase as 32-bit numbers")
    at = numbers.put(times, "<f4", bounds=True)
    tracks = [(0, "translation", numbers.put(motion.root_m, "<f4"))]
    tracks += [
        (k, "rotation", numbers.put(motion.quaternions[:, k], "<f4"))
        for k in range(motion.quaternions.shape[1])
    ]
    samplers = [{"input": at, "output": values, "interpolation": "LINEAR"} for _, _, values in tracks]
    channels = [{"sampler": n, "target": {"node": k, "path": path}} for n, (k, path, _) in enumerate(tracks)]
    return {"name": motion.name, "samplers": samplers, "channels": channels}


def _material(material: GlbMaterial) -> dict[str, object]:
    """Colours are linear in a file (section 3.9.2); IEC 61966-2-1 says how sRGB is not."""
    srgb = np.array(material.srgb)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    surface = {
        "baseColorFactor": [*linear.tolist(), 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": material.roughness,
    }
    return {"name": material.name, "pbrMetallicRoughness": surface}


def _file(text: str, content: bytes) -> bytes:
    """Section 4.4: JSON filled up with blanks, numbers with zeros, to whole words of four bytes."""
    chunk = text.encode("utf-8")
    chunk += b" " * (-len(chunk) % 4)
    content += bytes(-len(content) % 4)
    chunks = struct.pack("<II", len(chunk), JSON_CHUNK) + chunk
    chunks += struct.pack("<II", len(content), NUMBERS_CHUNK) + content
    return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks
