"""Reference bodies from files: those that come with mbkf, and a user's own.

A body file is TOML; ``models/human18.toml`` shows every entry: segments and joints, inertias, scale factors,
landmarks, the sole, roles, clinical coordinates, shapes, skin, levels of the spine.

The masses of the segments sum to the reference person's: Newton's law for the whole body relates the ground reactions
to the movement of all of its mass. A body of the legs alone therefore carries head, arms and trunk as part of its
pelvis.
"""

from __future__ import annotations

from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array, data_folder, read_only
from mbkf.errors import FileFormatError, MbkfError, UnknownName
from mbkf.io.known_keys import refuse_unknown
from mbkf.io.plain_data import parse_toml, plain_text
from mbkf.model.body_checks import check_body
from mbkf.model.body_entries import KNOWN, OPTIONAL, REMARKS, SEGMENT_KEYS
from mbkf.model.clinical_table import ClinicalJoint, clinical_joints
from mbkf.model.description import (
    JOINT_DOF,
    Approximation,
    Bearing,
    BodyDescription,
    Landmark,
    Roles,
    Segment,
    SegmentShape,
    Sole,
)
from mbkf.model.sides import mirrored
from mbkf.model.spread_tables import joint_centres, segment_skin, shoulder_girdle
from mbkf.model.trunk_levels import trunk_levels

AXES_BY_JOINT = {"free": "", "spherical": "", "universal": "xy", "hinge": "y"}
"""Axes of each kind of joint where the file gives none."""


def load_body(body: str | Path = "human18") -> BodyDescription:
    """Reads a reference body by its name, or a user's own from a TOML or URDF file or an OpenSim model.

    A URDF file or an OpenSim model states segments, joints and inertias; soles and all other entries stand in a side
    file of the same name with ``.toml`` at its end (``robot.urdf.toml``, ``leg.osim.toml``).

    Args:
        body: Name of a body that comes with mbkf, or path of a file (ending in ``.toml``, ``.urdf`` or ``.osim``).

    Raises:
        UnknownName: The body does not exist, or the file names a segment, a landmark, a scale factor or a kind of joint
            that does not exist.
        FileFormatError: The file or its side file is missing or not a valid body description.
    """
    path = Path(body)
    suffix = path.suffix.lower()
    if suffix in (".osim", ".urdf"):
        return _of_model(path, suffix)
    if suffix == ".toml":
        try:
            text = plain_text(path)
        except (OSError, ValueError) as error:
            raise FileFormatError(
                path, f"cannot be read ({error}); give the name of a body or the path of a body file"
            ) from error
        return parse_body(text, path)
    return _shipped(str(body))


def _of_model(path: Path, suffix: str) -> BodyDescription:
    """The body of an OpenSim model or a URDF file; readers of XML are loaded for these alone."""
    from mbkf.model.urdf_body import side_path, urdf_body_text

    if suffix == ".osim":
        from mbkf.model.osim_body import osim_body_text

        return parse_body(osim_body_text(path), f"{path} with {side_path(path).name}")
    return parse_body(urdf_body_text(path), f"{path} with {side_path(path).name}")


@cache
def _shipped(name: str) -> BodyDescription:
    path = data_folder("models") / f"{name}.toml"
    if not path.is_file():
        names = [p.stem for p in data_folder("models").glob("*.toml")]
        raise UnknownName(
            "body", name, names, "give your own body by its file, ending in .toml, .urdf or .osim"
        )
    return _parse(path.read_text(encoding="utf-8"), path, "")


@lru_cache(maxsize=8)
def parse_body(text: str, path: str | Path) -> BodyDescription:
    """A reference body from the text of a body file.

    Args:
        text: The file's contents.
        path: Their source, for error messages.

    Raises:
        UnknownName: As for :func:`load_body`.
        FileFormatError: The text is not a valid body description.
    """
    return _parse(text, Path(path), text)


