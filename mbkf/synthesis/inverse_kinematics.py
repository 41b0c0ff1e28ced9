"""Inverse kinematics of a moving body from its centre of mass, its feet and its joint angles, with exact rates.

The legs follow from hip and ankle in closed form (two links with a knee), the position of the pelvis from the centre
of mass by iteration. Angles: a joint's rotation is Ry(y) Rx(x) Rz(z); the pelvis's is Rz Ry Rx.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import SIDES, Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.dual_numbers import Dual

SIDE_NAMES = {"r": "right", "l": "left"}

STRAIGHT_RAD = np.deg2rad(2.5)
"""The knee never gets straighter than this; a leg asked to reach further stays short."""


@dataclass(frozen=True)
class FootPose:
    """Where a foot is: ``ankle`` (T, 3) m, (T,) ``yaw`` and ``pitch`` (heel up positive) and ``toes`` hinge, rad.

    The knee bends towards the heading of the foot, or towards a point ``knee`` (3,), m. ``roll`` (T,) is the foot's
    turn about its length (its left side up), rad; None for none.
    """

    ankle: Dual
    yaw: Dual
    pitch: Dual
    toes: Dual
    knee: Array | None = None
    roll: Dual | None = None


@dataclass(frozen=True)
class HandPose:
    """Where a hand is, and with it the whole arm.

    Attributes:
        wrist: (T, 3) where the wrist is held, m.
        held: (T,) 1 where it is there, 0 where it hangs from the shoulder.
        hanging: (3,) shoulder to wrist of the hanging arm in the torso's frame, m.
        rotation: (T, 3, 3) world rotation of the hand.
    """

    wrist: Dual
    held: Dual
    hanging: Array
    rotation: Dual


@dataclass(frozen=True)
class Pose:
    """The whole body over time.

    Attributes:
        rotations: Per segment the (T, 3, 3) world rotation.
        origins: Per segment the (T, 3) world origin, m.
        angles: Per dof of a hinge or universal joint, by segment, the (T,) angles, rad.
        knee: (T, 2) flexion of right and left knee, rad.
        reach: (T,) largest ratio of a hip–ankle distance to the length of the leg.
    """

    rotations: dict[str, Dual]
    origins: dict[str, Dual]
    angles: dict[str, tuple[Dual, ...]]
    knee: Array
    reach: Array


class InverseKinematics:
    """Poses of one scaled body from centre of mass, feet and joint angles.

    Attributes:
        model: The body.
        mass: Mass by segment, kg.
        com: (3,) centre of mass by segment, m.
        moments: (3, 3) second moments of mass about the centre of mass by segment, kg m².
        offset: (3,) joint in the parent's frame by segment, m.
    """

    def __init__(self, model: Body) -> None:
        self.model = model
        self.mass: dict[str, float] = {}
        self.com: dict[str, Array] = {}
        self.moments: dict[str, Array] = {}
        self.offset: dict[str, Array] = {}
        self.parent: dict[str, str] = {}
        for segment in model.description.segments:
            inertia = model.pin_model.inertias[model.joint(segment.name).joint_id]
            about_com = np.array(inertia.inertia)
            self.mass[segment.name] = float(inertia.mass)
            self.com[segment.name] = np.array(inertia.lever)
            self.moments[segment.name] = 0.5 * np.trace(about_com) * np.eye(3) - about_com
            self.parent[segment.name] = segment.parent
            if segment.parent != "world":
                parent = model.description.segment(segment.parent)
                self.offset[segment.name] = model.axis_scale(parent) * segment.origin_m
        self.total_mass = sum(self.mass.values())

    def leg_length(self, side: str) -> float:
        """Hip to ankle with a straight knee, m; side "r" or "l"."""
        name = SIDE_NAMES[side]
        return float(
            np.linalg.norm(self.offset[f"{name}_shank"]) + np.linalg.norm(self.offset[f"{name}_foot"])
        )

    def pose(
        self,
        com: Dual,
        angles: Mapping[str, tuple[Dual, ...]],
        feet: Mapping[str, FootPose],
        start: Dual | None = None,
        hands: Mapping[str, HandPose] | None = None,
    ) -> Pose:
        """The pose with a given (T, 3) centre of mass, m.

        Args:
            com: Whole-body centre of mass.
            angles: Joint angles (x, y, z) of pelvis, torso, neck (x, y), head, arms, and the knees' small
                rotations ``{side}_shank`` (x, z; y is not used), rad.
            feet: The feet by side.
            start: Pelvis position from which the iteration starts.
            hands: The hands whose place is given, by side; of these arms' angles only the forearm's small rotations
                (x, z) are used.
        """
        hands = hands or {}
        upper = self._upper(angles, [SIDE_NAMES[side] for side in hands])
        rest = sum((self._weighted(name, *upper) for name in upper[0]), start=Dual.constant(np.zeros(3)))
        upper_mass = sum(self.mass[name] for name in upper[0])
        pelvis = com if start is None else start
        for _ in range(60):
            limbs = self._limbs(pelvis, upper, angles, feet, hands)
            below = sum(
                (self._weighted(name, *limbs[:2]) for name in limbs[0]), start=Dual.constant(np.zeros(3))
            )
            error = com - (rest + below + pelvis * upper_mass) / self.total_mass
            pelvis = pelvis + error * np.array([1.2, 1.2, 1.1])
            if all(np.abs(e).max() < tol for e, tol in zip(error.orders, (1e-13, 1e-11, 1e-9), strict=True)):
                break
        limbs = self._limbs(pelvis, upper, angles, feet, hands)
        rotations, origins = {**upper[0], **limbs[0]}, {name: p + pelvis for name, p in upper[1].items()}
        origins.update(limbs[1])
        hinged = {"neck": angles["neck"][:2], "right_toes": (feet["r"].toes,), "left_toes": (feet["l"].toes,)}
        return Pose(rotations, origins, hinged, limbs[2], limbs[3])

    def _weighted(self, name: str, rotations: dict[str, Dual], origins: dict[str, Dual]) -> Dual:
        return (origins[name] + rotations[name].apply(self.com[name])) * self.mass[name]

    def _limbs(
        self,
        pelvis: Dual,
        upper: tuple[dict[str, Dual], dict[str, Dual]],
        angles: Mapping[str, tuple[Dual, ...]],
        feet: Mapping[str, FootPose],
        hands: Mapping[str, HandPose],
    ) -> tuple[dict[str, Dual], dict[str, Dual], Array, Array]:
        """World rotations and origins of the legs and of arms whose hands' place is given; knees and reach."""
        rotations, origins, knees, reach = self._legs(pelvis, upper[0]["pelvis"], angles, feet)
        for side, hand in hands.items():
            self._arm(
                SIDE_NAMES[side],
                pelvis + upper[1]["torso"],
                upper[0]["torso"],
                angles,
                hand,
                rotations,
                origins,
            )
        return rotations, origins, knees, reach

    def _arm(
        self,
        name: str,
        at: Dual,
        torso: Dual,
        angles: Mapping[str, tuple[Dual, ...]],
        hand: HandPose,
        rotations: dict[str, Dual],
        origins: dict[str, Dual],
    ) -> None:
        """Adds an arm whose hand's place is given; ``at`` and ``torso`` are the torso's origin and rotation."""
        shoulder = at + torso.apply(self.offset[f"{name}_upper_arm"])
        hanging = torso.apply(hand.hanging)
        span = hanging + (hand.wrist - shoulder - hanging) * hand.held[:, None]
        lengths = (-self.offset[f"{name}_forearm"][2], -self.offset[f"{name}_hand"][2])
        across = torso.apply(np.array([0.0, 1.0, 0.0]))
        upper, lower, _, _ = self._limb(lengths, span, angles[f"{name}_forearm"], across, -1.0)
        rotations[f"{name}_upper_arm"], origins[f"{name}_upper_arm"] = upper, shoulder
        rotations[f"{name}_forearm"] = lower
        origins[f"{name}_forearm"] = shoulder + upper.apply(self.offset[f"{name}_forearm"])
        rotations[f"{name}_hand"], origins[f"{name}_hand"] = hand.rotation, shoulder + span

    def _upper(
        self, angles: Mapping[str, tuple[Dual, ...]], without: Sequence[str] = ()
    ) -> tuple[dict[str, Dual], dict[str, Dual]]:
        """World rotations and origins relative to the pelvis's origin, of pelvis, trunk, head and arms.

        Args:
            angles: Joint angles, rad.
            without: "right", "left": arms left out.
        """
        arms = {f"{side}_{part}" for side in without for part in ("upper_arm", "forearm", "hand")}
        rotations = {"pelvis": dual_numbers.euler(angles["pelvis"], order="zyx")}
        origins = {"pelvis": Dual.constant(np.zeros_like(angles["pelvis"][0].value)[:, None] + np.zeros(3))}
        for name, parent in self.parent.items():
            if parent == "world" or name in arms or name.endswith(("thigh", "shank", "foot", "toes")):
                continue
            if name == "neck":
                x, y = angles[name][:2]
                relative = dual_numbers.rotation(0, x) @ dual_numbers.rotation(1, y)
            else:
                relative = dual_numbers.euler(angles[name])
            rotations[name] = rotations[parent] @ relative
            origins[name] = origins[parent] + rotations[parent].apply(self.offset[name])
        return rotations, origins

    def _legs(
        self,
        pelvis: Dual,
        pelvis_rotation: Dual,
        angles: Mapping[str, tuple[Dual, ...]],
        feet: Mapping[str, FootPose],
    ) -> tuple[dict[str, Dual], dict[str, Dual], Array, Array]:
        rotations: dict[str, Dual] = {}
        origins: dict[str, Dual] = {}
        knees, reach = [], np.zeros(len(pelvis.value))
        for side in SIDES:
            name, foot = SIDE_NAMES[side], feet[side]
            hip = pelvis + pelvis_rotation.apply(self.offset[f"{name}_thigh"])
            lengths = (-self.offset[f"{name}_shank"][2], -self.offset[f"{name}_foot"][2])
            if foot.knee is None:
                across = dual_numbers.stack(
                    [-dual_numbers.sin(foot.yaw), dual_numbers.cos(foot.yaw), foot.yaw * 0.0]
                )
            else:
                across = dual_numbers.cross(foot.knee - hip, foot.ankle - hip)
            thigh, shank, knee, used = self._limb(lengths, foot.ankle - hip, angles[f"{name}_shank"], across)
            foot_rotation = dual_numbers.rotation(2, foot.yaw) @ dual_numbers.rotation(1, foot.pitch)
            if foot.roll is not None:
                foot_rotation = foot_rotation @ dual_numbers.rotation(0, foot.roll)
            rotations[f"{name}_thigh"], origins[f"{name}_thigh"] = thigh, hip
            rotations[f"{name}_shank"] = shank
            origins[f"{name}_shank"] = hip + thigh.apply(self.offset[f"{name}_shank"])
            rotations[f"{name}_foot"], origins[f"{name}_foot"] = foot_rotation, foot.ankle
            rotations[f"{name}_toes"] = foot_rotation @ dual_numbers.rotation(1, foot.toes)
            origins[f"{name}_toes"] = foot.ankle + foot_rotation.apply(self.offset[f"{name}_toes"])
            knees.append(knee)
            reach = np.maximum(reach, used)
        return rotations, origins, np.stack(knees, axis=-1), reach

    def _limb(
        self,
        lengths: tuple[float, float],
        span: Dual,
        middle_xz: tuple[Dual, ...],
        across: Dual,
        bends: float = 1.0,
    ) -> tuple[Dual, Dual, Array, Array]:
        """Rotations of two links that put the far end at ``span`` from the near one, flexion and reach.

        Args:
            lengths: Of the upper and the lower link, m.
            span: (T, 3) m.
            middle_xz: Small rotations of the middle joint about x and z (first and last), rad.
            across: (T, 3) near which the axis of the middle joint lies.
            bends: Sign of flexion about that axis: 1 knee, −1 elbow.
        """
        upper, lower = lengths
        square = dual_numbers.dot(span, span)
        cosine = (square - upper**2 - lower**2) / (dual_numbers.cos(middle_xz[0]) * (2 * upper * lower))
        limit = float(np.cos(STRAIGHT_RAD))
        cosine = dual_numbers.where(
            (cosine.value < limit) & (cosine.value > -limit),
            cosine,
            Dual.constant(np.clip(cosine.value, -limit, limit)),
        )
        flexion = dual_numbers.arccos(cosine)
        middle = dual_numbers.euler((middle_xz[0], flexion * bends, middle_xz[2]))
        local = middle.apply(np.array([0.0, 0.0, -lower])) + np.array([0.0, 0.0, -upper])
        side_axis = Dual.constant(np.zeros_like(span.value) + np.array([0.0, 1.0, 0.0]))
        first = _frame(span, across) @ _frame(local, side_axis).transposed()
        used = np.sqrt(square.value) / (upper + lower)
        return first, first @ middle, flexion.value, used

    def momentum(self, pose: Pose) -> tuple[Dual, Array, Array]:
        """Centre of mass (T, 3), angular momentum about it (T, 3) in N m s and its derivative (T, 3) in N m."""
        com = (
            sum(
                (self._weighted(name, pose.rotations, pose.origins) for name in self.mass),
                start=Dual.constant(np.zeros(3)),
            )
            / self.total_mass
        )
        spin, change = np.zeros_like(com.value), np.zeros_like(com.value)
        for name, mass in self.mass.items():
            R = pose.rotations[name]
            at = pose.origins[name] + R.apply(self.com[name]) - com
            carried = self.moments[name] @ np.swapaxes(R.value, -1, -2)
            spin += 2 * dual_numbers.axial(R.first @ carried) + mass * np.cross(at.value, at.first)
            change += 2 * dual_numbers.axial(R.second @ carried) + mass * np.cross(at.value, at.second)
        return com, spin, change

    def coordinates(self, pose: Pose) -> tuple[Array, Array, Array]:
        """Arrays q (T, nq), v (T, nv), a (T, nv) of a pose, in Pinocchio's coordinates; quaternions do not jump."""
        frames = len(pose.knee)
        q = np.zeros((frames, self.model.nq))
        v, a = np.zeros((frames, self.model.nv)), np.zeros((frames, self.model.nv))
        for name, joint in self.model.joints.items():
            if joint.kind in ("hinge", "universal"):
                for k, angle in enumerate(pose.angles[name]):
                    at_q, at_v = joint.q.start + k, joint.v.start + k
                    q[:, at_q], v[:, at_v], a[:, at_v] = angle.orders
                continue
            rotation, first_q, first_v = pose.rotations[name], joint.q.start, joint.v.start
            if joint.kind == "free":
                to_body, origin = rotation.transposed(), pose.origins[name]
                q[:, first_q : first_q + 3] = origin.value
                v[:, first_v : first_v + 3] = _apply(to_body.value, origin.first)
                a[:, first_v : first_v + 3] = _apply(to_body.value, origin.second) + _apply(
                    to_body.first, origin.first
                )
                first_q, first_v = first_q + 3, first_v + 3
            else:
                rotation = pose.rotations[self.parent[name]].transposed() @ rotation
            q[:, first_q : first_q + 4] = _quaternions(rotation.value)
            v[:, first_v : first_v + 3], a[:, first_v : first_v + 3] = dual_numbers.local_rates(rotation)
        if not (np.isfinite(q).all() and np.isfinite(a).all()):
            raise InvalidInput("the motion cannot be performed by this body")
        return q, v, a


def _apply(matrices: Array, vectors: Array) -> Array:
    return (matrices @ vectors[..., None])[..., 0]


def _frame(along: Dual, across: Dual) -> Dual:
    """(T, 3, 3) right-handed frame whose first axis is ``along`` and whose second is nearest to ``across``."""
    u = dual_numbers.unit(along)
    w = dual_numbers.unit(across - u * dual_numbers.dot(across, u)[..., None])
    return dual_numbers.stack([u, w, dual_numbers.cross(u, w)])


def _quaternions(rotations: Array) -> Array:
    quaternions = Rotation.from_matrix(rotations).as_quat()
    turned = np.sign(np.einsum("ti,ti->t", quaternions[1:], quaternions[:-1]))
    turned[turned == 0] = 1.0
    quaternions[1:] *= np.cumprod(turned)[:, None]
    return quaternions
