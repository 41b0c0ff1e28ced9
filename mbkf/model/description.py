"""The reference body as data: segments, joints, inertias, landmarks, read from a file in ``models/``."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array, data_folder, read_only
from mbkf.errors import FileFormatError, UnknownName

JOINT_DOF = {"free": 6, "spherical": 3, "universal": 2, "hinge": 1}
"""Degrees of freedom of each kind of joint. Universal: about x, then y. Hinge: about y."""


@dataclass(frozen=True)
class Segment:
    """One rigid segment of the reference body, in its own frame (origin at its proximal joint).

    Attributes:
        name: Segment name, e.g. ``"right_thigh"``.
        parent: Proximal segment, ``"world"`` for the root.
        joint: Kind of its proximal joint, a key of :data:`JOINT_DOF`.
        origin_m: (3,) its proximal joint in the parent's frame, m.
        mass_kg: Reference mass.
        com_m: (3,) reference centre of mass, m.
        inertia_kg_m2: (3,) reference principal moments about the centre of mass, kg m².
        scale_matrix: (3, K) rows that turn the K independent factors into the x, y, z factors (Table 4.1).
        length_index: Which independent factor is the length factor k of eqs. 4.3 and 4.4.
        posture_sd_rad: (dof,) spread of the joint about the neutral standing posture, rad (0: no prior).
        acceleration_sd: (dof,) typical acceleration of each dof, m/s² or rad/s².
        movement_sd: (dof,) standard deviation of the acceleration of each dof over a movement, m/s² or rad/s².
        limits_rad: (dof, 2) least and greatest rotation about each axis; ±inf where there is no limit.
    """

    name: str
    parent: str
    joint: str
    origin_m: Array
    mass_kg: float
    com_m: Array
    inertia_kg_m2: Array
    scale_matrix: Array
    length_index: int
    posture_sd_rad: Array
    acceleration_sd: Array
    movement_sd: Array
    limits_rad: Array


@dataclass(frozen=True)
class Landmark:
    """A named point of a segment: reference ``position_m`` (3,) in the segment's frame."""

    name: str
    segment: str
    position_m: Array


@dataclass(frozen=True)
class Sole:
    """Rectangle under the right foot in its frame, m; the left one mirrors it in y."""

    height_m: float
    heel_x_m: float
    toe_x_m: float
    inner_y_m: float
    outer_y_m: float


@dataclass(frozen=True)
class BodyDescription:
    """The reference body: segments in depth-first order, scale factors, landmarks."""

    name: str
    reference_mass_kg: float
    reference_height_m: float
    scale_factors: tuple[str, ...]
    segments: tuple[Segment, ...]
    landmarks: dict[str, Landmark]
    sole: Sole

    def segment(self, name: str) -> Segment:
        """The segment of that name.

        Raises:
            UnknownName: There is none.
        """
        for segment in self.segments:
            if segment.name == name:
                return segment
        raise UnknownName("segment", name, [s.name for s in self.segments])

    def landmark(self, name: str) -> Landmark:
        """The landmark of that name (``right_``/``left_`` prefix for paired ones).

        Raises:
            UnknownName: There is none.
        """
        if name not in self.landmarks:
            raise UnknownName("landmark", name, self.landmarks)
        return self.landmarks[name]


def mirrored(name: str) -> str:
    """The other side's name of a ``right_``/``left_`` name; midline names stay."""
    if name.startswith("right_"):
        return "left_" + name.removeprefix("right_")
    if name.startswith("left_"):
        return "right_" + name.removeprefix("left_")
    return name


@cache
def load_body(name: str = "human18") -> BodyDescription:
    """Reads a reference body from ``models/``.

    Raises:
        UnknownName: There is no such body.
        FileFormatError: The file is not a valid body description.
    """
    path = data_folder("models") / f"{name}.toml"
    if not path.is_file():
        raise UnknownName("body", name, [p.stem for p in data_folder("models").glob("*.toml")])
    return _parse(path)


def _parse(path: Path) -> BodyDescription:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        factors = tuple(table["scale_factors"])
        segments = tuple(_segment(entry, factors) for entry in table["segment"])
        names = {segment.name for segment in segments}
        return BodyDescription(
            name=table["name"],
            reference_mass_kg=float(table["reference_mass_kg"]),
            reference_height_m=float(table["reference_height_m"]),
            scale_factors=factors,
            segments=segments,
            landmarks=_landmarks(table["landmark"], names),
            sole=Sole(**table["sole"]),
        )
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid body description ({error})") from error


def _segment(entry: dict[str, Any], factors: tuple[str, ...]) -> Segment:
    return Segment(
        name=entry["name"],
        parent=entry["parent"],
        joint=entry["joint"],
        origin_m=read_only(entry["origin_m"]),
        mass_kg=float(entry["mass_kg"]),
        com_m=read_only(entry["com_m"]),
        inertia_kg_m2=read_only(entry["inertia_kg_m2"]),
        scale_matrix=read_only(_scale_matrix(entry["scale"], factors)),
        length_index=factors.index(entry["length_factor"]),
        posture_sd_rad=read_only(np.deg2rad(entry["posture_sd_deg"])),
        acceleration_sd=read_only(entry["acceleration_sd"]),
        movement_sd=read_only(entry["movement_sd"]),
        limits_rad=_limits(entry),
    )


def _limits(entry: dict[str, Any]) -> Array:
    if "limits_deg" in entry:
        return read_only(np.deg2rad(entry["limits_deg"]))
    return read_only(np.tile([-np.inf, np.inf], (JOINT_DOF[entry["joint"]], 1)))


def _scale_matrix(names: list[str], factors: tuple[str, ...]) -> Array:
    rows = np.zeros((3, len(factors)))
    for axis, name in enumerate(names):
        if name != "mean":
            rows[axis, factors.index(name)] = 1.0
    for axis, name in enumerate(names):
        if name == "mean":
            others = [other for other in range(3) if other != axis]
            rows[axis] = rows[others].mean(axis=0)
    return rows


def _landmarks(entries: list[dict[str, Any]], segments: set[str]) -> dict[str, Landmark]:
    """Landmarks by full name: a paired segment's or an off-midline one exists on both sides."""
    found = {}
    for entry in entries:
        name, segment = entry["name"], entry["segment"]
        position = np.array(entry["position_m"], dtype=float)
        paired_segment = segment not in segments
        if not paired_segment and position[1] == 0.0:
            found[name] = Landmark(name, segment, read_only(position))
            continue
        for side, sign in (("right", 1.0), ("left", -1.0)):
            full = f"{side}_{name}"
            host = f"{side}_{segment}" if paired_segment else segment
            found[full] = Landmark(full, host, read_only(position * [1.0, sign, 1.0]))
    return found
