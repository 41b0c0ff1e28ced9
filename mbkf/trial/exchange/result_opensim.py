"""A reconstruction as a folder that OpenSim's tools run from: model, motion, external loads and set-ups.

The motion holds the values of the model's own coordinates (:func:`mbkf.model.osim.osim_coordinates`) in degrees and m,
so that each frame's posture is the result's. Loads act on the segment that bears them, at their centre of pressure,
with the moment about it; they are those of reactions.mot. OpenSim's inverse dynamics differentiates the coordinates by
a natural quintic spline, without a low-pass (-1): the result is smooth already. Its analyses get accelerations from
forward dynamics: a motor on every coordinate drives the model by the result's torques and residual, so that
accelerations and joint reactions are the result's.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.contacts import FEET
from mbkf.io.results import Reconstruction
from mbkf.io.results_opensim import REACTIONS_FILE, load_columns, opensim_table
from mbkf.io.storage import Table, write_storage
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import VERSION, osim_coordinates, osim_files, osim_forces, osim_name

MODEL, MOTION = "model.osim", "motion.mot"
LOADS_DATA, LOADS = "external_loads.mot", "ExternalLoads.xml"
ACTUATORS, CONTROLS = "actuators.xml", "controls.sto"
SETUP_ID, SETUP_ANALYZE = "setup_id.xml", "setup_analyze.xml"
TORQUES_OUT, ANALYSES_OUT = "inverse_dynamics.sto", "analyses"
"""Files and folders that OpenSim's tools write, in the folder."""

NAME = "mbkf"
"""Name of the tools, with which the files of analyses begin; the trial's may hold characters that OpenSim refuses."""


def write_result_opensim(r: Reconstruction, folder: str | Path) -> None:
    """Writes the folder: all of its files, or the earlier ones stay.

    Args:
        r: The result.
        folder: The folder, made where missing.

    Raises:
        InvalidInput: The body is followed, and the loads on it known, in fewer than two frames.
        UnknownName: The subject's body is unknown.
        FileFormatError: A file stands where a folder is needed.
        OSError: A file cannot be written.
    """
    model = HumanModel.of(r.subject)
    motion, loads = motion_table(r, model), _loads_table(r)
    span = _common(motion, loads)
    with replacing_folder(folder) as partial:
        for name, text in osim_files(model, r.subject.markers, MODEL).items():
            (partial / name).write_text(text, encoding="utf-8")
        write_storage(motion, partial / MOTION)
        write_storage(loads, partial / LOADS_DATA)
        write_storage(torque_table(r, model), partial / CONTROLS)
        for name, element in (
            (ACTUATORS, _actuators(motion.names)),
            (LOADS, _external_loads(r, model, loads)),
            (SETUP_ID, _inverse_dynamics(span)),
            (SETUP_ANALYZE, _analysis(span)),
        ):
            (partial / name).write_text(_document(element), encoding="utf-8")


def motion_table(r: Reconstruction, model: Body) -> Table:
    """The motion in the coordinates of the exported model, degrees and m, in frames in which the body is followed.

    Args:
        r: The result.
        model: Its body.
    """
    clinical, rows = ClinicalAngles(model), r.tracked & np.isfinite(r.q).all(axis=1)
    values = osim_coordinates(model, r.q[rows])
    values[:, clinical.rotational] = np.rad2deg(values[:, clinical.rotational])
    header = {"Trial": r.trial, "Software": f"mbkf {r.version}"}
    names = tuple(osim_name(name) for name in clinical.names)
    return Table(names, r.times_s[rows], values, True, "Coordinates", header)


def torque_table(r: Reconstruction, model: Body) -> Table:
    """The generalised forces conjugate to these coordinates, N m and N, in frames in which they are known.

    Args:
        r: The result.
        model: Its body.
    """
    rows = r.tracked & np.isfinite(r.q).all(axis=1) & np.isfinite(r.tau).all(axis=1)
    names = tuple(osim_name(name) for name in ClinicalAngles(model).names)
    return Table(names, r.times_s[rows], osim_forces(model, r.q[rows], r.tau[rows]), title="Torques")


def _loads_table(r: Reconstruction) -> Table:
    table = opensim_table(r, REACTIONS_FILE)
    names = tuple(name for part in _known_parts(r, table).values() for name in _columns(part))
    columns = table.columns[:, [table.names.index(name) for name in names]]
    return replace(table, names=names, columns=columns, title="External loads")


def _known_parts(r: Reconstruction, table: Table) -> dict[str, tuple[str, str, str]]:
    """Beginnings of the columns of each part whose load is known at any time."""
    return {
        part: begins for part, begins in load_columns(r).items() if set(_columns(begins)) <= set(table.names)
    }


def _columns(begins: tuple[str, str, str]) -> tuple[str, ...]:
    return tuple(f"{begin}{axis}" for begin in begins for axis in "xyz")


