"""An OpenSim model with its side file as the text of a body's file.

The model states segments, joints, masses and inertias; its coordinates are the body's angles. The side file has the
model's name with ``.toml`` at its end and states what OpenSim has no place for, as that of a URDF file
(:mod:`mbkf.model.urdf_body`). Roles are found by OpenSim's common names where it states none.
"""

from __future__ import annotations

from pathlib import Path

from mbkf.conventions import TomlTable
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.osim import read_osim
from mbkf.io.toml import toml_text
from mbkf.model.osim_hinges import with_fixed_hinges
from mbkf.model.osim_tree import osim_root_angles, osim_tree, osim_zeros_deg
from mbkf.model.urdf_body import body_table, read_side, side_path
from mbkf.model.urdf_segments import urdf_segments

REQUIRED = ("reference_height_m", "sole")
"""Entries that every side file has."""

FEET, TOES = (("calcn_r", "calcn_l"), ("talus_r", "talus_l")), ("toes_r", "toes_l")
KNEES = (("femur_r", "tibia_r"), ("femur_l", "tibia_l"))
"""Names of OpenSim's common models; the heel is part of the talus where the joint between them is locked."""


def osim_body_text(path: Path) -> str:
    """The text of a body's file that an OpenSim model and its side file make.

    Raises:
        FileFormatError: One of the files is missing or cannot be one of a body; names the joint.
        UnknownName: The side file has an entry or names a segment that does not exist.
    """
    model = read_osim(path, markers_needed=False)
    try:
        side = read_side(path, REQUIRED, "OpenSim")
        model, approximations = with_fixed_hinges(model, side.pop("fitted_deg", {}))
        tree = osim_tree(model)
        naming = side.pop("names", {})
        found = urdf_segments(tree, naming)
    except (InvalidInput, ValueError) as error:
        raise FileFormatError(path, str(error)) from error
    names = [one["name"] for one in found.segments]
    if "roles" not in side:
        side["roles"] = _roles(names, path)
    root = osim_root_angles(model, names[0])
    if root is not None:
        found.clinical_joints[0] = root
    zeros = osim_zeros_deg(model)
    for joint in found.clinical_joints:
        for angle in joint["angle"]:
            if angle["name"] in zeros:
                angle["opensim_zero_deg"] = zeros[angle["name"]]
    side["approximation"] = [
        {"segment": naming.get(one.segment, one.segment), "rms_mm": 1e3 * one.rms_m, "text": one.text}
        for one in approximations
    ]
    title = f"{path.name} with {side_path(path).name}"
    return toml_text(title, body_table(str(side.pop("name", tree.name)), found, side, side_path(path)))


def _roles(names: list[str], path: Path) -> TomlTable:
    """Roles of segments by their names.

    Raises:
        FileFormatError: The feet are not found.
    """
    feet = next((list(pair) for pair in FEET if set(pair) <= set(names)), None)
    if feet is None:
        raise FileFormatError(
            side_path(path),
            f"lacks roles: no segments are named {' and '.join(FEET[0])}; state [roles] feet; segments are "
            f"{', '.join(names)}",
        )
    knees = [list(pair) for pair in KNEES if set(pair) <= set(names)]
    toes = list(TOES) if set(TOES) <= set(names) else []
    return {"feet": feet, **({"toes": toes} if toes else {}), **({"knees": knees} if knees else {})}
