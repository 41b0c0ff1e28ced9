"""Joint forces that OpenSim states beside muscle forces, against Newton's second law of all that lies beyond the joint.

Σ m (a − g) = joint force + ground reaction + Σ muscle tension × direction, over the bodies beyond the joint and the
points of muscle paths on them. Accelerations are those of a spline through the centres of mass; actuators at the hip
and ankle give moments alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from benchmarks.checks import Check
from benchmarks.peers.required import opensim, quiet
from benchmarks.references import rms
from mbkf.conventions import Array
from mbkf.io.storage import read_storage
from mbkf.trial.exchange.onto.result_onto import JOINTS_OUT, MUSCLES_OUT
from mbkf.trial.exchange.opensim_setups import LOADS, LOADS_DATA, MODEL, MOTION, NAME

SHARE = 0.01
"""Largest difference, as a share of the largest force: the spline of the motion is not OpenSim's."""

FRAMES = 40
"""Most frames that are compared, spread over the trial."""

BEYOND = {
    "hip": ("femur", "patella", "tibia", "talus", "calcn", "toes"),
    "ankle": ("talus", "calcn", "toes"),
}
"""Bodies beyond a joint, without their sides."""


def joint_force_rows(name: str, folder: Path) -> Iterator[Check]:
    """Differences of the forces in hips and ankles, by the largest force.

    Args:
        name: Name of the rows.
        folder: A folder in which static optimisation and joint reactions have run.
    """
    with quiet():
        model = opensim().Model(str(folder / MODEL))
        state = model.initSystem()
    motion = read_storage(folder / MOTION)
    reactions = read_storage(folder / JOINTS_OUT / f"{NAME}_JointReaction_ReactionLoads.sto")
    step = -(-len(reactions.times_s) // FRAMES)
    rows = np.searchsorted(motion.times_s, reactions.times_s[::step] - 1e-6)
    for joint, parts in BEYOND.items():
        shares = []
        for side in "rl":
            names = [f"{part}_{side}" for part in parts if model.getBodySet().contains(f"{part}_{side}")]
            found = _newton(folder, model, state, names, rows)
            begins = f"{joint}_{side}_on_{names[0]}_in_ground_f"
            theirs = np.column_stack([reactions.column(begins + axis) for axis in "xyz"])[::step]
            shares.append(rms(theirs - found) / float(np.abs(theirs).max()))
        yield Check(f"{name}: {joint} force, RMS from Newton's law by its peak", max(shares), SHARE, "<=")


def _newton(folder: Path, model: Any, state: Any, names: list[str], rows: NDArray[np.intp]) -> Array:
    """(R, 3) force of a joint on the bodies beyond it, N, in the ground's axes.

    Args:
        folder: The folder.
        model: Its model in OpenSim.
        state: A state of the model.
        names: The bodies.
        rows: (R,) rows of the motion.
    """
    motion, bodies = read_storage(folder / MOTION), [model.getBodySet().get(name) for name in names]
    times = motion.times_s[rows]
    tensions = read_storage(folder / MUSCLES_OUT / f"{NAME}_StaticOptimization_force.sto")
    muscles = [model.getMuscles().get(k) for k in range(model.getMuscles().getSize())]
    pulls = {one: np.interp(times, tensions.times_s, tensions.column(one.getName())) for one in muscles}
    first_moments, wanted = np.zeros((len(motion.times_s), 3)), {int(row): k for k, row in enumerate(rows)}
    others = _ground(folder, names, times)
    for row, values in enumerate(motion.columns):
        _pose(model, state, motion.names, values)
        for body in bodies:
            place = body.findStationLocationInGround(state, body.getMassCenter())
            first_moments[row] += body.getMass() * _vector(place)
        if row in wanted:
            others[wanted[row]] += sum(
                pulls[one][wanted[row]] * _direction(one, state, names) for one in muscles
            )
    weight = sum(body.getMass() for body in bodies) * _vector(model.getGravity())
    return missing_force(motion.times_s, first_moments, rows, others + weight)


def missing_force(times_s: Array, first_moments: Array, rows: NDArray[np.intp], others: Array) -> Array:
    """(R, 3) force, N, that bodies need beside others to move as they do: Σ m a − F.

    Args:
        times_s: (T,) times.
        first_moments: (T, 3) Σ m x of the bodies, kg m.
        rows: (R,) rows of these.
        others: (R, 3) all other forces F on the bodies, weight included, N.
    """
    return np.asarray(make_interp_spline(times_s, first_moments, 5)(times_s[rows], 2) - others)


def _direction(muscle: Any, state: Any, names: list[str]) -> Array:
    """(3,) force on these bodies for each N of the muscle."""
    points = opensim().ArrayPointForceDirection()
    muscle.getGeometryPath().getPointForceDirections(state, points)
    total = np.zeros(3)
    for k in range(points.getSize()):
        one = points.get(k)
        if one.frame().findBaseFrame().getName() in names:
            total += _vector(one.direction())
    return total


def _ground(folder: Path, names: list[str], times: Array) -> Array:
    """(R, 3) external force on these bodies, N."""
    table, total = read_storage(folder / LOADS_DATA), np.zeros((len(times), 3))
    for one in ET.parse(folder / LOADS).getroot().iter("ExternalForce"):
        if one.findtext("applied_to_body") in names:
            begins = one.findtext("force_identifier")
            columns = [table.column(f"{begins}{axis}") for axis in "xyz"]
            total += np.column_stack([np.interp(times, table.times_s, column) for column in columns])
    return total


def _pose(model: Any, state: Any, names: tuple[str, ...], values: Array) -> None:
    coordinates = model.getCoordinateSet()
    for name, value in zip(names, values, strict=True):
        one = coordinates.get(name)
        if not one.getLocked(state):
            angle = one.getMotionType() == one.Rotational
            one.setValue(state, float(np.deg2rad(value) if angle else value), False)
    model.assemble(state)
    model.realizePosition(state)


def _vector(found: Any) -> Array:
    return np.array([found.get(k) for k in range(3)])
