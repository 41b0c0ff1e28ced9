"""A reconstruction as a GLB file: the body as the viewer draws it, moving as it moved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.io.atomic import replacing
from mbkf.io.glb import GlbMaterial, GlbMesh, GlbMotion, GlbNode, glb_bytes
from mbkf.io.results import Reconstruction
from mbkf.model.body_shapes import COLOURS, segment_shapes, side_of
from mbkf.model.shape_meshes import joined, shape_mesh
from mbkf.trial.exchange.animation import TO_ANIMATION, AnimatedBody, animated_body, held_rows

MATERIALS = tuple(GlbMaterial(side or "middle", colour, 0.75) for side, colour in COLOURS.items())
"""A surface for each side."""


def write_result_glb(r: Reconstruction, path: str | Path) -> None:
    """Writes a result as a GLB file: m, y up, z forward, a key for every frame.

    Times count from the result's first frame. Frames in which the body is not followed hold the last pose (those before
    the first one that pose).

    Args:
        r: The result.
        path: The file, replaced whole or not at all.

    Raises:
        InvalidInput: The body is followed in no frame.
        UnknownName: The subject's body is unknown.
        OSError: The file cannot be written.
    """
    body = animated_body(r, held_rows(np.arange(r.frames), r.tracked))
    motion = GlbMotion(r.trial, r.times_s - r.times_s[0], body.root_m, continuous_quaternions(body.rotations))
    content = glb_bytes(glb_nodes(body), MATERIALS, motion, f"mbkf {r.version}")
    with replacing(path) as partial:
        partial.write_bytes(content)


def glb_nodes(body: AnimatedBody) -> tuple[GlbNode, ...]:
    """The segments with their surfaces, in animation's axes."""
    shapes = segment_shapes(body.model)
    nodes = []
    for k, name in enumerate(body.names):
        mesh = joined(shape_mesh(shape) for shape in shapes[name])
        material = list(COLOURS).index(side_of(name))
        surface = GlbMesh(
            mesh.vertices_m @ TO_ANIMATION.T, mesh.normals @ TO_ANIMATION.T, mesh.triangles, material
        )
        nodes.append(GlbNode(name, body.parents[k], body.offsets_m[k], surface))
    return tuple(nodes)


def continuous_quaternions(rotations: Array) -> Array:
    """(F, S, 4) unit quaternions (x, y, z, w) of rotations (F, S, 3, 3), successive ones in one hemisphere."""
    count, segments = rotations.shape[:2]
    found = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().reshape(count, segments, 4)
    turned = (found[1:] * found[:-1]).sum(axis=2) < 0.0
    found[1:][np.cumsum(turned, axis=0) % 2 == 1] *= -1.0
    return np.asarray(found)
