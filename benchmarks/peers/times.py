"""Time per frame by each tool on the same frames, in turn within one run, on one thread."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.peers import biorbd_tool, opensim_id, opensim_ik
from benchmarks.peers.required import opensim
from benchmarks.peers.results import Results
from benchmarks.speed.products import joined
from benchmarks.speed.steps import STEP, dynamic_times
from benchmarks.speed.walks import Walk
from mbkf.conventions import Array

ROUNDS, LEAST_STEPS, OPENSIM_FRAMES = 3, 200, 60
OF_OPENSIM, OF_BIORBD = 0.03, 0.5
_MS = 1e3


def time_rows(found: Results) -> list[Check]:
    """Median times, and ours over theirs. Theirs are kinematics alone: torques would come on top.

    Args:
        found: What the tools make of a capture.
    """
    walk = Walk(found.subject, found.shared.person.capture)
    own, theirs, other = [], [], []
    for _ in range(ROUNDS):
        own.append(dynamic_times(walk, LEAST_STEPS))
        theirs.append(opensim_seconds(found))
        other.append(biorbd_seconds(found))
    times = joined(own)
    step = _MS * float(np.median(times.parts[STEP]))
    frame = _MS * float(np.median(np.sum(list(times.parts.values()), axis=0)))
    ik, ekf = (_MS * float(np.median(np.concatenate(some))) for some in (theirs, other))
    label = f"{found.shared.name}: time of a frame"
    return [
        information(f"{label}, mbkf: step", step, "ms"),
        information(f"{label}, mbkf: step, standard deviations, NIS, record", frame, "ms"),
        information(f"{label}, OpenSim: inverse kinematics", ik, "ms"),
        information(f"{label}, OpenSim: inverse dynamics besides", dynamics_ms(found), "ms"),
        information(f"{label}, biorbd: marker filter", ekf, "ms"),
        Check(f"{label}, mbkf's step / OpenSim", step / ik, OF_OPENSIM, "<="),
        Check(f"{label}, all of mbkf's / biorbd", frame / ekf, OF_BIORBD, "<="),
    ]


def opensim_seconds(found: Results) -> Array:
    """(n,) time of each frame but the first, in which the model is assembled."""
    own = found.shared
    model = opensim().Model(str(found.bodies[""].model))
    pose = opensim_ik.Pose(model, own.names, own.lab_m, own.times_s)
    seconds = []
    for t in range(min(OPENSIM_FRAMES, len(own.times_s))):
        begin = perf_counter()
        pose.solve(t)
        seconds.append(perf_counter() - begin)
    return np.array(seconds[1:])


def biorbd_seconds(found: Results) -> Array:
    """(T - 1,) time of each frame but the first."""
    own = found.shared
    tracking = biorbd_tool.Tracking(biorbd_tool.read(found.bodies[""].body), own.lab_m, own.rate_hz)
    seconds = []
    for t in range(len(own.times_s)):
        begin = perf_counter()
        tracking.step(t)
        seconds.append(perf_counter() - begin)
    return np.array(seconds[1:])


def dynamics_ms(found: Results) -> float:
    """Mean time of OpenSim's inverse dynamics tool per frame, files included."""
    own, motion = found.shared, found.opensim[""]
    begin = perf_counter()
    opensim_id.inverse_dynamics(
        found.bodies[""].model, motion.coordinates, motion.q, own.times_s, own.loads, None
    )
    return _MS * (perf_counter() - begin) / len(own.times_s)
