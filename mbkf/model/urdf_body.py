"""A URDF file with its side file as the text of a body's file.

The URDF file states segments, joints, masses and inertias, in SI units. The side file has the URDF file's name with
``.toml`` at its end. It states entries that URDF has no place for: roles and sole; spreads and scale factors of
segments, where they differ from :data:`SPREADS` and from one factor of size; and any other entry of a body's file.
"""

from __future__ import annotations

from pathlib import Path

from mbkf.conventions import TomlTable
from mbkf.errors import FileFormatError, MbkfError, UnknownName
from mbkf.io.known_keys import refuse_unknown
from mbkf.io.plain_data import parse_toml, plain_text
from mbkf.io.toml import toml_text
from mbkf.model.body_entries import KNOWN, REMARKS
from mbkf.model.description import JOINT_DOF
from mbkf.model.sides import mirrored
from mbkf.model.urdf_segments import UrdfSegments, urdf_segments
from mbkf.model.urdf_tree import read_urdf_tree

SIZE = "size"
"""Name of the only scale factor of a body whose side file names no factors."""

OVERRIDES = (
    "name",
    "scale",
    "length_factor",
    "posture_sd_deg",
    "acceleration_sd",
    "movement_sd",
    "limits_deg",
)
"""Entries of ``[[segment]]`` in a side file; the others stand in the URDF file."""

SPREADS: dict[str, dict[str, list[float]]] = {
    "free": {
        "posture_sd_deg": [0.0] * 6,
        "acceleration_sd": [15.0, 15.0, 15.0, 40.0, 40.0, 40.0],
        "movement_sd": [5.0, 5.0, 10.0, 15.0, 40.0, 15.0],
    },
    "": {"posture_sd_deg": [20.0], "acceleration_sd": [110.0], "movement_sd": [20.0]},
}
"""Spreads unless the side file states others: the root's of ``human18``, and medians of its joints for each axis."""

SIDE_KNOWN = {
    **KNOWN,
    "": (*(key for key in KNOWN[""] if key != "reference_mass_kg"), "names", "fitted_deg"),
    "segment": OVERRIDES,
}
"""Entries of a side file."""

REQUIRED = ("reference_height_m", "roles", "sole")
"""Entries that every side file has."""


def side_path(path: Path) -> Path:
    """The side file of a URDF file or OpenSim model."""
    return path.with_name(path.name + ".toml")


def urdf_body_text(path: Path) -> str:
    """The text of a body's file that a URDF file and its side file make.

    Raises:
        FileFormatError: One of the files is missing, or cannot be one of a body.
        UnknownName: The side file has an entry or names a segment that does not exist.
    """
    try:
        tree = read_urdf_tree(path)
        side = read_side(path)
        found = urdf_segments(tree, side.pop("names", {}))
    except MbkfError:
        raise
    except FileNotFoundError as error:
        raise FileFormatError(path, "no such file; give the path of a URDF file") from error
    except OSError as error:
        raise FileFormatError(path, f"cannot be read ({error.strerror or error})") from error
    except ValueError as error:
        raise FileFormatError(path, str(error)) from error
    name = side.pop("name", tree.name)
    return toml_text(
        f"{path.name} with {side_path(path).name}", body_table(str(name), found, side, side_path(path))
    )


def read_side(path: Path, required: tuple[str, ...] = REQUIRED, kind: str = "URDF") -> TomlTable:
    """The entries of a side file.

    Args:
        path: The file beside which it stands.
        required: Entries that it must have.
        kind: Format of that file, for messages.

    Raises:
        FileFormatError: It is missing or not TOML, or lacks an entry.
        UnknownName: It has an entry that does not exist.
    """
    side = side_path(path)
    try:
        text = plain_text(side)
        table = parse_toml(text)
    except FileNotFoundError as error:
        raise FileFormatError(
            path,
            f"it needs a side file {side.name} in its folder, with {', '.join(required)} (docs: Your own body, {kind})",
        ) from error
    except OSError as error:
        raise FileFormatError(side, f"cannot be read ({error.strerror or error})") from error
    except ValueError as error:
        raise FileFormatError(side, str(error)) from error
    refuse_unknown(table, SIDE_KNOWN, side, text, REMARKS)
    missing = [key for key in required if key not in table]
    if missing:
        raise FileFormatError(side, f"lacks {', '.join(missing)}")
    if not all(isinstance(table.get(key, {}), dict) for key in ("roles", "names", "fitted_deg")):
        raise FileFormatError(side, "roles, names and fitted_deg are tables: [roles], [names], [fitted_deg]")
    return table


def body_table(name: str, found: UrdfSegments, side: TomlTable, path: Path) -> TomlTable:
    """The whole table of the body's file.

    Args:
        name: The body's name.
        found: Segments, landmarks and angles of the file.
        side: Entries of the side file.
        path: The side file.

    Raises:
        UnknownName: The side file names a segment that does not exist.
    """
    factors = side.get("scale_factors", [SIZE])
    own = _by_name(side.pop("segment", []), [one["name"] for one in found.segments], path)
    segments = [
        {
            **_spreads(one["joint"]),
            "scale": [factors[0]] * 3,
            "length_factor": factors[0],
            **one,
            **own.get(one["name"], {}),
        }
        for one in found.segments
    ]
    stated = _stated(side.get("clinical_joint", []))
    joints = [one for one in found.clinical_joints if one["distal"] not in stated]
    return {
        **side,
        "name": name,
        "reference_mass_kg": sum(one["mass_kg"] for one in segments),
        "scale_factors": factors,
        "roles": {"root": segments[0]["name"], **side["roles"]},
        "segment": segments,
        "landmark": [*found.landmarks, *side.get("landmark", [])],
        "clinical_joint": [*joints, *side.get("clinical_joint", [])],
    }


def _by_name(entries: list[TomlTable], names: list[str], path: Path) -> dict[str, TomlTable]:
    for one in entries:
        if one.get("name") not in names:
            raise UnknownName("segment", str(one.get("name")), names, f"{path}, segment")
    return {one["name"]: one for one in entries}


def _stated(entries: list[TomlTable]) -> set[str]:
    """Distal segments of the side file's joints, mirrored ones too."""
    distals = [(str(one.get("distal")), one.get("mirror", False)) for one in entries]
    return {name for name, _ in distals} | {mirrored(name) for name, both in distals if both}


def _spreads(joint: str) -> dict[str, list[float]]:
    if joint in SPREADS:
        return SPREADS[joint]
    return {key: values * JOINT_DOF[joint] for key, values in SPREADS[""].items()}