def _common(motion: Table, loads: Table) -> tuple[float, float]:
    """First and last time of the motion at which the loads are known, too."""
    known = motion.times_s
    if len(loads.times_s):
        known = known[(known >= loads.times_s[0]) & (known <= loads.times_s[-1])]
    if len(known) < 2 or not len(loads.names):
        raise InvalidInput(
            f"the body is followed in {len(motion.times_s)} frames and the loads on it are known in "
            f"{len(loads.times_s) if loads.names else 0}; OpenSim's tools need two frames with both: give force "
            "plates, or reconstruct by the dynamic filter"
        )
    return float(known[0]), float(known[-1])


def _external_loads(r: Reconstruction, model: Body, loads: Table) -> ET.Element:
    root = ET.Element("ExternalLoads", name=NAME)
    root.append(ET.Comment(_sources(r)))
    objects = ET.SubElement(root, "objects")
    for part, begins in _known_parts(r, loads).items():
        one = ET.SubElement(objects, "ExternalForce", name=part)
        _texts(
            one,
            applied_to_body=osim_name(load_segment(model, part)),
            force_expressed_in_body="ground",
            point_expressed_in_body="ground",
            force_identifier=begins[0],
            point_identifier=begins[1],
            torque_identifier=begins[2],
        )
    _texts(root, datafile=LOADS_DATA)
    return root


def load_segment(model: Body, part: str) -> str:
    """The segment of a part that bears load."""
    return model.roles.feet[FEET.index(part)] if part in FEET else model.description.bearings[part].segment


def _sources(r: Reconstruction) -> str:
    """How each load is known, and the forces that have no place here, as a comment."""
    lines = [f"{c.part}: {c.how} from {c.from_s:.3f} to {c.to_s:.3f} s" for c in r.contacts]
    lines += [
        f"unexplained, not applied: {one.force_n:.0f} N {one.direction} from {one.from_s:.3f} to {one.to_s:.3f} s"
        for one in r.unexplained
    ]
    return "\n".join(
        ["", *lines, "Forces without a place act on no body here: pelvis_t*_force bears them.", ""]
    )


def _inverse_dynamics(span: tuple[float, float]) -> ET.Element:
    root = ET.Element("InverseDynamicsTool", name=NAME)
    _texts(
        root,
        results_directory=".",
        model_file=MODEL,
        time_range=_times(span),
        forces_to_exclude="Muscles",
        external_loads_file=LOADS,
        coordinates_file=MOTION,
        lowpass_cutoff_frequency_for_coordinates="-1",
        output_gen_force_file=TORQUES_OUT,
    )
    return root


def _actuators(coordinates: tuple[str, ...]) -> ET.Element:
    """A motor of strength 1 on every coordinate, called after it: its control is its torque or force."""
    root = ET.Element("ForceSet", name=NAME)
    objects = ET.SubElement(root, "objects")
    for name in coordinates:
        motor = ET.SubElement(objects, "CoordinateActuator", name=name)
        _texts(motor, coordinate=name, optimal_force="1", min_control="-inf", max_control="inf")
    return root


def _analysis(span: tuple[float, float]) -> ET.Element:
    root = ET.Element("AnalyzeTool", name=NAME)
    _texts(
        root,
        model_file=MODEL,
        replace_force_set="false",
        force_set_files=ACTUATORS,
        results_directory=ANALYSES_OUT,
        initial_time=repr(span[0]),
        final_time=repr(span[1]),
        solve_for_equilibrium_for_auxiliary_states="false",
        external_loads_file=LOADS,
        coordinates_file=MOTION,
        lowpass_cutoff_frequency_for_coordinates="-1",
    )
    analyses = ET.SubElement(ET.SubElement(root, "AnalysisSet", name="Analyses"), "objects")
    _texts(ET.SubElement(analyses, "BodyKinematics", name="BodyKinematics"), on="true", in_degrees="false")
    reactions = ET.SubElement(analyses, "JointReaction", name="JointReaction")
    _texts(reactions, on="true", joint_names="ALL", apply_on_bodies="child", express_in_frame="ground")
    controls = ET.SubElement(root, "ControllerSet", name="Controllers")
    _texts(
        ET.SubElement(ET.SubElement(controls, "objects"), "ControlSetController", name="torques"),
        actuator_list="ALL",
        controls_file=CONTROLS,
    )
    return root


def _times(span: tuple[float, float]) -> str:
    return f"{span[0]!r} {span[1]!r}"


def _texts(parent: ET.Element, **texts: str) -> None:
    for tag, text in texts.items():
        ET.SubElement(parent, tag).text = text


def _document(element: ET.Element) -> str:
    root = ET.Element("OpenSimDocument", Version=VERSION)
    root.append(element)
    ET.indent(root)
    head = f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {MARK} -->\n'
    return head + ET.tostring(root, encoding="unicode") + "\n"
