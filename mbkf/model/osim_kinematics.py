"""Poses of an OpenSim model's bodies over a motion, and their derivatives by its coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.osim import OsimCoupler, OsimModel
from mbkf.io.osim_joints import OsimAxis, OsimJoint

GROUND = "ground"


@dataclass(frozen=True)
class OsimPoses:
    """Poses of B bodies in T frames, in the axes of the ground, with the derivatives by C coordinates.

    Attributes:
        rotations: (T, B, 3, 3) from the body's axes to the ground's.
        origins_m: (T, B, 3) origins.
        turning: (T, B, 3, C) angular velocity by the rates of the coordinates.
        moving: (T, B, 3, C) velocity of the origin by those rates.
    """

    rotations: Array
    origins_m: Array
    turning: Array
    moving: Array

    def points(self, bodies: NDArray[np.intp], places_m: Array) -> tuple[Array, Array]:
        """(T, P, 3) points fixed to bodies, and (T, P, 3, C) their derivatives by the coordinates.

        Args:
            bodies: (P,) numbers of the bodies.
            places_m: (P, 3) places in the bodies' frames.
        """
        arms = np.einsum("tpij,pj->tpi", self.rotations[:, bodies], places_m)
        by = self.moving[:, bodies] + np.cross(self.turning[:, bodies], arms[..., None], axis=2)
        return self.origins_m[:, bodies] + arms, by


class OsimKinematics:
    """A model's joints, parents first, and its constraints between coordinates.

    Attributes:
        model: The model.
        bodies: (B,) names of the bodies that joints connect to the ground.
        names: (C,) names of the coordinates, in the order of the file.
        defaults: (C,) their values in the default pose.
        free: (N,) numbers of those that are neither locked nor follow another one.
    """

    def __init__(self, model: OsimModel) -> None:
        """Puts the joints in order.

        Raises:
            InvalidInput: A joint or a constraint is of a kind that is not supported, a coordinate's motion is
                prescribed, a name stands twice or is missing, or bodies hang in a circle.
        """
        self.model = model
        self.names = tuple(one.name for one in model.coordinates)
        self.defaults = np.array([one.default for one in model.coordinates])
        _check(model, self.names)
        self._joints = _parents_first(model)
        self.bodies = tuple(joint.child for joint in self._joints)
        self._number = {name: number for number, name in enumerate(self.names)}
        self._place = {name: place for place, name in enumerate(self.bodies)}
        self._couplers = _leaders_first(model.couplers)
        follow = {one.follower for one in self._couplers}
        self.free = np.array(
            [
                number
                for number, one in enumerate(model.coordinates)
                if one.name not in follow and not one.locked
            ],
            dtype=int,
        )

    def body(self, name: str) -> int:
        """Number of a body.

        Raises:
            InvalidInput: The model has no such body, or no joint connects it to the ground.
        """
        if name not in self._place:
            raise InvalidInput(f"the model's joints connect no body '{name}' to the ground")
        return self._place[name]

    def expanded(self, free: Array) -> tuple[Array, Array]:
        """(T, C) all coordinates of (T, N) free ones, and (T, C, N) their derivatives; constraints hold."""
        frames, count = free.shape
        q = np.tile(self.defaults, (frames, 1))
        q[:, self.free] = free
        by = np.zeros((frames, len(self.names), count))
        by[:, self.free, np.arange(count)] = 1.0
        for one in self._couplers:
            leader, follower = self._number[one.leader], self._number[one.follower]
            q[:, follower] = one.value.value(q[:, leader])
            by[:, follower] = one.value.slope(q[:, leader])[:, None] * by[:, leader]
        return q, by

    def poses(self, q: Array) -> OsimPoses:
        """Poses of the bodies for coordinates q (T, C), which need not fulfil the constraints."""
        frames, bodies, count = len(q), len(self.bodies), len(self.names)
        found = OsimPoses(
            np.empty((frames, bodies, 3, 3)),
            np.empty((frames, bodies, 3)),
            np.zeros((frames, bodies, 3, count)),
            np.zeros((frames, bodies, 3, count)),
        )
        for place, joint in enumerate(self._joints):
            frame = _Frame(frames, count)
            if joint.parent != GROUND:
                parent = self._place[joint.parent]
                frame.R, frame.origin = found.rotations[:, parent], found.origins_m[:, parent]
                frame.turning, frame.moving = found.turning[:, parent].copy(), found.moving[:, parent].copy()
            frame.shift(joint.parent_frame[:3, 3])
            frame.R = frame.R @ joint.parent_frame[:3, :3]
            self._move(frame, joint, q)
            frame.R = frame.R @ joint.child_frame[:3, :3].T
            frame.shift(-joint.child_frame[:3, 3])
            found.rotations[:, place], found.origins_m[:, place] = frame.R, frame.origin
            found.turning[:, place], found.moving[:, place] = frame.turning, frame.moving
        return found

    def _move(self, frame: _Frame, joint: OsimJoint, q: Array) -> None:
        """Takes a joint's frame from the parent's side to the child's."""
        along = frame.R
        shift, rate = np.zeros((len(q), 3)), np.zeros_like(frame.moving)
        for one in joint.shifts:
            amount, slope, number = self._amount(one, q)
            shift += amount[:, None] * one.direction
            if number is not None:
                rate[:, :, number] += slope[:, None] * (along @ one.direction)
        frame.shift(shift)
        frame.moving += rate
        for one in joint.turns:
            amount, slope, number = self._amount(one, q)
            if number is not None:
                frame.turning[:, :, number] += slope[:, None] * (frame.R @ one.direction)
            frame.R = frame.R @ Rotation.from_rotvec(amount[:, None] * one.direction).as_matrix()

    def _amount(self, axis: OsimAxis, q: Array) -> tuple[Array, Array, int | None]:
        number = self._number[axis.coordinate] if axis.coordinate else None
        x = np.zeros(len(q)) if number is None else q[:, number]
        return axis.amount.value(x), axis.amount.slope(x), number


