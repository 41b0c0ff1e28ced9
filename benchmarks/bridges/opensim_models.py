"""OpenSim's own models as bodies of ours, against motions that these models make themselves.

The markers are where the model has them in its own motion, splines included; they are followed with a noise of 0.5 mm.
Torques are compared with those that come with the exact motion of subject01; accelerations are the filter's.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import mbkf
from benchmarks.checks import Check, information
from benchmarks.peers.opensim_model import GAIT, SCALED_WALK
from benchmarks.references import correlation
from mbkf.conventions import Array
from mbkf.io.axes import rotation_to_world
from mbkf.io.capture import read_capture
from mbkf.io.osim import OsimModel, read_osim
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.storage import Table, read_storage
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_forces
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.model.protocol import load_protocol
from mbkf.model.urdf_body import side_path

ANGLE_DEG, CORRELATION = 0.1, 0.999
PLACED_M, MOST_HZ = 5e-4, 100.0
LEGS = ("hip_", "knee_angle_", "ankle_", "subtalar_")
TRUTH = Path("synthetic_exact_truth")

SIDE = """reference_height_m = 1.80

[sole]
height_m = -0.03
heel_x_m = -0.03
ball_x_m = 0.17
toe_x_m = 0.24
inner_y_m = 0.04
outer_y_m = -0.05
"""


@dataclass(frozen=True)
class Made:
    """A model and a motion of its own.

    Attributes:
        model: Its file in the data.
        motion: Its coordinates, beside it or in the folder of the capture.
        markers, forces, torques: Files of the same motion with plates, where there are any; else "".
    """

    model: Path
    motion: Path
    markers: str = ""
    forces: str = ""
    torques: str = ""


MODELS = (
    Made(GAIT, GAIT.parent / "subject01_walk1_ik.mot"),
    Made(SCALED_WALK, SCALED_WALK.parent / "coordinates_rra.sto"),
    Made(
        TRUTH / "subject01_model.osim",
        TRUTH / "subject01_coordinates_TRUTH.sto",
        "subject01_walk2_markers.trc",
        "subject01_walk2_grf.mot",
        "subject01_id_TRUTH.sto",
    ),
)


def model_rows(data: Path, out: Path) -> Iterator[Check]:
    """Rows of the models that are there.

    Args:
        data: Folder of the reference captures.
        out: Folder for copies of the models with their side files.
    """
    for made in (one for one in MODELS if (data / one.model).is_file()):
        name, path = made.model.stem, out / made.model.name
        path.write_bytes((data / made.model).read_bytes())
        side_path(path).write_text(SIDE, encoding="utf-8")
        model, table = read_osim(path), read_storage(data / made.motion)
        q = _model_motion(model, table)
        capture = _made_capture(model, q, table) if not made.markers else None
        if capture is None:
            folder = data / TRUTH
            capture = read_capture(folder / made.markers, forces=folder / made.forces)
        subject = _scaled(path, capture)
        result = mbkf.reconstruct(capture, subject)
        yield from _angle_rows(name, model, table.times_s, q, result)
        for one in load_protocol(path).body.approximations:
            yield information(f"{name}: {one.text}", 1e3 * one.rms_m, "mm")
        if made.torques:
            yield _torque_row(name, read_storage(data / TRUTH / made.torques), result)


def _scaled(path: Path, capture: Capture) -> Subject:
    """The person of a model, whose markers are at the model's places."""
    protocol = load_protocol(path)
    markers = tuple(replace(one, placement_sd_m=PLACED_M, noise_m=PLACED_M) for one in protocol.markers)
    mass_kg = protocol.body.reference_mass_kg
    return mbkf.scale(
        None, [capture], mass_kg=mass_kg, body=path, protocol=replace(protocol, markers=markers)
    )


def _model_motion(model: OsimModel, table: Table) -> Array:
    """(T, C) coordinates of the model in a file of them; those that follow others do so."""
    kinematics = OsimKinematics(model)
    q = np.tile(kinematics.defaults, (len(table.times_s), 1))
    columns = {
        name.split("/")[-2] if name.endswith("/value") else name: k for k, name in enumerate(table.names)
    }
    for number, one in enumerate(model.coordinates):
        if one.name in columns:
            values = table.columns[:, columns[one.name]]
            q[:, number] = np.deg2rad(values) if one.rotational and table.in_degrees else values
    return kinematics.expanded(q[:, kinematics.free])[0]


def _made_capture(model: OsimModel, q: Array, table: Table) -> Capture:
    """The model's markers in its motion, without plates."""
    kinematics = OsimKinematics(model)
    rate_hz = 1.0 / float(np.median(np.diff(table.times_s)))
    step = max(1, round(rate_hz / MOST_HZ))
    bodies = np.array([kinematics.body(one.body) for one in model.markers])
    places = np.array([one.position_m for one in model.markers])
    at = kinematics.poses(q[::step]).points(bodies, places)[0] @ rotation_to_world("y").T
    names = tuple(one.name for one in model.markers)
    markers = MarkerTrajectories(names, at, rate_hz / step, float(table.times_s[0]))
    return Capture(model.name, markers)


def _angle_rows(
    name: str, model: OsimModel, times_s: Array, truth: Array, result: Reconstruction
) -> Iterator[Check]:
    """The worst angle of the legs, and of the knees."""
    body, rows = HumanModel.of(result.subject), result.tracked
    ours, names = osim_coordinates(body, result.q), ClinicalAngles(body).names
    apart = {}
    for number, one in enumerate(model.coordinates):
        if one.name in names and one.name.startswith(LEGS):
            true = np.interp(result.times_s, times_s, truth[:, number])
            apart[one.name] = float(np.sqrt(np.mean((ours[:, names.index(one.name)] - true)[rows] ** 2)))
    for which, some in (("legs", apart), ("knees", {k: v for k, v in apart.items() if "knee" in k})):
        worst = max(some, key=lambda one: some[one])
        yield Check(f"{name}: {which}, worst {worst}", float(np.rad2deg(some[worst])), ANGLE_DEG, "<=", "°")


def _torque_row(name: str, table: Table, result: Reconstruction) -> Check:
    """The least correlation of the legs' torques with OpenSim's."""
    body, rows = HumanModel.of(result.subject), result.tracked
    forces, names = osim_forces(body, result.q, result.tau), ClinicalAngles(body).names
    found = {}
    for number, one in enumerate(names):
        if one.startswith(LEGS) and f"{one}_moment" in table.names:
            theirs = np.interp(result.times_s, table.times_s, table.column(f"{one}_moment"))
            found[one] = correlation(forces[rows, number], theirs[rows])
    worst = min(found, key=lambda one: found[one])
    return Check(f"{name}: torques, worst {worst}", found[worst], CORRELATION, ">=")
