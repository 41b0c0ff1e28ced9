"""The text of a model for biorbd describes the body it was written from."""

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.peers.biomod import WORLD, BiomodBody, Fixed, Hinges, Inertia, biomod

RNG = np.random.default_rng(0)


def rotation():
    return Rotation.random(random_state=RNG).as_matrix()


def unit(rows):
    axes = RNG.normal(size=(rows, 3))
    return axes / np.linalg.norm(axes, axis=1, keepdims=True)


def body():
    """A free root, a limb with three skew axes, and a hinge behind it."""
    root = Hinges(
        "pelvis", WORLD, ("a", "b", "c"), unit(3), np.zeros(3), np.zeros(3), rotation(), ("x", "y", "z")
    )
    limb = Hinges(
        "femur", "pelvis", ("d", "e", "f"), unit(3), RNG.normal(size=3), RNG.normal(size=3), rotation()
    )
    shank = Hinges("tibia", "femur", ("g",), unit(1), RNG.normal(size=3), RNG.normal(size=3), rotation())
    inertia = Inertia(2.0, np.array([0.1, 0.2, 0.3]), np.diag([1.0, 2.0, 3.0]))
    markers = tuple(
        Fixed(f"m{k}", name, RNG.normal(size=3)) for k, name in enumerate(("pelvis", "femur", "tibia"))
    )
    return BiomodBody((root, limb, shank), dict.fromkeys(("pelvis", "femur", "tibia"), inertia), markers)


def placed(own, values):
    """Markers by the joints' definition: turned about the axes in the parent's frame, through the joint's point."""
    frames = {WORLD: (np.eye(3), np.zeros(3))}
    for joint in own.joints:
        R, p = frames[joint.parent]
        at = (
            joint.point_parent_m + [values[name] for name in joint.free or ()]
            if joint.free
            else joint.point_parent_m
        )
        turn = np.eye(3)
        for name, axis in zip(joint.coordinates, joint.axes, strict=True):
            turn = turn @ Rotation.from_rotvec(values[name] * axis).as_matrix()
        turn = turn @ joint.rotation
        frames[joint.child] = R @ turn, p + R @ (at - turn @ joint.point_child_m)
    return [frames[m.body][0] @ m.place_m + frames[m.body][1] for m in own.markers]


def read_back(text, values):
    """Markers by the file alone, as biorbd reads it: each segment's fixed transform, then its dof about or along x."""
    frames, markers, lines = {"base": np.eye(4)}, [], iter(text.splitlines())
    for line in lines:
        if line.startswith("segment "):
            name, parent = line.split()[1], next(lines).split()[1]
            next(lines), next(lines)
            pose = frames[parent] @ np.array([[float(x) for x in next(lines).split()] for _ in range(4)])
            kind, own = next(lines).split()[:2] if name in values or name.endswith("_moved") else ("", "")
            step = np.eye(4)
            if kind == "translations":
                step[:3, 3] = [values[axis] for axis in own]
            elif kind == "rotations":
                step[:3, :3] = Rotation.from_rotvec([values[name], 0.0, 0.0]).as_matrix()
            frames[name] = pose @ step
        elif line.startswith("marker "):
            parent = next(lines).split()[1]
            place = np.array([float(x) for x in next(lines).split()[1:]])
            markers.append(frames[parent][:3, :3] @ place + frames[parent][:3, 3])
    return markers


def test_the_file_places_markers_where_the_joints_do():
    own = body()
    assert own.coordinates == ("x", "y", "z", "a", "b", "c", "d", "e", "f", "g")
    values = dict(zip(own.coordinates, RNG.normal(size=10), strict=True))
    np.testing.assert_allclose(read_back(biomod(own), values), placed(own, values), atol=1e-9)


def test_only_bodies_have_mass():
    masses = [line for line in biomod(body()).splitlines() if line.strip().startswith("mass")]
    assert [float(line.split()[1]) for line in masses] == [2.0, 2.0, 2.0]
