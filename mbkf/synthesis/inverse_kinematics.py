"""Inverse kinematics of a moving body from its centre of mass, its feet and its joint angles, with exact rates.

The legs follow from hip and ankle in closed form (two links with a knee), the position of the pelvis from the centre
of mass by iteration. Angles: a joint's rotation is Ry(y) Rx(x) Rz(z); the pelvis's is Rz Ry Rx.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.model.skeleton import joint_origin
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.masses import Masses, MovingMass
from mbkf.synthesis.two_links import Limb, TwoLinks

SIDE_NAMES = {"r": "right", "l": "left"}

NEWTON, ROUNDS = 12, 60
"""Newton steps at most that find the pelvis, and iterations at most, where those fail."""

NEAR_M = 1e-8
"""Error of the centre of mass, m, of which one step of Newton's leaves nothing."""

CLOSE = np.array([1e-13, 1e-11, 1e-9])
"""Errors of the centre of mass at which iterations end: m, m/s, m/s²; more, as digits are, further than 1 m away."""

GAIN = np.eye(3) * [1.2, 1.2, 1.1]
"""Step of the pelvis per error of the centre of mass where Newton's steps fail; legs follow a little."""


@dataclass(frozen=True)
class FootPose:
    """Where a foot is: ``ankle`` (T, 3) m, (T,) ``yaw`` and ``pitch`` (heel up positive) and ``toes`` hinge, rad.

    The knee bends towards the heading of the foot, or towards a point ``knee`` (3,), m. ``roll`` (T,) is the foot's
    turn about its length (its left side up), rad; None: zero.
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
        posture: The prescribed parts.
    """

    rotations: dict[str, Dual]
    origins: dict[str, Dual]
    angles: dict[str, tuple[Dual, ...]]
    knee: Array
    reach: Array
    posture: Posture


@dataclass(frozen=True)
class Posture:
    """Prescribed parts of a pose, except its centre of mass.

    Attributes:
        rotations: Per segment with a given one the (T, 3, 3) world rotation.
        above: Per segment of pelvis, trunk, head and hanging arms the (T, 3) origin relative to the pelvis's, m.
        ends: Per segment of the feet the (T, 3) world origin, m.
        angles: Per dof of a hinge or universal joint, by segment, the (T,) angles, rad.
        legs: "right" and "left" leg.
        arms: Arms whose hands' place is given.
        fixed: (T, 3) first moment of mass with the pelvis's origin in the world's, without the limbs' share, kg m.
        mass: Mass that moves with the pelvis's origin, without limbs, kg.
        hung: Mass of the segments of ``above``, about the pelvis's origin.
        placed: Mass of the segments of ``ends``.
    """

    rotations: dict[str, Dual]
    above: dict[str, Dual]
    ends: dict[str, Dual]
    angles: dict[str, tuple[Dual, ...]]
    legs: dict[str, Limb]
    arms: dict[str, Limb]
    fixed: Dual
    mass: float
    hung: MovingMass
    placed: MovingMass


