"""Our results on scaled OpenSim models of the same persons: markers, angles, and muscles that bear the torques.

The model's own best fit to the measured markers, all weighing alike, is the yardstick: no pose of the model lies nearer
to them. Beside it stand the poses that come with the captures: gait2354's by OpenSim's inverse kinematics, Rajagopal's
changed by its residual reduction. The capture holds no weights of gait2354's; weights of 20 (pelvis), 10 (heels,
tips of toes), 1, 0.5 (shoulders) and 0.1 (head), fitted to these poses, give them with subtalar and toe joints held at
0: within 1° RMS of each leg's coordinate.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import chdir
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from benchmarks.bridges.joint_forces import joint_force_rows
from benchmarks.bridges.opensim_out import reconstructed
from benchmarks.checks import Check, information, left_out
from benchmarks.needs import installed
from benchmarks.peers.opensim_model import GAIT, SCALED_WALK, write_model
from benchmarks.peers.required import opensim, quiet
from benchmarks.peers.shared import GAIT2354, RUN, WALK
from mbkf.conventions import Array
from mbkf.io.axes import rotation_to_world
from mbkf.io.results import Reconstruction
from mbkf.io.storage import Table, read_storage
from mbkf.model.osim_fit import Targets, fit
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.trial.exchange.onto.fitting import OntoMotion
from mbkf.trial.exchange.onto.pairs import shared_markers
from mbkf.trial.exchange.onto.result_onto import (
    MUSCLES_OUT,
    RESERVE,
    SETUP_JOINTS,
    SETUP_MUSCLES,
    export_onto,
)
from mbkf.trial.exchange.opensim_setups import NAME, SETUP_ID, TORQUES_OUT

FACTOR, ANGLE_DEG, RESERVE_SHARE = 1.2, 2.0, 0.05
QUICK_S = 0.2
FLEXIONS = tuple(f"{name}_{side}" for name in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")
TURNS = tuple(f"{name}_{side}" for name in ("hip_adduction", "hip_rotation") for side in "rl")
LEGS = (*FLEXIONS, *TURNS)


@dataclass(frozen=True)
class OntoCase:
    """A capture and a model of its person.

    Attributes:
        model: The model below the folder of captures; None where OpenSim scales it.
        poses: The model's coordinates that come with the capture; None where there are none.
        muscles: The model has muscles.
    """

    model: Path | None
    poses: Path | None
    muscles: bool


CASES = {
    GAIT2354: OntoCase(GAIT, Path("gait2354_walk") / "reference" / "subject01_walk1_ik.mot", True),
    WALK: OntoCase(SCALED_WALK, SCALED_WALK.with_name("coordinates_rra.sto"), True),
    RUN: OntoCase(None, None, False),
}


def opensim_onto_rows(data: Path, out: Path, quick: bool) -> Iterator[Check]:
    """Rows of all captures.

    Args:
        data: Folder of the reference captures.
        out: Folder for the exported files.
        quick: Static optimisation in the first 0.2 s only.
    """
    for name, case in CASES.items():
        if case.model is None and not installed("opensim"):
            yield left_out(f"{name} onto its model", "needs opensim: pip install '.[peers]'")
            continue
        result, folder = reconstructed(name, data), out / f"{name.replace(' ', '_')}_onto"
        model = data / case.model if case.model else write_model(name, data, out)
        found = export_onto(result, model, folder)
        yield from pose_rows(name, result, found)
        if case.poses is not None:
            yield from given_rows(name, read_storage(data / case.poses), result, found)
        if case.muscles and not installed("opensim"):
            yield left_out(f"{name}: muscles", "needs opensim: pip install '.[peers]'")
        elif case.muscles:
            yield from muscle_rows(name, folder, quick)
            yield from joint_force_rows(name, folder)


def pose_rows(name: str, result: Reconstruction, found: OntoMotion) -> Iterator[Check]:
    """Distances of markers and angles from those of the model's best fit to the measured markers.

    Args:
        name: Name of the rows.
        result: The result.
        found: Its motion in the model's coordinates.
    """
    targets = measured(result, found)
    best = fit(found.kinematics, targets, result.rate_hz)
    least = rms_mm(found.kinematics, targets, best)
    yield information(f"{name}: markers from the measured ones", found.to_measured_mm, "mm")
    yield Check(
        f"{name}: by the least distance that the model allows", found.to_measured_mm / least, FACTOR, "<="
    )
    worst, where = worst_angle(found.kinematics.names, found.q, best)
    yield Check(f"{name}: {where}, from that pose after offset", worst, ANGLE_DEG, "<=", "°")


def given_rows(name: str, table: Table, result: Reconstruction, found: OntoMotion) -> Iterator[Check]:
    """Distances from the poses that come with the capture.

    Args:
        name: Name of the rows.
        table: These poses.
        result: The result.
        found: Its motion in the model's coordinates.
    """
    kinematics, times = found.kinematics, result.times_s[found.rows]
    inside = (times >= table.times_s[0]) & (times <= table.times_s[-1])
    q = found.q[inside].copy()
    for column, values in zip(table.names, table.columns.T, strict=True):
        parts = column.split("/")
        coordinate = parts[-2] if parts[-1] == "value" and len(parts) > 1 else parts[-1]
        if coordinate in kinematics.names:
            number = kinematics.names.index(coordinate)
            degrees = table.in_degrees and kinematics.model.coordinates[number].rotational
            q[:, number] = np.interp(times[inside], table.times_s, np.deg2rad(values) if degrees else values)
    q = kinematics.expanded(q[:, kinematics.free])[0]
    targets = measured(result, found)
    targets = replace(targets, at_m=targets.at_m[inside])
    theirs = rms_mm(kinematics, targets, q)
    yield information(f"{name}: the capture's own poses from the measured markers", theirs, "mm")
    yield Check(f"{name}: by the capture's own poses", found.to_measured_mm / theirs, FACTOR, "<=")
    for coordinates in (FLEXIONS, TURNS):
        worst, where = worst_angle(kinematics.names, found.q[inside], q, coordinates)
        yield Check(f"{name}: {where}, from the capture's own after offset", worst, ANGLE_DEG, "<=", "°")


def muscle_rows(name: str, folder: Path, quick: bool) -> Iterator[Check]:
    """Tools of OpenSim that end well on the folder as it is, and the reserves beside the muscles.

    Args:
        name: Name of the rows.
        folder: The exported folder.
        quick: Static optimisation in the first 0.2 s only.
    """
    if quick:
        for setup in (SETUP_MUSCLES, SETUP_JOINTS):
            tree = ET.parse(folder / setup)
            tool = tree.getroot().find("AnalyzeTool")
            assert tool is not None
            last = tool.find("final_time")
            assert last is not None
            last.text = repr(float(tool.findtext("initial_time", "0")) + QUICK_S)
            tree.write(folder / setup)
    osim = opensim()
    with chdir(folder), quiet():
        ended = [osim.InverseDynamicsTool(SETUP_ID).run()]
        ended += [osim.AnalyzeTool(setup).run() for setup in (SETUP_MUSCLES, SETUP_JOINTS)]
    yield Check(f"{name}: tools that end well", sum(ended), len(ended), ">=")
    torques = read_storage(folder / TORQUES_OUT)
    forces = read_storage(folder / MUSCLES_OUT / f"{NAME}_StaticOptimization_force.sto")
    shares = {
        coordinate: np.abs(forces.column(coordinate + RESERVE)).max()
        / np.abs(torques.column(f"{coordinate}_moment")).max()
        for coordinate in LEGS
    }
    where = max(shares, key=lambda one: shares[one])
    yield Check(f"{name}: {where}, largest reserve by the torque's peak", shares[where], RESERVE_SHARE, "<=")
    few = sum(share <= RESERVE_SHARE for share in shares.values())
    yield information(f"{name}: of {len(shares)} joint coordinates within that bound", few)


def measured(result: Reconstruction, found: OntoMotion) -> Targets:
    """The measured markers as targets of the model's.

    Args:
        result: The result.
        found: Its motion in the model's coordinates.
    """
    columns = [result.marker_names.index(name) for name in found.markers]
    at = np.where(result.present[:, columns, None], result.measured_m[:, columns], np.nan)
    theirs = shared_markers(found.kinematics.model, result.subject.markers)
    return Targets(
        np.array([found.kinematics.body(theirs[name].body) for name in found.markers], int),
        np.array([theirs[name].position_m for name in found.markers]),
        at[found.rows] @ rotation_to_world("y"),
        np.ones(len(columns)),
    )


def rms_mm(kinematics: OsimKinematics, targets: Targets, q: Array) -> float:
    """RMS distance of the model's markers from their targets, mm.

    Args:
        kinematics: The model.
        targets: Where the markers shall be.
        q: (T, C) coordinates.
    """
    apart = kinematics.poses(q).points(targets.bodies, targets.places_m)[0] - targets.at_m
    return float(1e3 * np.sqrt(np.nanmean((apart**2).sum(axis=2))))


def worst_angle(
    names: tuple[str, ...], q: Array, other: Array, coordinates: tuple[str, ...] = LEGS
) -> tuple[float, str]:
    """Largest RMS difference of some coordinates from its mean difference, °, and where it is.

    Args:
        names: (C,) coordinates.
        q: (T, C) their values.
        other: (T, C) the values that they are compared with.
        coordinates: Those that are looked at.
    """
    apart = np.rad2deg(np.std(q - other, axis=0))
    found = {name: float(apart[names.index(name)]) for name in coordinates if name in names}
    where = max(found, key=lambda one: found[one])
    return found[where], where
