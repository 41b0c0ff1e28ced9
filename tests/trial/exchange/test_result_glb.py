"""A result as GLB, read by a reader that knows the specification only: surfaces and poses are the body's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.model.body_shapes import segment_shapes
from mbkf.model.segment_poses import segment_poses
from mbkf.model.shape_meshes import joined, shape_mesh
from mbkf.trial.exchange.result_glb import write_result_glb
from tests.motions import assert_near
from tests.recordings import LOST, broken_walk, walker
from tests.trial.exchange.glb_reading import Glb, rotation

LEFT_UP_FORWARD = [1, 2, 0]
"""World axes that are x, y and z of the file."""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("glb") / "walk.glb"
    r = broken_walk()
    write_result_glb(replace(r, times_s=r.times_s + 3.0), path)
    return path


@pytest.fixture(scope="module")
def glb(path):
    return Glb(path.read_bytes())


def test_every_key_has_the_segments_where_the_body_has_them(glb):
    r, model = broken_walk(), walker()[1]
    times, keys = glb.animation()
    np.testing.assert_allclose(times, r.times_s - r.times_s[0], atol=1e-6)
    poses = segment_poses(model, r.q)
    for t in np.flatnonzero(r.tracked):
        found = glb.places(keys, t)
        assert list(found) == list(model.joints)
        for pose, (R, p) in zip(poses[t], found.values(), strict=True):
            assert_near(p, pose[:3][LEFT_UP_FORWARD], 1e-5)
            assert_near(R, rotation(pose[3:])[np.ix_(LEFT_UP_FORWARD, LEFT_UP_FORWARD)], 1e-5)


def test_frames_without_the_body_hold_the_last_pose(glb):
    for values in glb.animation()[1].values():
        np.testing.assert_array_equal(values[LOST], values[[LOST.start - 1] * (LOST.stop - LOST.start)])


def test_quaternions_are_units_and_turn_the_short_way(glb):
    for (_, kind), values in glb.animation()[1].items():
        if kind == "rotation":
            np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-6)
            assert ((values[1:] * values[:-1]).sum(axis=1) > 0.0).all()


def test_only_the_root_travels_and_every_segment_turns(glb):
    keys, parents = glb.animation()[1], glb.parents()
    assert [k for k, kind in keys if kind == "translation"] == [parents.index(-1)]
    assert sorted(k for k, kind in keys if kind == "rotation") == list(range(len(parents)))


def test_the_tree_is_the_body_s(glb):
    model, nodes = walker()[1], glb.json["nodes"]
    names = [node["name"] for node in nodes]
    for node, parent in zip(nodes, glb.parents(), strict=True):
        own = model.description.segment(node["name"])
        assert own.parent == ("world" if parent == -1 else names[parent])


def test_surfaces_are_those_that_the_viewer_draws(glb):
    shapes = segment_shapes(walker()[1])
    for node in glb.json["nodes"]:
        (primitive,) = glb.json["meshes"][node["mesh"]]["primitives"]
        assert primitive.get("mode", 4) == 4
        attributes, indices = primitive["attributes"], primitive["indices"]
        places, normals = (glb.arrays[attributes[name]] for name in ("POSITION", "NORMAL"))
        assert {"min", "max"} <= set(glb.json["accessors"][attributes["POSITION"]])
        own = joined(shape_mesh(shape) for shape in shapes[node["name"]])
        np.testing.assert_allclose(places, own.vertices_m[:, LEFT_UP_FORWARD], atol=1e-6)
        np.testing.assert_allclose(normals, own.normals[:, LEFT_UP_FORWARD], atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)
        triangles = glb.arrays[indices][:, 0]
        np.testing.assert_array_equal(triangles, own.triangles.ravel())
        views = [glb.json["accessors"][k]["bufferView"] for k in (*attributes.values(), indices)]
        assert [glb.json["bufferViews"][k]["target"] for k in views] == [34962, 34962, 34963]


def test_sides_have_colours_of_their_own(glb):
    by_side = {}
    for node in glb.json["nodes"]:
        (primitive,) = glb.json["meshes"][node["mesh"]]["primitives"]
        side = node["name"].split("_")[0] if "_" in node["name"] else "middle"
        by_side.setdefault(side, set()).add(glb.json["materials"][primitive["material"]]["name"])
    assert by_side == {"middle": {"middle"}, "right": {"right"}, "left": {"left"}}
    colours = {m["name"]: m["pbrMetallicRoughness"]["baseColorFactor"] for m in glb.json["materials"]}
    assert colours["right"][2] > colours["right"][0] and colours["left"][0] > colours["left"][2]
    assert all(0.0 <= part <= 1.0 for colour in colours.values() for part in colour)


def test_at_rest_the_body_stands_upright_at_its_first_place(glb):
    found, model = glb.places({}), walker()[1]
    origins = model.placements(model.neutral())[1]
    root = found["pelvis"][1] - origins[model.root.joint_id][LEFT_UP_FORWARD]
    for name, joint in model.joints.items():
        assert_near(found[name][1] - root, origins[joint.joint_id][LEFT_UP_FORWARD], 1e-9)
    first = broken_walk().q[0, :3][LEFT_UP_FORWARD]
    assert_near(found["pelvis"][1], first, 1e-9)


def test_another_reader_agrees_on_the_scene(path):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load_scene(path)
    assert len(scene.geometry) == 18
    for name, mesh in scene.geometry.items():
        own = joined(shape_mesh(shape) for shape in segment_shapes(walker()[1])[name])
        assert len(mesh.faces) == len(own.triangles)


def test_a_result_that_follows_nothing_is_refused(tmp_path):
    r = broken_walk()
    with pytest.raises(InvalidInput, match="no frame"):
        write_result_glb(replace(r, tracked=np.zeros(r.frames, bool)), tmp_path / "x.glb")
    assert list(tmp_path.iterdir()) == []
