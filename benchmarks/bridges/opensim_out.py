"""Our body and our results in OpenSim: masses, places and generalised forces of its tools against ours.

Inverse dynamics needs the same accelerations in both: OpenSim differentiates the coordinates of motion.mot by a quintic
spline through its rows, and our own recursion gets the derivatives of the same spline. Beside it, for information,
stand the torques of the result itself, whose accelerations are the filter's estimates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.interpolate import make_interp_spline

import mbkf
from benchmarks.checks import Check, information, left_out
from benchmarks.dynamic.captures import load
from benchmarks.needs import installed
from benchmarks.peers.required import opensim, quiet
from benchmarks.references import correlation, rms
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.results import Reconstruction
from mbkf.io.results_opensim import PELVIS_PLACE
from mbkf.io.storage import read_storage
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_forces, osim_origin_m, to_osim_axes
from mbkf.trial.exchange.opensim_setups import MODEL, MOTION, NAME, SETUP_ID, TORQUES_OUT
from mbkf.trial.exchange.result_opensim import ANALYSES_OUT, SETUP_ANALYZE, load_segment
from mbkf.trial.export import export_result, export_subject

POSTURES, MASS, PLACE_M, MARKER_M = 50, 1e-9, 1e-6, 1e-4
CORRELATION, SHARE = 0.999, 0.01
STEP_S = 1e-5
LEAST_PEAK_NM = 1.0
"""Coordinates whose moment never exceeds this are left out of the rows; a share of nearly nothing says nothing."""

LEGS = ("hip_flexion", "knee_angle", "ankle_angle")

SQUAT = "flywheel_squat"
TRIALS = ("rajagopal walk", "rajagopal run", "biomechzoo HC032A", SQUAT)


def opensim_out_rows(data: Path, out: Path) -> Iterator[Check]:
    """Rows of all trials.

    Args:
        data: Folder of the reference captures.
        out: Folder for the exported files.
    """
    if not installed("opensim"):
        yield left_out("our body and results in OpenSim", "needs opensim: pip install '.[peers]'")
        return
    for name in TRIALS:
        result = reconstructed(name, data)
        folder = out / name.replace(" ", "_")
        yield from body_rows(name, result.subject, folder.with_suffix(".osim"))
        yield from result_rows(name, result, folder)


def reconstructed(name: str, data: Path) -> Reconstruction:
    """A trial by the dynamic filter, smoothed, with its person scaled as ``mbkf scale`` does."""
    if name != SQUAT:
        person = load(name, data)
        return mbkf.reconstruct(person.capture, person.subject)
    trial = read_capture(data / SQUAT / "S1_FlywheelSquat.c3d")
    subject = mbkf.scale(read_capture(data / SQUAT / "S1_StandingRef.c3d"), [trial], mass_kg=81.3)
    return mbkf.reconstruct(trial, subject)


def body_rows(name: str, subject: Subject, path: Path) -> Iterator[Check]:
    """Mass, and places of markers and segments at random postures within the joints' ranges.

    Args:
        name: Name of the rows.
        subject: The person.
        path: The model file to write.
    """
    export_subject(subject, "osim", path)
    model, rng = HumanModel.of(subject), np.random.default_rng(len(name))
    body, state = _opened(path)
    mass_kg, names = body.getTotalMass(state), ClinicalAngles(model).names
    yield Check(f"{name}: mass off", abs(mass_kg / model.mass_kg - 1.0), MASS, "<=")
    markers, segments = [], []
    for _ in range(POSTURES):
        q = model.integrate(model.neutral(), rng.uniform(-1.2, 1.2, model.nv))
        _pose(body, state, names, osim_coordinates(model, q[None])[0])
        markers += _markers_apart_m(body, state, model, subject, q)
        origins = model.placements(q)[1]
        for segment, joint in model.joints.items():
            found = body.getBodySet().get(segment).getPositionInGround(state)
            segments.append(_apart(found, origins[joint.joint_id]))
    yield Check(f"{name}: markers off, {POSTURES} postures", max(markers), PLACE_M, "<=", "m")
    yield Check(f"{name}: segments' origins off, {POSTURES} postures", max(segments), PLACE_M, "<=", "m")


def result_rows(name: str, result: Reconstruction, folder: Path) -> Iterator[Check]:
    """Markers of motion.mot, and torques of OpenSim's inverse dynamics, against ours.

    Args:
        name: Name of the rows.
        result: The result.
        folder: The folder to export to.
    """
    export_result(result, "opensim", folder)
    model = HumanModel.of(result.subject)
    yield Check(
        f"{name}: markers of motion.mot off", _marker_error_m(result, model, folder), MARKER_M, "<=", "m"
    )
    with quiet(), chdir(folder):
        opensim().InverseDynamicsTool(SETUP_ID).run()
    table = read_storage(folder / TORQUES_OUT)
    rows = np.searchsorted(result.times_s, table.times_s - 0.5 / result.rate_hz)
    theirs = {column.rpartition("_")[0]: table.column(column) for column in table.names}
    label = f"{name}: inverse dynamics"
    r, share = _agreement(theirs, spline_forces(result, model)[rows], ClinicalAngles(model).names)
    yield Check(f"{label}, same accelerations, least r", r, CORRELATION, ">=")
    yield Check(f"{label}, same accelerations, largest RMS of peak", share, SHARE, "<=")
    r, share = _agreement(
        theirs, osim_forces(model, result.q, result.tau)[rows], ClinicalAngles(model).names, LEGS
    )
    yield information(f"{label}, the filter's accelerations, legs' least r", r)
    yield information(f"{label}, the filter's accelerations, legs' largest RMS of peak", share)
    with quiet(), chdir(folder):
        opensim().AnalyzeTool(SETUP_ANALYZE).run()
    off, largest = _mass_centre_off(result, model, folder)
    yield Check(
        f"{name}: centre of mass accelerated by our torques in OpenSim, share off", off / largest, SHARE, "<="
    )


def _mass_centre_off(result: Reconstruction, model: HumanModel, folder: Path) -> tuple[float, float]:
    """Largest difference of the centre of mass's acceleration from the filter's, and its largest component, m/s²."""
    table = read_storage(folder / ANALYSES_OUT / f"{NAME}_BodyKinematics_acc_global.sto")
    theirs = np.column_stack([table.column(f"center_of_mass_{axis}") for axis in "XYZ"])
    rows = np.searchsorted(result.times_s, table.times_s - 0.5 / result.rate_hz)
    data, ours = model.pin_model.createData(), []
    for t in rows:
        pin.centerOfMass(model.pin_model, data, result.q[t], result.v[t], result.a[t])
        ours.append(to_osim_axes(data.acom[0]))
    return float(np.abs(theirs - ours).max()), float(np.abs(ours).max())


def _agreement(
    theirs: Mapping[str, Array], ours: Array, names: Sequence[str], only: tuple[str, ...] = ()
) -> tuple[float, float]:
    """Least r and largest RMS difference by the peak, of coordinates whose force exceeds :data:`LEAST_PEAK_NM`."""
    compared = [
        (theirs[name], column)
        for name, column in zip(names, ours.T, strict=True)
        if np.abs(column).max() > LEAST_PEAK_NM and (not only or name.startswith(only))
    ]
    r = min(correlation(a, b) for a, b in compared)
    return r, max(rms(a - b) / float(np.abs(b).max()) for a, b in compared)


def spline_forces(result: Reconstruction, model: HumanModel) -> Array:
    """(T, A) our inverse dynamics with the derivatives of the spline that OpenSim lays through motion.mot.

    OpenSim's GCV spline without smoothing is the natural quintic one (third and fourth derivatives 0 at the ends).
    With θ̇ = E v: v = E⁻¹ θ̇, a = E⁻¹ (θ̈ − Ė v), Ė by central differences along v.

    Args:
        result: The result, with every frame tracked.
        model: Its body.
    """
    ends = [(3, np.zeros(model.nv)), (4, np.zeros(model.nv))]
    coordinates = osim_coordinates(model, result.q)
    spline = make_interp_spline(result.times_s, coordinates, 5, bc_type=(ends, ends))
    rates, accelerations = spline(result.times_s, 1), spline(result.times_s, 2)
    angles = ClinicalAngles(model).angles(result.q)
    v = np.linalg.solve(_rate_matrices(model, result.q, angles), rates[..., None])[..., 0]
    beside = [
        _rate_matrices(
            model,
            np.array([model.integrate(q, h * one) for q, one in zip(result.q, v, strict=True)]),
            angles + h * rates,
        )
        for h in (STEP_S, -STEP_S)
    ]
    turning = np.einsum("tij,tj->ti", (beside[0] - beside[1]) / (2.0 * STEP_S), v)
    a = np.linalg.solve(_rate_matrices(model, result.q, angles), (accelerations - turning)[..., None])[..., 0]
    tau = np.array([_forces(result, model, t, v[t], a[t]) for t in range(result.frames)])
    return osim_forces(model, result.q, tau)


def _rate_matrices(model: HumanModel, q: Array, angles: Array) -> Array:
    """(T, A, nv) E of the exported coordinates: the root's place is that of OpenSim's origin d, ṗ = R (v + ω × d)."""
    clinical = ClinicalAngles(model)
    E = clinical.rate_matrices(q, angles)
    start = model.root.v.start
    moved = np.cross(np.eye(3), osim_origin_m(model))
    columns = [clinical.names.index(one.name) for one in clinical.joints[0].translations]
    linear = E[:, columns, start : start + 3]
    E[:, columns, start + 3 : start + 6] = linear @ moved.T
    return E


def _forces(result: Reconstruction, model: HumanModel, t: int, v: Array, a: Array) -> Array:
    """(nv,) generalised forces of a frame for given velocity and acceleration, with the result's loads."""
    q, loads = result.q[t], result.loads
    tau, J = model.inverse_dynamics(q, v, a), model.spatial_jacobian(q)
    for part, wrench in zip(loads.names, loads.wrench[t], strict=True):
        on = model.joint(load_segment(model, part)).joint_id
        tau = tau - np.where(model.supports[on], wrench @ J, 0.0)
    return tau


