"""A reader of GLB made from the specification of glTF 2.0 alone; what it does not allow fails."""

import json
import struct

import numpy as np

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
KNOWN = {"asset", "scene", "scenes", "nodes", "meshes", "materials", "animations", "accessors", "bufferViews",
         "buffers"}  # fmt: skip


def chunks(content):
    """The JSON and the numbers; header, lengths, padding and order as section 4.4 wants them."""
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    found, at = [], 12
    while at < length:
        size, kind = struct.unpack_from("<I4s", content, at)
        assert size % 4 == 0
        found.append((kind, content[at + 8 : at + 8 + size]))
        at += 8 + size
    assert at == length and [kind for kind, _ in found] == [b"JSON", b"BIN\0"]
    return json.loads(found[0][1].decode("utf-8")), found[1][1]


class Glb:
    """A file: its JSON, and the array of every accessor."""

    def __init__(self, content):
        self.json, numbers = chunks(content)
        assert set(self.json) <= KNOWN and self.json["asset"]["version"] == "2.0"
        (buffer,) = self.json["buffers"]
        assert "uri" not in buffer and 0 <= len(numbers) - buffer["byteLength"] <= 3
        self.arrays = [self.array(accessor, numbers) for accessor in self.json["accessors"]]

    def array(self, accessor, numbers):
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        start, count = view.get("byteOffset", 0) + accessor.get("byteOffset", 0), accessor["count"]
        assert count >= 1 and start % kind.itemsize == 0 and start % 4 == 0
        assert view["buffer"] == 0 and "byteStride" not in view
        assert accessor.get("byteOffset", 0) + count * width * kind.itemsize <= view["byteLength"]
        assert view["byteOffset"] + view["byteLength"] <= self.json["buffers"][0]["byteLength"]
        values = np.frombuffer(numbers, kind, count * width, start).reshape(count, width)
        assert kind.kind != "f" or np.isfinite(values).all()
        for name, bound in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if name in accessor:
                np.testing.assert_array_equal(np.asarray(accessor[name], kind), bound)
        return values

    def animation(self):
        """The keys' times, and by node and path the values at them."""
        (animation,) = self.json["animations"]
        times, found = None, {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR"
            given = self.json["accessors"][sampler["input"]]
            assert {"min", "max"} <= set(given) and given["componentType"] == 5126
            times, values = self.arrays[sampler["input"]][:, 0], self.arrays[sampler["output"]]
            assert len(times) == len(values) and times[0] >= 0.0 and (np.diff(times) > 0.0).all()
            key = (channel["target"]["node"], channel["target"]["path"])
            assert key not in found and values.shape[1] == {"translation": 3, "rotation": 4}[key[1]]
            found[key] = values.astype(float)
        return times, found

    def parents(self):
        """The parent of every node; each has one at most, and the roots are the scene's."""
        nodes = self.json["nodes"]
        found = [-1] * len(nodes)
        for k, node in enumerate(nodes):
            for child in node.get("children", ()):
                assert found[child] == -1
                found[child] = k
        roots = [k for k, parent in enumerate(found) if parent == -1]
        assert self.json["scenes"][self.json["scene"]]["nodes"] == roots
        return found

    def places(self, keys, frame=None):
        """World rotation and place of every node by name, at a key or at rest."""
        found = {}

        def of(k, R0, p0):
            node = self.json["nodes"][k]
            assert "matrix" not in node and "scale" not in node
            move = np.array(node.get("translation", (0.0, 0.0, 0.0)))
            turn = np.array(node.get("rotation", (0.0, 0.0, 0.0, 1.0)))
            if frame is not None:
                move = keys.get((k, "translation"), [move] * (frame + 1))[frame]
                turn = keys.get((k, "rotation"), [turn] * (frame + 1))[frame]
            R, p = R0 @ rotation(turn), p0 + R0 @ move
            found[node["name"]] = (R, p)
            for child in node.get("children", ()):
                of(child, R, p)

        for root in self.json["scenes"][0]["nodes"]:
            of(root, np.eye(3), np.zeros(3))
        return found


def rotation(quaternion):
    """v + 2 w u×v + 2 u×(u×v), for the three axes."""
    u, w = quaternion[:3], quaternion[3]
    return np.array([v + 2 * w * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v)) for v in np.eye(3)]).T
