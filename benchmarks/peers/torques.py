"""Joint torques by each tool against the inverse dynamics that stands beside a capture, all low-passed at 6 Hz.

The reference was made with OpenSim, of the very model that OpenSim's rows here use, from a motion that its residual
reduction has altered: it is no truth, and nearest to OpenSim by birth.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import moment_table
from benchmarks.peers import biorbd_tool, opensim_id
from benchmarks.peers.residuals import filtered
from benchmarks.peers.results import Results
from benchmarks.peers.shared import GAIT2354, WALK
from benchmarks.references import LOW_PASS_HZ, PLUG_IN_GAIT, low_passed, worst_side
from mbkf.io.storage import Table, read_storage

REFERENCES = {
    WALK: ("rajagopal_walk_run/reference_walk/id_walk.sto", 1.0),
    GAIT2354: ("gait2354_walk/reference/inverse_dynamics.sto", -1.0),
}
"""File of a capture's reference, and the sign of its knee: gait2354's counts extension."""


def torque_rows(found: Results, data: Path) -> list[Check]:
    """RMS difference per joint and tool, the poorer side; nothing where no reference is.

    Args:
        found: What the tools make of a capture.
        data: Folder of the reference captures.
    """
    name = found.shared.name
    if name not in REFERENCES:
        return []
    file, knee = REFERENCES[name]
    theirs, per_kg = read_storage(data / file), 1.0 / found.subject.mass_kg
    ours = low_passed(moment_table(found.smooth))
    tools = {
        "mbkf smoothed": (ours, knee),
        "OpenSim": (_opensim(found), 1.0),
        "biorbd": (_biorbd(found), 1.0),
    }
    return [
        information(
            f"{name}: {joint.removesuffix('_flexion').removesuffix('_angle')} torque against the reference, {tool}",
            worst_side(
                table,
                theirs,
                joint,
                suffix="_moment",
                sign=sign if joint == "knee_angle" else 1.0,
                factor=per_kg,
            ).rms,
            "N m/kg",
        )
        for joint in PLUG_IN_GAIT
        for tool, (table, sign) in tools.items()
    ]


def _opensim(found: Results) -> Table:
    own, motion = found.shared, found.opensim[""]
    return opensim_id.inverse_dynamics(
        found.bodies[""].model, motion.coordinates, motion.q, own.times_s, own.loads, LOW_PASS_HZ
    )


def _biorbd(found: Results) -> Table:
    own, body = found.shared, found.bodies[""].body
    motion = filtered(found.biorbd["", ""], own.rate_hz, LOW_PASS_HZ)
    tau = biorbd_tool.inverse_dynamics(biorbd_tool.read(body), motion, own.times_s, own.loads)
    names = tuple(f"{coordinate}_moment" for coordinate in body.coordinates)
    return Table(names, np.asarray(own.times_s), tau)
