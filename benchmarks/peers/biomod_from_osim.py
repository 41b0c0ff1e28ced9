"""OpenSim's model as biorbd's: joints read off the poses that OpenSim's own coordinates give."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.peers.biomod import WORLD, BiomodBody, Fixed, Hinges, Inertia
from benchmarks.peers.required import opensim
from mbkf.conventions import Array

BENT_RAD = 1.2
"""A knee whose axis moves as it bends becomes the hinge that fits best up to here."""

SMALL_BENDS_RAD = np.linspace(-0.4, 0.4, 5)


def body_of(model: Path) -> BiomodBody:
    """A model for biorbd; patellas stay where they are, and so do coordinates that are locked."""
    read = opensim().Model(str(model))
    state = read.initSystem()
    joints = _parents_first([_hinges(read, state, joint) for joint in read.getJointSet()])
    return BiomodBody(joints, {body.getName(): _inertia(body) for body in read.getBodySet()}, _markers(read))


def _hinges(model: Any, state: Any, joint: Any) -> Hinges:
    parent, child = joint.getParentFrame().findBaseFrame(), joint.getChildFrame().findBaseFrame()
    own = [joint.get_coordinates(k) for k in range(joint.numCoordinates())]
    moving = [c for c in own if not c.get_locked() and not c.isDependent(state)]
    turning = [c for c in moving if c.getMotionType() == 1]
    free = tuple(c.getName() for c in moving if c.getMotionType() == 2)

    def pose(coordinate: Any = None, value: float = 0.0) -> tuple[Array, Array]:
        for one in moving:
            one.setValue(state, 0.0, False)
        if coordinate is not None:
            coordinate.setValue(state, float(value), False)
        model.realizePosition(state)
        found = child.findTransformBetween(state, parent)
        return _matrix(found.R()), _vector(found.p())

    rotation, place = pose()
    bends = [_bends(c) if len(turning) == 1 else SMALL_BENDS_RAD for c in turning]
    poses = [[pose(c, bend) for bend in some] for c, some in zip(turning, bends, strict=True)]
    pose()
    axes = [_axis(rotation, own, [R for R, _ in some]) for own, some in zip(bends, poses, strict=True)]
    at_parent, at_child = place, np.zeros(3)
    if turning and not free:
        at_parent, at_child = _fixed_point([one for some in poses for one in some])
    return Hinges(
        child.getName(),
        WORLD if parent.getName() == "ground" else parent.getName(),
        tuple(c.getName() for c in turning),
        np.array(axes).reshape(-1, 3),
        at_parent,
        at_child,
        rotation,
        free,
    )


def _bends(coordinate: Any) -> Array:
    least, most = (
        np.clip(one, -BENT_RAD, BENT_RAD) for one in (coordinate.getRangeMin(), coordinate.getRangeMax())
    )
    return np.linspace(least, most, 7)


def _axis(zero: Array, bends: Array, rotations: list[Array]) -> Array:
    """Unit axis in the parent's frame about which a coordinate turns."""
    turns = [Rotation.from_matrix(R @ zero.T).as_rotvec() for R in rotations]
    axis = np.sum([bend * turn for bend, turn in zip(bends, turns, strict=True)], axis=0)
    return np.asarray(axis / np.linalg.norm(axis))


def _fixed_point(poses: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """The point that stays where it is in both frames: R c + t = d, in the least-squares sense; (d, c).

    Along a single axis any point does: the nearest to both origins is taken.
    """
    rows = np.vstack([np.hstack([R, -np.eye(3)]) for R, _ in poses])
    found = np.linalg.lstsq(rows, np.concatenate([-t for _, t in poses]), rcond=1e-6)[0]
    return found[3:], found[:3]


def _parents_first(joints: list[Hinges]) -> tuple[Hinges, ...]:
    known, left, order = {WORLD}, list(joints), []
    while left:
        ready = next(joint for joint in left if joint.parent in known)
        left.remove(ready)
        order.append(ready)
        known.add(ready.child)
    return tuple(order)


def _inertia(body: Any) -> Inertia:
    found = body.getInertia()
    xx, yy, zz = (found.getMoments().get(k) for k in range(3))
    xy, xz, yz = (found.getProducts().get(k) for k in range(3))
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertia(body.getMass(), _vector(body.getMassCenter()), about)


def _markers(model: Any) -> tuple[Fixed, ...]:
    markers = model.getMarkerSet()
    return tuple(
        Fixed(one.getName(), one.getParentFrame().findBaseFrame().getName(), _vector(one.get_location()))
        for one in (markers.get(k) for k in range(markers.getSize()))
    )


def _vector(found: Any) -> Array:
    return np.array([found.get(k) for k in range(3)])


def _matrix(found: Any) -> Array:
    return np.array([[found.get(i, j) for j in range(3)] for i in range(3)])
