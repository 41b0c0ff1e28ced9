"""Joints of OpenSim's models that slide as they turn, replaced by the fixed hinges that come nearest to them.

A knee of these models moves its tibia along curves of the knee angle θ: X(θ) from the joint's frame in the child to
that in the parent. The hinge that stands for it turns by the same θ,
    X(θ) ≈ T(c) R(θ u) R₀ T(−d),
with axis u, constant turn R₀ and points c, d that make the distances of points of the child least (least squares, over
angles evenly spread). A body whose coordinate follows another one (a kneecap) and that bears no other is fixed in its
default pose. Each replacement is stated with its residual (:class:`Approximation`), and refused where it is too large.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.osim import OsimModel
from mbkf.io.osim_functions import polynomial
from mbkf.io.osim_joints import OsimAxis, OsimCoordinate, OsimJoint
from mbkf.model.description import Approximation

BEND_RAD = np.deg2rad(70.0)
"""A hinge is fitted over the coordinate's range, at most this far from zero: as far as a knee bends in walking."""

ANGLES = 41
"""Number of angles of that range."""

REACH_M = 0.2
"""Distance of the points from the child's centre of mass, forwards and backwards along each axis: half a shank."""

LARGEST_M = 5e-3
"""Largest residual of a hinge, RMS: that of a marker on skin."""

LARGEST_SHARE = 0.01
"""Largest share of the model's mass of a body that is fixed in its default pose."""


def with_fixed_hinges(
    model: OsimModel, ranges_deg: Mapping[str, Sequence[float]]
) -> tuple[OsimModel, tuple[Approximation, ...]]:
    """A model whose joints turn about fixed axes, and the approximations that this took.

    Args:
        model: The model.
        ranges_deg: Range of the angle over which a hinge is fitted, by its coordinate, where it is another one than
            that of :data:`BEND_RAD`.

    Raises:
        InvalidInput: No hinge comes near to a joint, or a body that follows a coordinate has mass or bears others;
            names it.
    """
    curved = {joint.name: one for joint in model.joints if (one := _leading(joint)) is not None}
    unknown = sorted(set(ranges_deg) - {one.name for one in curved.values()})
    if unknown:
        raise InvalidInput(
            f"fitted_deg names {', '.join(unknown)}; only coordinates that lead joints with curves have a fitted "
            f"range, which here are: {', '.join(one.name for one in curved.values()) or 'no coordinates'}"
        )
    fixed, notes = _with_fixed_followers(model)
    joints = []
    for joint in fixed.joints:
        if joint.name in curved and not all(one.locked for one in joint.coordinates):
            coordinate = curved[joint.name]
            points = _points(model, joint)
            hinge, note = _hinge(joint, coordinate, points, _range(coordinate, ranges_deg))
            notes.append(note)
            joints.append(hinge)
        else:
            joints.append(joint)
    return replace(fixed, joints=tuple(joints)), tuple(notes)


def _leading(joint: OsimJoint) -> OsimCoordinate | None:
    """The one coordinate that turns or shifts of a joint follow by a curve or several times; None without such."""
    moving = [one for one in (*joint.turns, *joint.shifts) if _moves(one)]
    names = {one.coordinate for one in moving}
    free = [one for one in joint.coordinates if one.name in names and not one.locked]
    plain = len(moving) == 1 and moving[0] in joint.turns and moving[0].amount.line is not None
    return free[0] if len(free) == len(names) == 1 and not plain and joint.turns else None


def _moves(one: OsimAxis) -> bool:
    """True for a turn or shift that is not constant."""
    return bool(one.coordinate) and (one.amount.line is None or one.amount.line[1] != 0.0)


def _with_fixed_followers(model: OsimModel) -> tuple[OsimModel, list[Approximation]]:
    """The model with bodies fixed whose coordinates follow others."""
    followers = {one.follower: one for one in model.couplers}
    mass = {one.name: one.mass_kg for one in model.bodies}
    default = {one.name: one.default for one in model.coordinates}
    bearing = {joint.parent for joint in model.joints}
    joints, notes, ended = [], [], set[str]()
    for joint in model.joints:
        own = {one.name for one in joint.coordinates}
        if not own or not own <= set(followers):
            joints.append(joint)
            continue
        share = mass.get(joint.child, 0.0) / sum(mass.values())
        if joint.child in bearing or share > LARGEST_SHARE:
            one = followers[min(own)]
            raise InvalidInput(
                f"the coordinate '{one.follower}' follows '{one.leader}', and its body '{joint.child}' bears others or "
                f"has {share:.1%} of the mass; a body of ours has no followers"
            )
        at = {name: followers[name].value.value(np.array(default[followers[name].leader])) for name in own}
        held = tuple(replace(one, default=float(at[one.name]), locked=True) for one in joint.coordinates)
        joints.append(replace(joint, coordinates=held))
        ended |= own
        text = f"{joint.child} ({mass.get(joint.child, 0.0):.2f} kg) is fixed to {joint.parent} in the default pose"
        notes.append(Approximation(joint.parent, 0.0, f"{text}; its coordinate follows another one"))
    left = tuple(one for one in model.couplers if one.follower not in ended)
    return replace(model, joints=tuple(joints), couplers=left), notes