class InverseKinematics:
    """Poses of one scaled body from centre of mass, feet and joint angles.

    Attributes:
        model: The body.
        masses: Masses of its segments.
        offset: (3,) joint in the parent's frame by segment, m.
    """

    def __init__(self, model: Body) -> None:
        self.model = model
        self.masses = Masses(model)
        self.total_mass = sum(self.masses.kg.values())
        self.offset: dict[str, Array] = {}
        self.parent: dict[str, str] = {}
        for segment in model.description.segments:
            self.parent[segment.name] = segment.parent
            if segment.parent != "world":
                self.offset[segment.name] = joint_origin(model, segment.name)

    def leg_length(self, side: str) -> float:
        """Hip to ankle with a straight knee, m; side "r" or "l"."""
        name = SIDE_NAMES[side]
        return float(
            np.linalg.norm(self.offset[f"{name}_shank"]) + np.linalg.norm(self.offset[f"{name}_foot"])
        )

    def posture(
        self,
        angles: Mapping[str, tuple[Dual, ...]],
        feet: Mapping[str, FootPose],
        hands: Mapping[str, HandPose] | None = None,
    ) -> Posture:
        """Prescribed parts of a pose, except its centre of mass.

        Args:
            angles: Joint angles (x, y, z) of pelvis, torso, neck (x, y), head, arms, and the knees' small
                rotations ``{side}_shank`` (x, z; y is not used), rad.
            feet: The feet by side.
            hands: The hands whose place is given, by side; of these arms' angles only the forearm's small rotations
                (x, z) are used.
        """
        held = {SIDE_NAMES[side]: hand for side, hand in (hands or {}).items()}
        rotations, origins = self._upper(angles, list(held))
        ends = self._feet(feet)
        hung, placed = self.masses.moving(rotations, origins), self.masses.moving(*ends)
        fixed, mass = hung.moment + placed.moment, sum(self.masses.kg[name] for name in origins)
        legs = {SIDE_NAMES[side]: self._leg(side, rotations["pelvis"], angles, feet[side]) for side in SIDES}
        arms = {name: self._arm(name, rotations, origins, angles, hand) for name, hand in held.items()}
        for name, hand in held.items():
            fixed = fixed + hand.rotation.apply(
                self.masses.kg[f"{name}_hand"] * self.masses.com[f"{name}_hand"]
            )
            rotations[f"{name}_hand"] = hand.rotation
        hinged = {"neck": angles["neck"][:2], "right_toes": (feet["r"].toes,), "left_toes": (feet["l"].toes,)}
        rotations |= ends[0]
        return Posture(rotations, origins, ends[1], hinged, legs, arms, fixed, mass, hung, placed)

    def pose(self, com: Dual, posture: Posture, start: Array | None = None) -> Pose:
        """The pose with a given (T, 3) centre of mass, m.

        Args:
            com: Whole-body centre of mass.
            posture: Other prescribed coordinates.
            start: (T, 3) pelvis position from which the iteration starts, m.
        """
        pelvis = self._pelvis(com, posture, com.value if start is None else start)
        rotations = dict(posture.rotations)
        origins = {name: origin + pelvis for name, origin in posture.above.items()} | posture.ends
        knees, reach = [], np.zeros(len(com.value))
        for name, leg in posture.legs.items():
            knee, used = self._place(name, ("thigh", "shank", None), leg, pelvis, rotations, origins)
            knees.append(knee)
            reach = np.maximum(reach, used)
        for name, arm in posture.arms.items():
            self._place(name, ("upper_arm", "forearm", "hand"), arm, pelvis, rotations, origins)
        return Pose(rotations, origins, posture.angles, np.stack(knees, axis=-1), reach, posture)

    def _pelvis(self, com: Dual, posture: Posture, start: Array) -> Dual:
        """(T, 3) pelvis position with which the centre of mass is where it should be, m.

        Place, velocity and acceleration are found one after the other: each is a linear equation once those before it
        are known.
        """
        pelvis = self._solved(com.upto(0), posture, Dual(start))
        for order, rate in enumerate(com.orders[1:], start=1):
            pelvis = self._solved(com.upto(order), posture, Dual(*pelvis.orders, rate))
        return pelvis

    def _solved(self, com: Dual, posture: Posture, pelvis: Dual) -> Dual:
        """The pelvis position with its highest derivative, from one whose lower orders are right."""
        limbs = [*posture.legs.values(), *posture.arms.values()]
        close = CLOSE[: len(com.orders)] * max(1.0, float(np.abs(com.value).max()))
        solved = np.append(close[:-1], np.inf if len(close) > 1 else NEAR_M)
        for k in range(ROUNDS):
            moment, mass = posture.fixed + pelvis * posture.mass, posture.mass * np.eye(3)
            for limb in limbs:
                own, by_pelvis = limb.moment_by_pelvis(pelvis)
                moment, mass = moment + own, mass + by_pelvis
            error = (com - moment / self.total_mass).orders
            gain = self.total_mass * _inverse(mass) if k < NEWTON else GAIN[None]
            pelvis = pelvis + Dual.of(np.einsum("tij,ntj->nti", gain, error))
            if (np.abs(error).max(axis=(1, 2)) < (solved if k < NEWTON else close)).all():
                break
        return pelvis

    @staticmethod
    def _place(
        name: str,
        parts: tuple[str, str, str | None],
        limb: Limb,
        pelvis: Dual,
        rotations: dict[str, Dual],
        origins: dict[str, Dual],
    ) -> tuple[Array, Array]:
        """Adds a limb's segments to rotations and origins; returns its flexion, rad, and its reach.

        Args:
            name: "right" or "left".
            parts: The upper and the lower link, and the part at the far end; None: that part has its place.
            limb: The limb.
            pelvis: (T, 3) origin of the pelvis, m.
            rotations: World rotations by segment.
            origins: World origins by segment.
        """
        near = pelvis + limb.near
        span = limb.span(near)
        bend = limb.links.bend(span, limb.across(near))
        upper, lower, end = parts
        first, last = bend.rotations()
        rotations[f"{name}_{upper}"], rotations[f"{name}_{lower}"] = first, last
        origins[f"{name}_{upper}"] = near
        origins[f"{name}_{lower}"] = near + first.apply(limb.links.ends[0])
        if end is not None:
            origins[f"{name}_{end}"] = near + span
        return bend.flexion, bend.used

    def _limb(
        self,
        names: tuple[str, str],
        links: TwoLinks,
        near: Dual,
        span: Callable[[Dual], Dual],
        across: Callable[[Dual], Dual],
        hand: HandPose | None = None,
        swing: Array | None = None,
    ) -> Limb:
        """A limb of two segments, see :class:`mbkf.synthesis.two_links.Limb` for the arguments.

        Args:
            names: The upper and the lower segment.
            links: The links.
            near: Near end relative to the pelvis's origin.
            span: Way from the near to the far end.
            across: Near which the middle joint's axis lies.
            hand: The part whose mass goes with the far end; None: it has its place.
            swing: Change of ``across`` with the near end.
        """
        upper, lower = names
        masses = self.masses.kg[upper], self.masses.kg[lower]
        first = masses[0] * self.masses.com[upper] + masses[1] * self.offset[lower]
        last = links.small.apply(masses[1] * self.masses.com[lower])
        held = np.ones(len(near.value)) if hand is None else hand.held.value
        beyond = 0.0 if hand is None else self.masses.kg[upper.replace("upper_arm", "hand")]
        return Limb(links, near, span, across, sum(masses), first, last, beyond, held, swing)

    def _leg(self, side: str, pelvis: Dual, angles: Mapping[str, tuple[Dual, ...]], foot: FootPose) -> Limb:
        """A leg, which hangs on the pelvis's (T, 3, 3) rotation and ends at the ankle."""
        name = SIDE_NAMES[side]
        ends = self.offset[f"{name}_shank"], self.offset[f"{name}_foot"]
        small = angles[f"{name}_shank"]
        left = dual_numbers.stack([-dual_numbers.sin(foot.yaw), dual_numbers.cos(foot.yaw), foot.yaw * 0.0])

        def across(hip: Dual) -> Dual:
            return left if foot.knee is None else dual_numbers.cross(foot.knee - hip, foot.ankle - hip)

        swing = None if foot.knee is None else foot.knee - foot.ankle.value
        return self._limb(
            (f"{name}_thigh", f"{name}_shank"),
            TwoLinks(ends, small[0], small[2]),
            pelvis.apply(self.offset[f"{name}_thigh"]),
            lambda hip: foot.ankle - hip,
            across,
            swing=swing,
        )

    def _arm(
        self,
        name: str,
        rotations: Mapping[str, Dual],
        origins: Mapping[str, Dual],
        angles: Mapping[str, tuple[Dual, ...]],
        hand: HandPose,
    ) -> Limb:
        """An arm whose hand's place is given.

        Args:
            name: "right" or "left".
            rotations: World rotations of the trunk.
            origins: Origins of the trunk relative to the pelvis's origin, m.
            angles: Joint angles, rad.
            hand: Where the hand is.
        """
        torso = rotations["torso"]
        ends = self.offset[f"{name}_forearm"], self.offset[f"{name}_hand"]
        small = angles[f"{name}_forearm"]
        hanging, left = torso.apply(hand.hanging), torso.apply(np.array([0.0, 1.0, 0.0]))
        return self._limb(
            (f"{name}_upper_arm", f"{name}_forearm"),
            TwoLinks(ends, small[0], small[2], -1.0),
            origins["torso"] + torso.apply(self.offset[f"{name}_upper_arm"]),
            lambda shoulder: hanging + (hand.wrist - shoulder - hanging) * hand.held[:, None],
            lambda _: left,
            hand,
        )

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
        names = [name for name, parent in self.parent.items() if parent != "world" and name not in arms]
        names = [name for name in names if not name.endswith(("thigh", "shank", "foot", "toes"))]
        free = [name for name in names if name != "neck"]
        turned = dual_numbers.euler(
            [dual_numbers.stack([angles[name][k] for name in free]) for k in range(3)]
        )
        relative = {name: turned[:, k] for k, name in enumerate(free)}
        x, y = angles["neck"][:2]
        relative["neck"] = dual_numbers.rotation(0, x) @ dual_numbers.rotation(1, y)
        for name in names:
            parent = self.parent[name]
            rotations[name] = rotations[parent] @ relative[name]
            origins[name] = origins[parent] + rotations[parent].apply(self.offset[name])
        return rotations, origins

    def _feet(self, feet: Mapping[str, FootPose]) -> tuple[dict[str, Dual], dict[str, Dual]]:
        """World rotations and origins of feet and toes."""
        rotations: dict[str, Dual] = {}
        origins: dict[str, Dual] = {}
        for side, foot in feet.items():
            name = SIDE_NAMES[side]
            rotation = dual_numbers.rotation(2, foot.yaw) @ dual_numbers.rotation(1, foot.pitch)
            if foot.roll is not None:
                rotation = rotation @ dual_numbers.rotation(0, foot.roll)
            rotations[f"{name}_foot"], origins[f"{name}_foot"] = rotation, foot.ankle
            rotations[f"{name}_toes"] = rotation @ dual_numbers.rotation(1, foot.toes)
            origins[f"{name}_toes"] = foot.ankle + rotation.apply(self.offset[f"{name}_toes"])
        return rotations, origins

    def momentum(self, pose: Pose) -> tuple[Dual, Array]:
        """Centre of mass (T, 3), and (2, T, 3) angular momentum about it, N m s, with its derivative, N m.

        The derivative is lacking where accelerations of the pose are.
        """
        posture, pelvis = pose.posture, pose.origins["pelvis"]
        given = {**posture.above, **posture.ends}
        limbs = self.masses.moving(pose.rotations, {k: x for k, x in pose.origins.items() if k not in given})
        hung = posture.hung.moment + pelvis * posture.mass
        moment = hung + posture.placed.moment + limbs.moment
        com, n = moment / self.total_mass, len(moment.orders)
        second = limbs.second + posture.placed.second[: n - 1] + posture.hung.second[: n - 1]
        for rate, value in ((hung, pelvis), (pelvis, posture.hung.moment), (moment, -com)):
            second += np.einsum("nti,tk->ntik", rate.orders[1:n], value.value)
        return com, 2.0 * dual_numbers.axial(second)


def _inverse(matrices: Array) -> Array:
    """(T, 3, 3) inverses, by vector products of the rows."""
    a, b, c = np.moveaxis(matrices, 1, 0)
    crossed = np.array([dual_numbers.vector_product(*pair).T for pair in ((b, c), (c, a), (a, b))])
    return np.einsum("rit,t->tir", crossed, 1.0 / np.einsum("ti,it->t", a, crossed[0]))
