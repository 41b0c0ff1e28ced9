"""OpenSim's models (.osim, of every version from 2 to 4) and marker sets (.xml): bodies, joints, markers, constraints.

With every coordinate at zero OpenSim's bodies stand upright with their axes parallel: x forward, y up, z to the right.
Format: OpenSim's documented model files (opensim.stanford.edu).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError
from mbkf.io.loose_xml import Element, read_loose_xml
from mbkf.io.osim_frames import body_frame, vector
from mbkf.io.osim_functions import OsimFunction, function_of, number_list
from mbkf.io.osim_joints import OsimCoordinate, OsimJoint, osim_joints

_NEVER_NESTED = frozenset({"Marker", "Body", "PhysicalOffsetFrame", "TransformAxis"})
_MARKER_BODIES = ("socket_parent_frame", "socket_parent_frame_connectee_name", "body")
_MOMENTS = ("inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz")


@dataclass(frozen=True)
class OsimBody:
    """A rigid body.

    Attributes:
        name: Its name.
        mass_kg: Its mass.
        centre_m: (3,) its centre of mass in its frame, m.
        inertia_kgm2: (3, 3) its inertia about that centre, along its frame's axes, kg m².
    """

    name: str
    mass_kg: float
    centre_m: Array
    inertia_kgm2: Array


@dataclass(frozen=True)
class OsimCoupler:
    """A constraint by which one coordinate follows another.

    Attributes:
        follower: The coordinate that follows.
        leader: The one that it follows.
        value: Its value as a function of the leader's.
    """

    follower: str
    leader: str
    value: OsimFunction


@dataclass(frozen=True)
class OsimMarker:
    """A marker.

    Attributes:
        name: Its name.
        body: The body that it is on, as the file calls it.
        position_m: (3,) where, in the body's frame, m.
        fixed: OpenSim leaves it there when it fits a model to a person; None where the file does not say.
    """

    name: str
    body: str
    position_m: Array
    fixed: bool | None


@dataclass(frozen=True)
class OsimModel:
    """A model, or a set of markers without one.

    Attributes:
        name: Its name.
        joints: Its joints in the order of the file; empty for a marker set.
        markers: Its markers.
        damaged: The reason by name of each marker that could not be read.
        bodies: Its bodies, without the ground.
        couplers: Its constraints between coordinates, those that are in force.
        other_constraints: Names and kinds of its other constraints in force.
    """

    name: str
    joints: tuple[OsimJoint, ...]
    markers: tuple[OsimMarker, ...]
    damaged: dict[str, str]
    bodies: tuple[OsimBody, ...] = ()
    couplers: tuple[OsimCoupler, ...] = ()
    other_constraints: tuple[str, ...] = ()

    @property
    def coordinates(self) -> tuple[OsimCoordinate, ...]:
        """The coordinates of its joints, in the order of the file."""
        return tuple(one for joint in self.joints for one in joint.coordinates)


def read_osim(path: str | Path, *, markers_needed: bool = True) -> OsimModel:
    """Reads a model, or a marker set that stands in a file of its own.

    Args:
        path: The file.
        markers_needed: Refuse a file without markers.

    Raises:
        FileFormatError: The file is missing, not one of OpenSim, or without markers.
    """
    path = Path(path)
    root = read_loose_xml(path, _NEVER_NESTED)
    _drop(root, "defaults")
    model = next(root.every("Model"), None)
    found = model or next(root.every("MarkerSet", "OpenSimDocument"), None)
    if found is None:
        raise FileFormatError(
            path, "not an OpenSim model or marker set; name an .osim file or a MarkerSet .xml"
        )
    frames = {one.name: one for one in root.every("PhysicalOffsetFrame") if one.name}
    markers: dict[str, OsimMarker] = {}
    damaged: dict[str, str] = {}
    for element in root.every("Marker"):
        _read_marker(element, frames, markers, damaged)
    if not markers and markers_needed:
        faults = "; ".join(f"{name}: {reason}" for name, reason in list(damaged.items())[:3])
        raise FileFormatError(
            path, f"holds no marker that can be read ({faults})" if faults else "holds no marker"
        )
    couplers, others = _constraints(root)
    return OsimModel(
        found.name or path.stem,
        tuple(osim_joints(root, frames)),
        tuple(markers.values()),
        damaged,
        tuple(_bodies(root)),
        couplers,
        others,
    )


def _drop(root: Element, tag: str) -> None:
    """Takes away all elements of a name: defaults are patterns of markers and joints, not ones of the model."""
    waiting = [root]
    while waiting:
        one = waiting.pop()
        one.children = [child for child in one.children if child.tag != tag]
        waiting.extend(one.children)


def _read_marker(
    element: Element,
    frames: dict[str, Element],
    markers: dict[str, OsimMarker],
    damaged: dict[str, str],
) -> None:
    """Puts a marker among those that could be read or those that could not."""
    name = " ".join(element.name.split())
    place = vector(element.child_text("location"))
    body, offset = body_frame(element.child_text(*_MARKER_BODIES), frames)
    if not name:
        damaged.setdefault("(no name)", "a marker without a name")
    elif name in markers:
        damaged[f"{name} (again)"] = "the name stands twice; the first is taken"
    elif place is None:
        damaged[name] = "its location is not three finite numbers"
    elif not body:
        damaged[name] = "it names no body"
    else:
        fixed = {"true": True, "1": True, "false": False, "0": False}.get(element.child_text("fixed").lower())
        on_body = offset[:3, :3] @ place + offset[:3, 3]
        markers[name] = OsimMarker(name, body, read_only(on_body), fixed)


def _bodies(root: Element) -> Iterator[OsimBody]:
    """The bodies but the ground; values that a file lacks are zero."""
    for element in root.every("Body"):
        if element.name in ("", "ground"):
            continue
        given = number_list(element.child_text("inertia"))
        if len(given) != len(_MOMENTS):
            given = [(number_list(element.child_text(name)) or [0.0])[0] for name in _MOMENTS]
        xx, yy, zz, xy, xz, yz = given
        centre = vector(element.child_text("mass_center"))
        yield OsimBody(
            element.name,
            (number_list(element.child_text("mass")) or [0.0])[0],
            read_only(np.zeros(3) if centre is None else centre),
            read_only(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])),
        )


def _constraints(root: Element) -> tuple[tuple[OsimCoupler, ...], tuple[str, ...]]:
    """Couplers in force, and names and kinds of the other constraints in force."""
    couplers, others = [], []
    for holder in (inner for group in root.every("ConstraintSet") for inner in group.every("objects")):
        for one in holder.children:
            off = one.child_text("isEnforced").lower() in ("false", "0")
            if off or one.child_text("isDisabled").lower() in ("true", "1"):
                continue
            coupler = _coupler(one)
            if coupler is None:
                others.append(f"{one.name} ({one.tag})")
            else:
                couplers.append(coupler)
    return tuple(couplers), tuple(others)


def _coupler(element: Element) -> OsimCoupler | None:
    """A constraint by which one coordinate follows a single other one; None for any other."""
    function = element.child("coupled_coordinates_function")
    leaders = element.child_text("independent_coordinate_names").split()
    follower = element.child_text("dependent_coordinate_name")
    value = None if function is None else function_of(function)
    if element.tag != "CoordinateCouplerConstraint" or value is None or len(leaders) != 1 or not follower:
        return None
    factor = number_list(element.child_text("scale_factor")) or [1.0]
    return OsimCoupler(follower, leaders[0], value.scaled(factor[0]))
