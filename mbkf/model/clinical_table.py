"""Clinical coordinates of joints as records, read from a body file's ``[[clinical_joint]]`` tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, TomlTable
from mbkf.model.sides import mirrored

LARGEST_ZERO_DEG = 45.0
"""Bound of the spread of a coordinate's zero."""


@dataclass(frozen=True)
class Angle:
    """One coordinate: ``sign`` times the rotation about (or position along) ``axis``.

    Attributes:
        name: Coordinate name, e.g. ``"hip_flexion_r"``.
        title: The same for people, without the side; "" where the name reads well by itself.
        zero_sd_deg: How far a person's zero of it, by the bones, is from the reference body's.
        axis: "x", "y" or "z".
        sign: +1 or −1.
        positive: What a positive value means, in words.
        opensim: Coordinate of the full-body model of Rajagopal et al. (2016) it compares with, "" where there is none.
        opensim_zero_deg: Value of OpenSim's coordinate where this one is 0.
        oblique: Unit vector that it turns about in place of ``axis``; None where that is the axis itself.
    """

    name: str
    axis: str
    sign: int
    positive: str = ""
    opensim: str = ""
    title: str = ""
    zero_sd_deg: float = 0.0
    opensim_zero_deg: float = 0.0
    oblique: tuple[float, float, float] | None = None

    @property
    def direction(self) -> Array:
        """(3,) unit vector about (or along) which the coordinate is positive."""
        axis = np.eye(3)["xyz".index(self.axis)] if self.oblique is None else np.array(self.oblique)
        return self.sign * axis + 0.0


@dataclass(frozen=True)
class ClinicalJoint:
    """A joint's coordinates.

    Attributes:
        name: Joint name, e.g. ``"hip_r"``.
        proximal, distal: Segments it joins; "world" for the root's proximal one.
        order: Axes of the successive rotations, e.g. ``"yxz"``; one letter for a hinge, two for a universal
            joint.
        main: Name of the angle that stands for the joint in summaries (flexion).
        angles: Its angles, in that order.
        translations: The root's position along three world axes; empty for other joints.
        heading_sd_deg: How far the side-to-side axes of its segments differ in heading in ordinary movement; None where
            they differ at will.
        opensim_origin_m: Origin of OpenSim's distal segment in that segment's frame, whose place the translations of
            OpenSim's root state; None where it is the segment's own.
    """

    name: str
    proximal: str
    distal: str
    order: str
    main: str
    angles: tuple[Angle, ...]
    translations: tuple[Angle, ...]
    heading_sd_deg: float | None = None
    opensim_origin_m: tuple[float, float, float] | None = None

    @property
    def coordinates(self) -> tuple[Angle, ...]:
        """Angles, then translations."""
        return self.angles + self.translations

    def about(self, axis: Array) -> ClinicalJoint:
        """The joint, a hinge, with its angle about an oblique axis (3,)."""
        oblique = _place(axis.tolist())
        return replace(self, angles=tuple(replace(angle, oblique=oblique) for angle in self.angles))


def clinical_joints(entries: Iterable[TomlTable]) -> tuple[ClinicalJoint, ...]:
    """Every joint of a body file's tables, those with ``mirror = true`` on both sides.

    Raises:
        KeyError: An entry lacks a value.
        TypeError: An angle has a value it should not have.
        ValueError: Axes, signs and names of a joint contradict each other.
    """
    joints: list[ClinicalJoint] = []
    for entry in entries:
        joint = _joint(entry)
        joints += [joint, _left(joint)] if entry.get("mirror") else [joint]
    for joint in joints:
        _check(joint)
    names = [angle.name for joint in joints for angle in joint.coordinates]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"the coordinate {twice[0]} stands twice; give every angle a name of its own")
    return tuple(joints)


def opensim_zeros_rad(joints: Iterable[ClinicalJoint]) -> dict[str, float]:
    """Values of OpenSim's coordinates where ours are 0, rad, by name; without those that are 0, too."""
    return {
        angle.name: math.radians(angle.opensim_zero_deg)
        for joint in joints
        for angle in joint.angles
        if angle.opensim_zero_deg
    }


def positive_senses(joints: Iterable[ClinicalJoint]) -> dict[str, str]:
    """Meaning of a positive value by the name of the coordinate, where the body file states it."""
    return {angle.name: angle.positive for joint in joints for angle in joint.coordinates if angle.positive}


def _check(joint: ClinicalJoint) -> None:
    if "".join(angle.axis for angle in joint.angles) != joint.order:
        raise ValueError(f"joint {joint.name}: the angles' axes must follow its order {joint.order}")
    if len(joint.order) > 3 or len(set(joint.order)) != len(joint.order) or set(joint.order) - set("xyz"):
        raise ValueError(f"joint {joint.name}: order '{joint.order}' must hold different ones of x, y and z")
    if joint.main not in {angle.name for angle in joint.angles}:
        raise ValueError(f"joint {joint.name}: main angle {joint.main} is not among its angles")
    if joint.heading_sd_deg is not None and not joint.heading_sd_deg > 0:
        raise ValueError(f"joint {joint.name}: heading_sd_deg must be positive, not {joint.heading_sd_deg}")
    for angle in joint.coordinates:
        if not 0.0 <= angle.zero_sd_deg < LARGEST_ZERO_DEG:
            raise ValueError(
                f"joint {joint.name}: zero_sd_deg of {angle.name} is {angle.zero_sd_deg:g}; it lies between 0 and "
                f"{LARGEST_ZERO_DEG:g}"
            )
        if angle.sign not in (1, -1):
            raise ValueError(f"joint {joint.name}: sign of {angle.name} is 1 or -1, not {angle.sign}")


def _joint(entry: TomlTable) -> ClinicalJoint:
    return ClinicalJoint(
        name=entry["name"],
        proximal=entry["proximal"],
        distal=entry["distal"],
        order=entry["order"],
        main=entry["main"],
        angles=tuple(Angle(**angle) for angle in entry["angle"]),
        translations=tuple(Angle(**angle) for angle in entry.get("translation", ())),
        heading_sd_deg=entry.get("heading_sd_deg"),
        opensim_origin_m=_place(entry.get("opensim_origin_m")),
    )


def _place(numbers: Sequence[float] | None) -> tuple[float, float, float] | None:
    if numbers is None:
        return None
    x, y, z = (float(one) for one in numbers)
    return x, y, z


def _left(right: ClinicalJoint) -> ClinicalJoint:
    """The left joint: a mirror in y keeps the sense of rotations about y and reverses those about x and z."""
    angles = tuple(
        Angle(
            _left_name(angle.name),
            angle.axis,
            angle.sign if angle.axis == "y" else -angle.sign,
            angle.positive,
            _left_name(angle.opensim),
            angle.title,
            angle.zero_sd_deg,
            angle.opensim_zero_deg,
        )
        for angle in right.angles
    )
    return ClinicalJoint(
        _left_name(right.name),
        mirrored(right.proximal),
        mirrored(right.distal),
        right.order,
        _left_name(right.main),
        angles,
        (),
        right.heading_sd_deg,
    )


def _left_name(name: str) -> str:
    return name.removesuffix("_r") + "_l" if name else ""
