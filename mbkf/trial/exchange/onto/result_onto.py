"""A reconstruction as a folder for an OpenSim model of someone else: its motion, loads on its bodies, and set-ups.

Besides inverse dynamics there are set-ups for static optimisation and for joint reactions from its muscles' forces;
where the model has muscles, for computed muscle control and Moco as well.
Actuators beside the muscles keep both possible: at the root they are the residual, which loads and motion leave; at
the other coordinates they are reserves of 1 N m, so that each N m beyond costs as much as many muscles.
"""

from __future__ import annotations

import csv
import io
import re
from contextlib import suppress
from pathlib import Path

import numpy as np

from mbkf.errors import ProtectedFile
from mbkf.io.atomic import remove_file
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.loose_xml import xml_text
from mbkf.io.osim import read_osim
from mbkf.io.results import Reconstruction
from mbkf.io.storage import Table, write_storage
from mbkf.io.written import MARK
from mbkf.model.human import HumanModel
from mbkf.model.osim_kinematics import GROUND, OsimKinematics
from mbkf.trial.exchange.onto.fitting import OntoMotion, onto
from mbkf.trial.exchange.onto.muscle_setups import (
    SETUP_CMC,
    SETUP_MOCO,
    TASKS,
    cmc_tasks,
    moco_inverse,
    muscle_control,
)
from mbkf.trial.exchange.opensim_setups import (
    ACTUATORS,
    LOADS,
    LOADS_DATA,
    MODEL,
    MOTION,
    NAME,
    SETUP_ID,
    actuators,
    analysis,
    common_span,
    document,
    external_loads,
    inverse_dynamics,
    loads_table,
)
from mbkf.trial.exchange.result_opensim import load_segment

RESIDUALS = "residuals.csv"
SETUP_MUSCLES, MUSCLES_OUT = "setup_static_optimization.xml", "static_optimization"
SETUP_JOINTS, JOINTS_OUT = "setup_joint_reaction.xml", "joint_reaction"
"""Further files of the folder, and the folders that the tools write."""

RESERVE, RESIDUAL = "_reserve", "_residual"
"""Ends of the names of actuators."""

RESERVE_NM, RESIDUAL_N = 1.0, 100.0
"""Force or moment of an actuator at full control; the cost is the sum of squared controls."""

_OF_MUSCLES = frozenset((TASKS, SETUP_CMC, SETUP_MOCO))
"""Files of models with muscles."""

_DECLARATION = re.compile(r"\A\s*<\?xml\s.*?\?>", re.DOTALL)
_MUSCLE = re.compile(r"<\w+Muscle(_Deprecated)?\s+name=")
"""Start of a file that states its encoding, and of an element that is a muscle."""

_SPREADSHEET = ("segment", "body", "markers", "place_mm", "turn_deg")


