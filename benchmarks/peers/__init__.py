"""Beside OpenSim and biorbd on the same frames and markers of three captures, and beside VQF on inertial sensors.

Needs the extra ``peers``. Whatever could favour a peer is left to it: its person is the one that its makers scaled, its
markers are corrected on all frames, and of its settings the best counts in each row (``docs/peers.md``).
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.dynamic.methods import in_parallel
from benchmarks.inertial.orientation import beside_vqf
from benchmarks.peers.hidden import error_mm, hidden_rows
from benchmarks.peers.required import biorbd, opensim
from benchmarks.peers.residuals import residual_rows, withheld_row
from benchmarks.peers.results import Results, results
from benchmarks.peers.shared import CAPTURES, GAIT2354, RUN, WALK
from benchmarks.peers.times import time_rows
from benchmarks.peers.torques import torque_rows
from mbkf.numerics.threads import single_threaded

BOUNDED = (WALK, RUN)
MARKERS = 0.8
SEEDS = (0, 1, 2, 3)


def run(context: Context) -> list[Check]:
    """All rows; the walk's with one seed when quick."""
    opensim(), biorbd()
    data, names = context.require_data(), (WALK,) if context.quick else CAPTURES
    seeds = SEEDS[:1] if context.quick else SEEDS
    with in_parallel() as mapper:
        found = mapper(partial(capture_rows, data=data, out=context.out, seeds=seeds), names)
    rows = [row for some, _ in found for row in some]
    with single_threaded():  # times need a quiet computer: after all else
        for _, own in found[:2]:
            rows += time_rows(own)
        return [*rows, *beside_vqf(context)]


def capture_rows(name: str, data: Path, out: Path, seeds: tuple[int, ...]) -> tuple[list[Check], Results]:
    """All rows of a capture but times, and what the tools make of it.

    Args:
        name: Name of the capture.
        data: Folder of the reference captures.
        out: Folder for models.
        seeds: Random seeds of hidden streaks.
    """
    with single_threaded():
        found, bounded = results(name, data, out), name in BOUNDED
        rows = [
            *marker_rows(found, bounded),
            *residual_rows(found, bounded),
            *([withheld_row(found)] if name != GAIT2354 else []),
            *hidden_rows(found, seeds, bounded),
            *torque_rows(found, data),
        ]
        return rows, found


def marker_rows(found: Results, bounded: bool) -> list[Check]:
    """Distance of measured and modelled markers, and ours over the better peer's.

    Args:
        found: What the tools make of a capture.
        bounded: Whether the ratio has a bound.
    """
    own = found.shared
    everything = np.ones(own.lab_m.shape[:2], dtype=bool)
    label = f"{own.name}: marker RMS"
    ours = {
        kind: error_mm(one.predicted_m, one.measured_m, one.present)
        for kind, one in (("causal", found.causal), ("smoothed", found.smooth))
    }
    theirs = {
        "OpenSim": min(error_mm(one.markers_m, own.lab_m, everything) for one in found.opensim.values()),
        "biorbd": min(error_mm(one.markers_m, own.lab_m, everything) for one in found.biorbd.values()),
    }
    bound = MARKERS if bounded else np.inf
    return [
        *(information(f"{label}, mbkf {kind}", value, "mm") for kind, value in ours.items()),
        *(information(f"{label}, {tool}", value, "mm") for tool, value in theirs.items()),
        *(
            Check(f"{label}, mbkf {kind} / better peer", value / min(theirs.values()), bound, "<=")
            for kind, value in ours.items()
        ),
    ]