def _marker_error_m(result: Reconstruction, model: HumanModel, folder: Path) -> float:
    """Largest distance of a marker, posed by motion.mot in OpenSim, from its place on the body in the result's posture.

    A result's ``predicted_m`` differs where a marker sits elsewhere for a part of the trial.
    """
    table = read_storage(folder / MOTION)
    body, state = _opened(folder / MODEL)
    rows = np.searchsorted(result.times_s, table.times_s - 0.5 / result.rate_hz)
    angles = np.array([name not in PELVIS_PLACE for name in table.names])
    worst = 0.0
    for row, values in zip(rows, table.columns, strict=True):
        _pose(body, state, table.names, np.where(angles, np.deg2rad(values), values))
        worst = max(worst, *_markers_apart_m(body, state, model, result.subject, result.q[row]))
    return worst


def _opened(path: Path) -> tuple[Any, Any]:
    """A model of OpenSim and its state."""
    with quiet():
        body = opensim().Model(str(path))
        return body, body.initSystem()


def _markers_apart_m(body: Any, state: Any, model: HumanModel, subject: Subject, q: Array) -> list[float]:
    """Distances of OpenSim's markers from those on our body in a posture."""
    R, origins = model.placements(q)
    ids = [model.joint(one.segment).joint_id for one in subject.markers]
    return [
        _apart(
            body.getMarkerSet().get(one.name).getLocationInGround(state), origins[k] + R[k] @ one.position_m
        )
        for k, one in zip(ids, subject.markers, strict=True)
    ]


def _pose(body: Any, state: Any, names: tuple[str, ...], values: Array) -> None:
    for name, value in zip(names, values, strict=True):
        body.getCoordinateSet().get(name).setValue(state, float(value), False)
    body.realizePosition(state)


def _apart(found: Any, place_m: Array) -> float:
    """Distance of a place in OpenSim's axes from one in ours."""
    return float(np.linalg.norm([found.get(i) for i in range(3)] - to_osim_axes(place_m)))