def _parse(text: str, path: Path, kept: str) -> BodyDescription:
    try:
        table = parse_toml(text)
        refuse_unknown(table, KNOWN, path, text, REMARKS)
        body = _body(table, path, kept)
        check_body(body)
    except MbkfError:
        raise
    except KeyError as error:
        raise FileFormatError(path, f"not a valid body description: it lacks {error}") from error
    except (AttributeError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid body description: {error}") from error
    return body


def _body(table: dict[str, Any], path: Path, kept: str) -> BodyDescription:
    factors = tuple(table["scale_factors"])
    segments = tuple(_segment(entry, factors, path) for entry in table["segment"])
    names = [segment.name for segment in segments]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise FileFormatError(path, f"two segments are named {twice[0]}; give every segment its own name")
    return BodyDescription(
        name=table["name"],
        reference_mass_kg=float(table["reference_mass_kg"]),
        reference_height_m=float(table["reference_height_m"]),
        scale_factors=factors,
        split_factors=_split_factors(table, factors, path),
        segments=segments,
        landmarks=_landmarks(table.get("landmark", []), segments, path),
        roles=_roles(table, segments, path),
        clinical_joints=_clinical(table["clinical_joint"], segments, path),
        shapes=_shapes(table.get("shape", []), segments, path),
        bearings=_bearings(table.get("bearing", []), segments, path),
        joint_centres=joint_centres(table.get("joint_centre", []), names, path),
        skin=segment_skin(table.get("skin", []), names, path),
        levels=trunk_levels(table.get("level", []), segments, path),
        approximations=_approximations(table.get("approximation", []), segments, path),
        girdle=shoulder_girdle(table.get("girdle", []), segments, path),
        text=kept,
    )


def _split_factors(table: dict[str, Any], factors: tuple[str, ...], path: Path) -> dict[str, str]:
    found = dict(table.get("split_factors", {}))
    for name in (*found, *found.values()):
        if name not in factors:
            raise UnknownName("scale factor", name, factors, f"{path}, split_factors")
    return found


def _segment(entry: dict[str, Any], factors: tuple[str, ...], path: Path) -> Segment:
    where = f"{path}, segment {entry.get('name', '?')}"
    missing = [key for key in SEGMENT_KEYS if key not in entry and key not in OPTIONAL]
    if missing:
        raise FileFormatError(path, f"segment {entry.get('name', '?')}: lacks {', '.join(missing)}")
    if entry["joint"] not in JOINT_DOF:
        raise UnknownName("joint", entry["joint"], JOINT_DOF, where)
    for name in (entry["length_factor"], *(name for name in entry["scale"] if name != "mean")):
        if name not in factors:
            raise UnknownName("scale factor", name, factors, where)
    try:
        return Segment(
            name=entry["name"],
            parent=entry["parent"],
            joint=entry["joint"],
            axes=entry.get("axes", AXES_BY_JOINT[entry["joint"]]),
            origin_m=read_only(entry["origin_m"]),
            mass_kg=float(entry["mass_kg"]),
            com_m=read_only(entry["com_m"]),
            inertia_kg_m2=read_only(entry["inertia_kg_m2"]),
            products_kg_m2=read_only(entry.get("products_kg_m2", [0.0, 0.0, 0.0])),
            scale_matrix=read_only(_scale_matrix(entry["scale"], factors)),
            length_index=factors.index(entry["length_factor"]),
            posture_sd_rad=read_only(np.deg2rad(entry["posture_sd_deg"])),
            acceleration_sd=read_only(entry["acceleration_sd"]),
            movement_sd=read_only(entry["movement_sd"]),
            limits_rad=_limits(entry),
            axis=_axis(entry["axis"]) if "axis" in entry else None,
        )
    except (TypeError, ValueError) as error:
        raise FileFormatError(path, f"segment {entry['name']}: {error}") from error


def _axis(entry: list[float]) -> Array:
    axis = read_only(entry)
    if axis.shape != (3,):
        raise ValueError(f"axis needs three numbers, not {entry}")
    return axis


def _limits(entry: dict[str, Any]) -> Array:
    if "limits_deg" in entry:
        return read_only(np.deg2rad(entry["limits_deg"]))
    return read_only(np.tile([-np.inf, np.inf], (JOINT_DOF[entry["joint"]], 1)))


def _scale_matrix(names: list[str], factors: tuple[str, ...]) -> Array:
    if len(names) != 3 or set(names) == {"mean"}:
        raise ValueError(
            "scale needs the names of three factors, for x, y and z; 'mean' is the mean of the other axes"
        )
    rows = np.zeros((3, len(factors)))
    for axis, name in enumerate(names):
        if name != "mean":
            rows[axis, factors.index(name)] = 1.0
    for axis, name in enumerate(names):
        if name == "mean":
            others = [other for other in range(3) if other != axis]
            rows[axis] = rows[others].mean(axis=0)
    return rows


def _known(name: str, segments: tuple[Segment, ...], where: str) -> str:
    names = [segment.name for segment in segments]
    if name not in names:
        raise UnknownName("segment", name, names, where)
    return name


def _landmarks(
    entries: list[dict[str, Any]], segments: tuple[Segment, ...], path: Path
) -> dict[str, Landmark]:
    """Landmarks by full name: one of a paired segment or off the midline is on both sides, but with mirror = false."""
    names = {segment.name for segment in segments}
    found = {}
    for entry in entries:
        name, segment = entry["name"], entry["segment"]
        position = np.array(entry["position_m"], dtype=float)
        if position.shape != (3,) or not np.isfinite(position).all():
            raise FileFormatError(path, f"landmark {name}: position_m needs three finite numbers")
        if segment in names and (position[1] == 0.0 or not entry.get("mirror", True)):
            found[name] = Landmark(name, segment, read_only(position))
            continue
        for side, sign in (("right", 1.0), ("left", -1.0)):
            full = f"{side}_{name}"
            host = segment if segment in names else f"{side}_{segment}"
            _known(host, segments, f"{path}, landmark {name}")
            found[full] = Landmark(full, host, read_only(position * [1.0, sign, 1.0]))
    return found


def _roles(table: dict[str, Any], segments: tuple[Segment, ...], path: Path) -> Roles:
    roles, where = table["roles"], f"{path}, roles"

    def several(key: str, otherwise: list[str]) -> tuple[str, ...]:
        return tuple(_known(name, segments, f"{where}, {key}") for name in roles.get(key, otherwise))

    feet = several("feet", [])
    if len(set(feet)) != 2:
        raise FileFormatError(
            path, f"roles: feet must name two segments, the right one first, not {list(feet)}; ground reactions act on "
            "them"
        )  # fmt: skip
    toes = several("toes", [])
    root = _known(roles["root"], segments, f"{where}, root")
    parents = {segment.name: segment.parent for segment in segments}
    if [parents[name] for name in toes] not in ([], list(feet)):
        raise FileFormatError(
            path, f"roles: toes {list(toes)} must be children of the feet {list(feet)}; else leave them out"
        )
    both = [name for foot in feet for name in reversed(_chain(foot, parents)) if name != root]
    legs = list(dict.fromkeys(both))
    knees = tuple(tuple(pair) for pair in roles.get("knees", ()))
    for pair in knees:
        if len(pair) != 2 or parents[_known(pair[1], segments, f"{where}, knees")] != pair[0]:
            raise FileFormatError(path, f"roles: knees needs pairs of thigh and shank, not {list(pair)}")
    return Roles(
        root=root,
        feet=(feet[0], feet[1]),
        toes=toes,
        soles=_soles(table["sole"], table.get("left_sole"), feet, toes, segments),
        legs=tuple(legs),
        leading=several("leading", legs),
        steady=several("steady", [root, *feet, *toes]),
        knees=knees,
    )


def _chain(segment: str, parents: dict[str, str]) -> list[str]:
    """A segment and those before it, up to the root."""
    chain = []
    while segment in parents and segment not in chain:
        chain.append(segment)
        segment = parents[segment]
    return chain


def _soles(
    entry: dict[str, Any],
    left_entry: dict[str, Any] | None,
    feet: tuple[str, ...],
    toes: tuple[str, ...],
    segments: tuple[Segment, ...],
) -> tuple[Sole, Sole]:
    bends = [next(segment for segment in segments if segment.name == one).origin_m[0] for one in toes]
    right, left = (
        {key: float(value) for key, value in {**({"ball_x_m": bends[k]} if bends else {}), **one}.items()}
        for k, one in enumerate((entry, left_entry or entry))
    )
    if left_entry is None:
        left = {**right, "inner_y_m": -right["inner_y_m"], "outer_y_m": -right["outer_y_m"]}
    return Sole(feet[0], **right), Sole(feet[1], **left)


def _clinical(
    entries: list[dict[str, Any]], segments: tuple[Segment, ...], path: Path
) -> tuple[ClinicalJoint, ...]:
    """The clinical joints in the order of the segments."""
    try:
        found = {joint.distal: joint for joint in clinical_joints(entries)}
    except KeyError as error:
        raise FileFormatError(path, f"a clinical joint lacks {error}") from error
    except (TypeError, ValueError) as error:
        raise FileFormatError(path, f"clinical joints: {error}") from error
    for joint in found.values():
        _known(joint.distal, segments, f"{path}, clinical joint {joint.name}")
    missing = [segment.name for segment in segments if segment.name not in found]
    if missing:
        raise FileFormatError(path, f"no clinical joint has the distal segment {', '.join(missing)}")
    return tuple(found[one.name] if one.axis is None else found[one.name].about(one.axis) for one in segments)


def _shapes(
    entries: list[dict[str, Any]], segments: tuple[Segment, ...], path: Path
) -> dict[str, SegmentShape]:
    """Shapes by segment; the shape of a right segment also serves the left one, where that exists."""
    names = {segment.name for segment in segments}
    found: dict[str, SegmentShape] = {}
    for entry in entries:
        segment = _known(entry["segment"], segments, f"{path}, shape")
        numbers = read_only(np.ravel(entry.get("numbers", [])))
        to = entry.get("to", "")
        found[segment] = SegmentShape(segment, entry["kind"], numbers, to)
        other = mirrored(segment)
        if other in names:
            found.setdefault(other, SegmentShape(other, entry["kind"], numbers, mirrored(to)))
    return found


def _bearings(entries: list[dict[str, Any]], segments: tuple[Segment, ...], path: Path) -> dict[str, Bearing]:
    """Parts that may bear load; the part of a right segment is mirrored to the left one, where that exists."""
    names = {segment.name for segment in segments}
    found: dict[str, Bearing] = {}
    for entry in entries:
        name, where = entry["name"], f"{path}, bearing {entry['name']}"
        segment, place = _known(entry["segment"], segments, where), np.array(entry["position_m"], dtype=float)
        size = (float(entry["radius_m"]), float(entry["lever_m"]))
        if place.shape != (3,) or not np.isfinite(place).all() or min(size) <= 0.0:
            raise FileFormatError(
                path,
                f"bearing {name}: position_m needs three finite numbers, radius_m and lever_m are positive",
            )
        found[name] = Bearing(name, segment, read_only(place), *size)
        other = mirrored(segment)
        if other in names and other != segment:
            place = place * [1.0, -1.0, 1.0]
            found.setdefault(mirrored(name), Bearing(mirrored(name), other, read_only(place), *size))
    return found


def _approximations(
    entries: list[dict[str, Any]], segments: tuple[Segment, ...], path: Path
) -> tuple[Approximation, ...]:
    """Joints that another program's model has in another form."""
    return tuple(
        Approximation(
            _known(one["segment"], segments, f"{path}, approximation"),
            1e-3 * float(one["rms_mm"]),
            str(one["text"]),
        )
        for one in entries
    )
