"""GLB as bytes: sizes of indices, colours, parts without a surface, and what is refused."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput, ShapeError
from mbkf.io.glb import GlbMaterial, GlbMesh, GlbMotion, GlbNode, glb_bytes
from tests.trial.exchange.glb_reading import Glb

GREY = GlbMaterial("grey", (0.5, 0.02, 1.0), 0.5)
UP = np.array([0.0, 1.0, 0.0])


def surface(vertices):
    rng = np.random.default_rng(0)
    triangles = np.arange(3 * (vertices // 3)).reshape(-1, 3)
    return GlbMesh(rng.normal(size=(vertices, 3)), np.tile(UP, (vertices, 1)), triangles, 0)


def still(frames, nodes, times=None):
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (frames, nodes, 1))
    times = np.arange(frames) / 10.0 if times is None else np.asarray(times)
    return GlbMotion("mötion", times, np.zeros((frames, 3)), turns)


@pytest.mark.parametrize(("vertices", "kind"), [(9, 5123), (65535, 5123), (65538, 5125)])
def test_indices_are_as_wide_as_needed(vertices, kind):
    glb = Glb(glb_bytes((GlbNode("a", -1, UP, surface(vertices)),), (GREY,), still(2, 1), "test"))
    primitive = glb.json["meshes"][0]["primitives"][0]
    assert glb.json["accessors"][primitive["indices"]]["componentType"] == kind
    assert glb.arrays[primitive["indices"]].max() == vertices - 1 < 2 ** (16 if kind == 5123 else 32) - 1


def test_parts_need_no_surface_and_names_any_letters():
    nodes = (GlbNode("ä", -1, UP), GlbNode("b", 0, UP, surface(3)), GlbNode("c", 1, UP))
    glb = Glb(glb_bytes(nodes, (GREY,), still(1, 3), "test"))
    assert glb.parents() == [-1, 0, 1]
    assert [node.get("mesh") for node in glb.json["nodes"]] == [None, 0, None]
    assert glb.json["nodes"][0]["name"] == "ä" and glb.json["animations"][0]["name"] == "mötion"
    bare = Glb(glb_bytes(nodes[:1], (GREY,), still(1, 1), "test"))
    assert "meshes" not in bare.json


def test_colours_are_linear():
    glb = Glb(glb_bytes((GlbNode("a", -1, UP),), (GREY,), still(1, 1), "test"))
    (material,) = glb.json["materials"]
    np.testing.assert_allclose(
        material["pbrMetallicRoughness"]["baseColorFactor"], [0.21404, 0.02 / 12.92, 1.0, 1.0], atol=1e-5
    )


def test_what_is_no_moving_tree_is_refused():
    two = (GlbNode("a", -1, UP), GlbNode("b", 0, UP))
    with pytest.raises(ShapeError, match="quaternions"):
        glb_bytes(two, (GREY,), still(3, 1), "test")
    with pytest.raises(ShapeError, match="root_m"):
        motion = still(3, 2)
        glb_bytes(two, (GREY,), GlbMotion("x", motion.times_s, np.zeros((2, 3)), motion.quaternions), "test")
    for nodes in (
        (two[0], GlbNode("b", -1, UP)),
        (GlbNode("a", 0, UP), two[1]),
        (two[0], GlbNode("b", 1, UP)),
    ):
        with pytest.raises(InvalidInput, match="one tree"):
            glb_bytes(nodes, (GREY,), still(3, 2), "test")
    for times in ([0.0, 0.1, 0.1], [-0.1, 0.0, 0.1], [1e6, 1e6 + 1e-3, 1e6 + 2.0]):
        with pytest.raises(InvalidInput, match="increase"):
            glb_bytes(two, (GREY,), still(3, 2, times), "test")
    with pytest.raises(InvalidInput, match="increase"):
        glb_bytes(two, (GREY,), still(0, 2), "test")
