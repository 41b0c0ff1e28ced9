"""An OpenSim model as the tree of links and hinges that a URDF file states, for bodies of our own.

A link's frame is that of the joint on the child's side, so that every hinge lies at its link's origin; the root's is at
its body's origin. The ground's axes are turned so that z points up. Turns of a joint become hinges at one point with
links without mass between them; turns and shifts that are constant, and locked coordinates, are part of the frames. A
hinge counts from where its turn is zero, which may be another value of OpenSim's coordinate (:func:`osim_zeros_deg`).
A joint whose turns or shifts follow a coordinate otherwise than by itself is refused by its name. Markers are links
without mass that are fixed to their bodies, so that they become landmarks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array, TomlTable
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.osim import OsimBody, OsimModel
from mbkf.io.osim_joints import OsimAxis, OsimCoordinate, OsimJoint
from mbkf.model.osim_kinematics import GROUND, OsimKinematics
from mbkf.model.urdf_tree import UrdfJoint, UrdfTree

_LETTERS = "xyz"


def osim_tree(model: OsimModel) -> UrdfTree:
    """The tree of an OpenSim model.

    Args:
        model: The model.

    Raises:
        InvalidInput: A joint or constraint has no place in a body of ours; names it.
    """
    OsimKinematics(model)
    roots = [one.name for one in model.joints if one.parent == GROUND]
    if len(roots) > 1:
        raise InvalidInput(f"the joints {', '.join(roots)} start at the ground; a body of ours has one root")
    for one in model.couplers:
        raise InvalidInput(
            f"the coordinate '{one.follower}' follows '{one.leader}'; a body of ours has no followers"
        )
    inertias = {GROUND: pin.Inertia.Zero()}
    bodies = {one.name: one for one in model.bodies}
    own = {
        joint.child: pin.SE3(joint.child_frame[:3, :3].T, np.zeros(3))
        if joint.parent == GROUND
        else pin.SE3(joint.child_frame).inverse()
        for joint in model.joints
    }
    joints: dict[str, list[UrdfJoint]] = {GROUND: []}
    for joint in model.joints:
        inertias[joint.child] = _inertia(bodies.get(joint.child), own[joint.child])
        place = own.get(joint.parent, pin.SE3.Identity()) * pin.SE3(joint.parent_frame)
        for link in _links(joint, place, {c.name: c for c in joint.coordinates}):
            joints.setdefault(link.parent, []).append(link)
            inertias.setdefault(link.child, pin.Inertia.Zero())
    for marker in (one for one in model.markers if one.body in own and one.name not in inertias):
        placed = own[marker.body] * pin.SE3(np.eye(3), marker.position_m)
        fixed = UrdfJoint(marker.name, "fixed", marker.body, marker.name, placed, np.zeros(3), np.zeros(2))
        joints.setdefault(marker.body, []).append(fixed)
        inertias[marker.name] = pin.Inertia.Zero()
    return UrdfTree(model.name, GROUND, inertias, {name: tuple(joints.get(name, ())) for name in inertias})


def _inertia(body: OsimBody | None, placed: pin.SE3) -> pin.Inertia:
    """Inertia of a body in its link's frame; zero for a body without mass."""
    if body is None or body.mass_kg == 0.0:
        return pin.Inertia.Zero()
    return pin.Inertia(body.mass_kg, body.centre_m, body.inertia_kgm2).se3Action(placed)


def _links(
    joint: OsimJoint, place: pin.SE3, coordinates: Mapping[str, OsimCoordinate]
) -> Iterator[UrdfJoint]:
    """The hinges of a joint, or the one fixed or floating joint that stands for it."""
    if joint.parent == GROUND:
        yield _floating(joint)
        return
    place = place * pin.SE3(np.eye(3), _constant_shift(joint, coordinates))
    turn, link, hinges = np.eye(3), joint.parent, _hinges(joint, coordinates)
    moving = [one for one in hinges if one[1] is not None]
    for axis, coordinate, offset in hinges:
        if coordinate is None:
            turn = turn @ Rotation.from_rotvec(offset * axis.direction).as_matrix()
            continue
        last = coordinate is moving[-1][1]
        child = joint.child if last else f"{joint.child}/{coordinate.name}"
        placement = place * pin.SE3(turn, np.zeros(3))
        line = axis.amount.line
        assert line is not None
        limits = np.array([coordinate.lowest, coordinate.highest]) + offset * line[1]
        yield UrdfJoint(coordinate.name, "revolute", link, child, placement, line[1] * axis.direction, limits)
        place, turn, link = pin.SE3.Identity(), np.eye(3), child
    if not moving:
        placement = place * pin.SE3(turn, np.zeros(3))
        yield UrdfJoint(joint.name, "fixed", joint.parent, joint.child, placement, np.zeros(3), np.zeros(2))
    elif not np.allclose(turn, np.eye(3), atol=1e-9):
        raise InvalidInput(f"joint '{joint.name}' turns by a constant after its last coordinate")