class _Frame:
    """A frame that is carried from body to body.

    Attributes:
        R: (T, 3, 3) its rotation.
        origin: (T, 3) its origin.
        turning: (T, 3, C) its angular velocity by the rates of the coordinates.
        moving: (T, 3, C) the velocity of its origin.
    """

    def __init__(self, frames: int, coordinates: int) -> None:
        self.R: Array = np.tile(np.eye(3), (frames, 1, 1))
        self.origin: Array = np.zeros((frames, 3))
        self.turning: Array = np.zeros((frames, 3, coordinates))
        self.moving: Array = np.zeros((frames, 3, coordinates))

    def shift(self, place: Array) -> None:
        """Moves the origin to a place (3,) or (T, 3) that is fixed in the frame."""
        arm = np.einsum("tij,...j->ti" if place.ndim == 1 else "tij,tj->ti", self.R, place)
        self.origin = self.origin + arm
        self.moving = self.moving + np.cross(self.turning, arm[..., None], axis=1)


def _check(model: OsimModel, names: tuple[str, ...]) -> None:
    for joint in model.joints:
        if joint.fault:
            raise InvalidInput(f"{model.name}: joint '{joint.name}' cannot be followed: {joint.fault}")
        for one in joint.coordinates:
            if one.prescribed:
                raise InvalidInput(
                    f"{model.name}: the motion of coordinate '{one.name}' is prescribed; set prescribed to false"
                )
    if model.other_constraints:
        raise InvalidInput(
            f"{model.name}: constraints of these kinds are not supported: {', '.join(model.other_constraints)}; "
            "set isEnforced to false where the motion may do without them"
        )
    twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
    if twice is not None:
        raise InvalidInput(f"{model.name}: the coordinate '{twice}' stands twice")
    used = {one.coordinate for joint in model.joints for one in (*joint.turns, *joint.shifts)}
    used |= {name for one in model.couplers for name in (one.leader, one.follower)}
    unknown = sorted(used - {"", *names})
    if unknown:
        raise InvalidInput(f"{model.name}: no joint has a coordinate '{unknown[0]}'")


def _parents_first(model: OsimModel) -> tuple[OsimJoint, ...]:
    """The joints that connect bodies to the ground, a body's own before those of its children.

    Raises:
        InvalidInput: Two joints have one child, or no joint starts at the ground.
    """
    known, left, order = {GROUND}, list(model.joints), []
    for _ in model.joints:
        ready = next((joint for joint in left if joint.parent in known), None)
        if ready is None:
            break
        if ready.child in known:
            raise InvalidInput(
                f"{model.name}: body '{ready.child}' is held by two joints; loops are not supported"
            )
        left.remove(ready)
        order.append(ready)
        known.add(ready.child)
    if not order or left:
        names = ", ".join(f"'{joint.name}'" for joint in left[:4])
        raise InvalidInput(
            f"{model.name}: no chain of joints connects to the ground{f': {names}' if names else ''}"
        )
    return tuple(order)


def _leaders_first(couplers: tuple[OsimCoupler, ...]) -> tuple[OsimCoupler, ...]:
    """Couplers in an order in which a coordinate is known before another follows it.

    Raises:
        InvalidInput: Coordinates follow each other in a circle.
    """
    left, order = list(couplers), []
    for _ in couplers:
        followers = {one.follower for one in left}
        ready = next((one for one in left if one.leader not in followers), None)
        if ready is None:
            raise InvalidInput(f"coordinates follow each other in a circle: {', '.join(sorted(followers))}")
        left.remove(ready)
        order.append(ready)
    return tuple(order)