def _range(coordinate: OsimCoordinate, ranges_deg: Mapping[str, Sequence[float]]) -> Array:
    """(2,) least and greatest angle over which a hinge is fitted."""
    if coordinate.name in ranges_deg:
        found = np.deg2rad(np.array(ranges_deg[coordinate.name], dtype=float))
    else:
        found = np.clip([coordinate.lowest, coordinate.highest], -BEND_RAD, BEND_RAD)
    if found.shape != (2,) or not np.isfinite(found).all() or not found[0] < found[1]:
        raise InvalidInput(
            f"a hinge of {coordinate.name} is fitted from {np.rad2deg(found).round(1).tolist()}°; fitted_deg of "
            f"{coordinate.name} needs two angles, the least one first"
        )
    return found


def _points(model: OsimModel, joint: OsimJoint) -> Array:
    """(7, 3) points of a joint's child in the joint's frame there."""
    centre = next((one.centre_m for one in model.bodies if one.name == joint.child), np.zeros(3))
    arms = REACH_M * np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    return (centre + arms - joint.child_frame[:3, 3]) @ joint.child_frame[:3, :3]


def _hinge(
    joint: OsimJoint, coordinate: OsimCoordinate, points: Array, over: Array
) -> tuple[OsimJoint, Approximation]:
    """The hinge that stands for a joint, and its residual."""
    angles = np.linspace(over[0], over[1], ANGLES)
    R, shift = _moved(joint, angles)
    places = np.einsum("tij,pj->tpi", R, points) + shift[:, None]
    start = Rotation.from_matrix(R[0].T @ R[-1]).as_rotvec()
    first = Rotation.from_matrix(R[ANGLES // 2]) * Rotation.from_rotvec(-angles[ANGLES // 2] * _unit(start))

    def parts(p: Array) -> tuple[Array, Rotation, Array, Array]:
        return _unit(first.apply(_unit(start)) + p[:3]), Rotation.from_rotvec(p[3:6]) * first, p[6:9], p[9:]

    def apart(p: Array) -> Array:
        axis, constant, c, d = parts(p)
        turned = Rotation.from_rotvec(angles[:, None] * axis).as_matrix() @ constant.as_matrix()
        return np.einsum("tij,pj->tpi", turned, points - d) + c - places

    found = least_squares(lambda p: apart(p).ravel(), np.zeros(12), xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    axis, constant, c, d = parts(found)
    rms_m = float(np.sqrt(np.mean(np.sum(apart(found) ** 2, axis=2))))
    turned = Rotation.from_rotvec(angles[:, None] * axis) * constant
    off_deg = np.rad2deg((turned.inv() * Rotation.from_matrix(R)).magnitude())
    least, most = np.rad2deg(over)
    text = (
        f"{joint.name} turns about a fixed axis from {least:.0f} to {most:.0f}°: its curves leave {1e3 * rms_m:.1f} mm "
        f"RMS and {off_deg.max():.1f}° at most"
    )
    if rms_m > LARGEST_M:
        raise InvalidInput(
            f"joint '{joint.name}' slides or turns along curves of '{coordinate.name}' (spline, polynomial), "
            f"from which the nearest fixed hinge is {1e3 * rms_m:.1f} mm RMS away; {1e3 * LARGEST_M:.0f} mm are "
            "allowed. 'mbkf export RESULT --onto' fits such a model to a result"
        )
    parent, child = joint.parent_frame.copy(), joint.child_frame.copy()
    parent[:3, 3] += parent[:3, :3] @ c
    child[:3, 3] += child[:3, :3] @ d
    child[:3, :3] = child[:3, :3] @ constant.as_matrix().T
    turn = OsimAxis(axis, polynomial(0.0, 1.0), coordinate.name)
    fixed = replace(joint, parent_frame=parent, child_frame=child, turns=(turn,), shifts=())
    return fixed, Approximation(joint.child, rms_m, text)


def _moved(joint: OsimJoint, angles: Array) -> tuple[Array, Array]:
    """(T, 3, 3) turns and (T, 3) shifts of a joint at values of its one coordinate."""
    R, shift = Rotation.identity(len(angles)), np.zeros((len(angles), 3))
    for one in joint.turns:
        R = R * Rotation.from_rotvec(_amounts(one, angles)[:, None] * one.direction)
    for one in joint.shifts:
        shift += _amounts(one, angles)[:, None] * one.direction
    return R.as_matrix(), shift


def _amounts(one: OsimAxis, angles: Array) -> Array:
    return one.amount.value(angles if one.coordinate else np.zeros(len(angles)))


def _unit(vector: Array) -> Array:
    return vector / (np.linalg.norm(vector) or 1.0)
