"""The table of clinical angles (``models/clinical_angles.toml``) as records, both sides written out."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mbkf.conventions import data_folder
from mbkf.errors import FileFormatError
from mbkf.model.description import mirrored


@dataclass(frozen=True)
class Angle:
    """One coordinate: ``sign`` times the rotation about (or position along) ``axis``.

    Attributes:
        name: Coordinate name, e.g. ``"hip_flexion_r"``.
        axis: "x", "y" or "z".
        sign: +1 or −1.
        positive: What a positive value means, in words.
        opensim: Coordinate of the Rajagopal model it compares with, "" where there is none.
    """

    name: str
    axis: str
    sign: int
    positive: str
    opensim: str


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
    """

    name: str
    proximal: str
    distal: str
    order: str
    main: str
    angles: tuple[Angle, ...]
    translations: tuple[Angle, ...]

    @property
    def coordinates(self) -> tuple[Angle, ...]:
        """Angles, then translations."""
        return self.angles + self.translations


@cache
def load_clinical_joints() -> tuple[ClinicalJoint, ...]:
    """Every joint of the table, paired ones on both sides.

    Raises:
        FileFormatError: The table is damaged.
    """
    return _parse(data_folder("models") / "clinical_angles.toml")


def _parse(path: Path) -> tuple[ClinicalJoint, ...]:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        joints: list[ClinicalJoint] = []
        for entry in table["joint"]:
            joint = _joint(entry)
            joints += [joint, _left(joint)] if entry.get("mirror") else [joint]
    except OSError as error:
        raise FileFormatError(path, f"cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a table of clinical angles ({error})") from error
    for joint in joints:
        if "".join(angle.axis for angle in joint.angles) != joint.order:
            raise FileFormatError(
                path, f"joint {joint.name}: the angles' axes must follow its order {joint.order}"
            )
        if joint.main not in {angle.name for angle in joint.angles}:
            raise FileFormatError(
                path, f"joint {joint.name}: main angle {joint.main} is not among its angles"
            )
    return tuple(joints)


def _joint(entry: dict[str, Any]) -> ClinicalJoint:
    return ClinicalJoint(
        name=entry["name"],
        proximal=entry["proximal"],
        distal=entry["distal"],
        order=entry["order"],
        main=entry["main"],
        angles=tuple(Angle(**angle) for angle in entry["angle"]),
        translations=tuple(Angle(**angle) for angle in entry.get("translation", ())),
    )


def _left(right: ClinicalJoint) -> ClinicalJoint:
    """The left joint: a mirror in y keeps the sense of rotations about y and reverses those about x and z."""
    angles = tuple(
        Angle(
            _left_name(angle.name),
            angle.axis,
            angle.sign if angle.axis == "y" else -angle.sign,
            angle.positive,
            _left_name(angle.opensim),
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
    )


def _left_name(name: str) -> str:
    return name.removesuffix("_r") + "_l" if name else ""