def _floating(joint: OsimJoint) -> UrdfJoint:
    """The root's joint: three turns and three shifts, each of its own coordinate."""
    names = [one.coordinate for one in (*joint.turns, *joint.shifts)]
    if len(set(names) - {""}) != 6 or len(joint.turns) != 3:
        raise InvalidInput(f"joint '{joint.name}' does not float: the root has three turns and three shifts")
    R = rotation_to_world("y") @ joint.parent_frame[:3, :3]
    placed = pin.SE3(R, np.zeros(3))
    return UrdfJoint(joint.name, "floating", GROUND, joint.child, placed, np.zeros(3), np.zeros(2))


def _constant_shift(joint: OsimJoint, coordinates: Mapping[str, OsimCoordinate]) -> Array:
    shift = np.zeros(3)
    for k, one in enumerate(joint.shifts):
        coordinate, offset, slope = _line(joint, f"translation{k + 1}", one, coordinates)
        if coordinate is not None and slope != 0.0:
            raise InvalidInput(
                f"joint '{joint.name}' shifts with its coordinate '{coordinate.name}'; joints of our bodies only turn"
            )
        shift += offset * one.direction
    return shift


def _hinges(
    joint: OsimJoint, coordinates: Mapping[str, OsimCoordinate]
) -> list[tuple[OsimAxis, OsimCoordinate | None, float]]:
    """Each turn of a joint with its coordinate, None where it is constant, and its angle at coordinate zero."""
    found: list[tuple[OsimAxis, OsimCoordinate | None, float]] = []
    used: set[str] = set()
    for k, one in enumerate(joint.turns):
        coordinate, offset, slope = _line(joint, f"rotation{k + 1}", one, coordinates)
        if coordinate is not None and (abs(slope) != 1.0 or coordinate.name in used):
            raise InvalidInput(
                f"joint '{joint.name}': its rotation{k + 1} is {slope:g} times '{coordinate.name}'; a coordinate is "
                "the angle of one hinge in a body of ours"
            )
        used |= {coordinate.name} if coordinate else set()
        found.append((one, coordinate, offset))
    return found


def _line(
    joint: OsimJoint, which: str, axis: OsimAxis, coordinates: Mapping[str, OsimCoordinate]
) -> tuple[OsimCoordinate | None, float, float]:
    """Coordinate of a turn or shift, None where it is constant, with offset and slope."""
    line = axis.amount.line
    coordinate = coordinates.get(axis.coordinate)
    if coordinate is not None and coordinate.locked:
        return None, float(axis.amount.value(np.array(coordinate.default))), 0.0
    if line is None:
        if coordinate is None:
            return None, float(axis.amount.value(np.zeros(()))), 0.0
        raise InvalidInput(
            f"joint '{joint.name}': its {which} is a curve over '{coordinate.name}' (spline, polynomial); joints of "
            "our bodies turn about fixed axes. 'mbkf export RESULT --onto' fits such a model to a result"
        )
    return (None, line[0], 0.0) if coordinate is None or line[1] == 0.0 else (coordinate, *line)


def osim_zeros_deg(model: OsimModel) -> dict[str, float]:
    """Values of OpenSim's coordinates at which their hinges' turns are zero, by name, where they are not zero.

    Args:
        model: The model.
    """
    found = {}
    for joint in model.joints:
        for one in joint.turns:
            line = one.amount.line
            if one.coordinate and line is not None and line[0] and abs(line[1]) == 1.0:
                found[one.coordinate] = float(np.rad2deg(-line[0] * line[1]))
    return found


def osim_root_angles(model: OsimModel, root: str) -> TomlTable | None:
    """Table ``[[clinical_joint]]`` of the root with OpenSim's coordinates; None where its axes are no world axes.

    Args:
        model: The model.
        root: Name of the root's segment.
    """
    joint = next(one for one in model.joints if one.parent == GROUND)
    turned = rotation_to_world("y") @ joint.parent_frame[:3, :3]
    entries = []
    for one in (*joint.turns, *joint.shifts):
        direction, line = turned @ one.direction, one.amount.line
        axis = int(np.argmax(np.abs(direction)))
        if line is None or line[0] != 0.0 or abs(line[1]) != 1.0 or abs(direction[axis]) < 1.0 - 1e-9:
            return None
        sign = int(np.sign(direction[axis]) * line[1])
        entries.append({"name": one.coordinate, "axis": _LETTERS[axis], "sign": sign})
    angles, moves = entries[:3], entries[3:]
    names = {"name": root, "proximal": "world", "distal": root, "main": angles[0]["name"]}
    order = "".join(str(one["axis"]) for one in angles)
    found = {**names, "order": order, "angle": angles, "translation": moves}
    origin = turned @ joint.child_frame[:3, :3].T @ joint.child_frame[:3, 3]
    return {**found, "opensim_origin_m": origin.tolist()} if origin.any() else found