def export_onto(r: Reconstruction, model: str | Path, folder: str | Path) -> OntoMotion:
    """Writes the folder: all of its files, or the earlier ones stay.

    Set-ups for muscles that mbkf wrote for another model are removed where this one has no muscles.

    Args:
        r: The result.
        model: File of the OpenSim model (.osim), of the person's size.
        folder: The folder, made where missing.

    Returns:
        The motion that was written, with the distances that remain.

    Raises:
        InvalidInput: The body is followed, and the loads on it known, in fewer than two frames; the model's bodies have
            unknown names, or its joints or constraints are of a kind that is not supported.
        UnknownName: The subject's body is unknown.
        FileFormatError: The model cannot be read, or a file stands where a folder is needed.
        OSError: A file cannot be written.
    """
    found, text = onto(r, read_osim(model, markers_needed=False)), xml_text(model)
    motion, loads = motion_table(r, found), loads_table(r)
    span = common_span(motion, loads)
    muscles = f"{MUSCLES_OUT}/{NAME}_StaticOptimization_force.sto"
    elements = {
        LOADS: external_loads(r, loads, _load_bodies(r, found)),
        ACTUATORS: actuators(_motors(found.kinematics)),
        SETUP_ID: inverse_dynamics(span),
        SETUP_MUSCLES: analysis(span, MUSCLES_OUT, {"StaticOptimization": {"use_model_force_set": "true"}}),
        SETUP_JOINTS: analysis(
            span, JOINTS_OUT, {"JointReaction": {"forces_file": muscles, "joint_names": "ALL"}}
        ),
    }
    if _MUSCLE.search(text):
        names = [found.kinematics.names[number] for number in found.kinematics.free]
        elements |= {
            TASKS: cmc_tasks(names),
            SETUP_CMC: muscle_control(span),
            SETUP_MOCO: moco_inverse(span, RESERVE_NM, RESIDUAL_N),
        }
    with replacing_folder(folder) as partial:
        (partial / MODEL).write_text(_marked(text), encoding="utf-8", newline="")
        write_storage(motion, partial / MOTION)
        write_storage(loads, partial / LOADS_DATA)
        (partial / RESIDUALS).write_text(_residuals(found), encoding="utf-8")
        for name, element in elements.items():
            (partial / name).write_text(document(element), encoding="utf-8")
    for name in _OF_MUSCLES - elements.keys():
        with suppress(ProtectedFile):
            remove_file(Path(folder) / name)
    return found


def motion_table(r: Reconstruction, found: OntoMotion) -> Table:
    """The motion as OpenSim writes it: angles in degrees, other coordinates in m, and those that couple both in rad.

    Args:
        r: The result.
        found: Its motion in the model's coordinates.
    """
    rotational = np.array([one.rotational for one in found.kinematics.model.coordinates])
    values = np.where(rotational, np.rad2deg(found.q), found.q)
    header = {
        "Trial": r.trial,
        "Software": f"mbkf {r.version}",
        "Model": found.kinematics.model.name,
        "Markers": str(len(found.markers)),
        "MarkersFromMeasuredMm": f"{found.to_measured_mm:.3f}",
        "MarkersFromReconstructedMm": f"{found.to_ours_mm:.3f}",
    }
    return Table(found.kinematics.names, r.times_s[found.rows], values, True, "Coordinates", header)


def _load_bodies(r: Reconstruction, found: OntoMotion) -> dict[str, str]:
    """Body of the model that a load acts on, by the part that bears it; parts without one are left out."""
    ours = HumanModel.of(r.subject)
    bodies = {one.pair.segment: one.pair.body for one in found.residuals}
    segments = {part: load_segment(ours, part) for part in r.loads.names}
    return {part: bodies[segment] for part, segment in segments.items() if segment in bodies}


def _motors(kinematics: OsimKinematics) -> dict[str, tuple[str, float]]:
    """Coordinate and force at full control of an actuator for every free coordinate, by its name."""
    root = {
        one.name for joint in kinematics.model.joints if joint.parent == GROUND for one in joint.coordinates
    }
    names = [kinematics.names[number] for number in kinematics.free]
    residuals = {name + RESIDUAL: (name, RESIDUAL_N) for name in names if name in root}
    return residuals | {name + RESERVE: (name, RESERVE_NM) for name in names if name not in root}


def _residuals(found: OntoMotion) -> str:
    """Distances of bodies from segments as a table (CSV)."""
    file = io.StringIO()
    file.write(f"# distances of the model's bodies from the segments, RMS; {MARK}\n")
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(_SPREADSHEET)
    for one in found.residuals:
        place, turn = f"{one.place_mm:.3f}", f"{one.turn_deg:.3f}"
        rows.writerow((one.pair.segment, one.pair.body, " ".join(one.pair.markers), place, turn))
    return file.getvalue()


def _marked(text: str) -> str:
    """The text of a model file in UTF-8, with the comment by which mbkf knows what it wrote."""
    content = _DECLARATION.sub("", text, count=1).lstrip()
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {MARK} -->\n{content}'
