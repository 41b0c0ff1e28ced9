"""OpenSim's inverse dynamics tool on a motion and the recorded ground reactions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.peers.required import opensim, quiet
from benchmarks.peers.shared import FEET, Loads
from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.io.storage import Table, read_storage


def inverse_dynamics(
    model: Path, names: Sequence[str], q: Array, times_s: Array, loads: Loads, cut_off_hz: float | None
) -> Table:
    """Generalised forces, named as OpenSim names them ("hip_flexion_r_moment", "pelvis_tx_force").

    Args:
        model: The model.
        names: (C,) coordinates.
        q: (T, C) their values, rad and m.
        times_s: (T,) times of the frames.
        loads: Ground reactions.
        cut_off_hz: Cut-off of the tool's low-pass, which runs forwards and backwards over the coordinates; None for
            none.

    Raises:
        NotConverged: The tool ended without a result.
    """
    osim = opensim()
    with TemporaryDirectory() as name:
        folder = Path(name)
        external = folder / "loads.xml"
        _external_loads(osim, loads).printToXML(str(external))
        motion = folder / "motion.sto"
        _write_motion(motion, names, q, times_s)
        tool = osim.InverseDynamicsTool()
        tool.setModelFileName(str(model))
        tool.setCoordinatesFileName(str(motion))
        tool.setExternalLoadsFileName(str(external))
        tool.setLowpassCutoffFrequency(-1.0 if cut_off_hz is None else cut_off_hz)
        tool.setStartTime(float(times_s[0]))
        tool.setEndTime(float(times_s[-1]))
        tool.setResultsDir(str(folder))
        tool.setOutputGenForceFileName("forces.sto")
        with quiet():
            done = tool.run()
        if not done:
            raise NotConverged("OpenSim's inverse dynamics tool gave no result")
        return read_storage(folder / "forces.sto")


def _external_loads(osim: Any, loads: Loads) -> Any:
    found = osim.ExternalLoads()
    for body, (force, point, torque) in zip(FEET, loads.columns, strict=True):
        one = osim.ExternalForce()
        one.setName(f"{body}_load")
        one.set_applied_to_body(body)
        one.set_force_expressed_in_body("ground")
        one.set_point_expressed_in_body("ground")
        one.set_force_identifier(force)
        one.set_point_identifier(point)
        one.set_torque_identifier(torque)
        found.cloneAndAppend(one)
    found.setDataFileName(str(loads.file))
    return found


def _write_motion(path: Path, names: Sequence[str], q: Array, times_s: Array) -> None:
    head = [
        "motion",
        "version=1",
        f"nRows={len(q)}",
        f"nColumns={len(names) + 1}",
        "inDegrees=no",
        "endheader",
    ]
    rows = np.column_stack([times_s, q]).tolist()
    lines = [*head, "\t".join(["time", *names]), *("\t".join(f"{x:.12g}" for x in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
