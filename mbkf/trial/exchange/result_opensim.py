"""A reconstruction as a folder that OpenSim's tools run from: model, motion, external loads and set-ups.

The motion holds the values of the model's own coordinates (:func:`mbkf.model.osim.osim_coordinates`) in degrees and m,
so that each frame's posture is the result's. Loads act on the segment that bears them, at their centre of pressure,
with the moment about it; they are those of reactions.mot. OpenSim's inverse dynamics differentiates the coordinates by
a natural quintic spline, without a low-pass (-1): the result is smooth already. Its analyses get accelerations from
forward dynamics: a motor on every coordinate drives the model by the result's torques and residual, so that
accelerations and joint reactions are the result's.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.contacts import FEET
from mbkf.io.results import Reconstruction
from mbkf.io.storage import Table, write_storage
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_files, osim_forces, osim_name
from mbkf.trial.exchange.opensim_setups import (
    ACTUATORS,
    LOADS,
    LOADS_DATA,
    MODEL,
    MOTION,
    SETUP_ID,
    actuators,
    analysis,
    common_span,
    document,
    external_loads,
    inverse_dynamics,
    loads_table,
)
from mbkf.trial.exchange.result_orientations import orientations_text

SETUP_ANALYZE, ANALYSES_OUT = "setup_analyze.xml", "analyses"
CONTROLS, ORIENTATIONS = "controls.sto", "orientations.sto"
"""File of the analysis, the folder that it writes, the torques that drive the model, and the segments' orientations."""

ANALYSES = {
    "BodyKinematics": {"in_degrees": "false"},
    "JointReaction": {"joint_names": "ALL", "apply_on_bodies": "child", "express_in_frame": "ground"},
}
"""Settings of the analyses by their class."""


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
    motion, loads = motion_table(r, model), loads_table(r)
    bodies = {part: osim_name(load_segment(model, part)) for part in r.loads.names}
    span = common_span(motion, loads)
    with replacing_folder(folder) as partial:
        for name, text in osim_files(model, r.subject.markers, MODEL).items():
            (partial / name).write_text(text, encoding="utf-8")
        write_storage(motion, partial / MOTION)
        write_storage(loads, partial / LOADS_DATA)
        write_storage(torque_table(r, model), partial / CONTROLS)
        (partial / ORIENTATIONS).write_text(orientations_text(r, model), encoding="utf-8")
        for name, element in (
            (ACTUATORS, actuators({name: (name, 1.0) for name in motion.names})),
            (LOADS, external_loads(r, loads, bodies)),
            (SETUP_ID, inverse_dynamics(span)),
            (SETUP_ANALYZE, analysis(span, ANALYSES_OUT, ANALYSES, CONTROLS)),
        ):
            (partial / name).write_text(document(element), encoding="utf-8")


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


def load_segment(model: Body, part: str) -> str:
    """The segment of a part that bears load."""
    return model.roles.feet[FEET.index(part)] if part in FEET else model.description.bearings[part].segment
