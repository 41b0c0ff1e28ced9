"""The example of optimal control: its time, and the physics and optimality of its two squats."""

from __future__ import annotations

import contextlib
import io
import runpy
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.checks import Check, information

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "examples" / "18_assisted_squat.py"
SECONDS, RESIDUAL_N, MOVED_M, ENERGY, SAVED_NM = 60.0, 1e-6, 1e-9, 1e-3, 30.0
MESH = 0.02
"""Share by which peak torques may differ on a mesh twice as fine."""

MARGIN = 1e-5
"""Of contact (body weight, body weight × m) and motor (N m): IPOPT widens bounds by 1e-8 of their unit, 100 N m."""


def example_rows(out: Path) -> list[Check]:
    """All rows; the example's picture lies in a folder.

    Args:
        out: The folder.
    """
    start = process_time()
    with contextlib.chdir(out), contextlib.redirect_stdout(io.StringIO()):
        found = runpy.run_path(str(EXAMPLE), run_name="__main__")
    seconds = process_time() - start
    alone, assisted = found["alone"], found["assisted"]
    rows = [Check("assisted squat: processor time", seconds, SECONDS, "<=", "s")]
    for name, squat in (("no motor", alone), ("40 N m", assisted)):
        residual, moved, energy = found["physics"](found["planar"], squat)
        rows += [
            Check(f"assisted squat, {name}: solved", float(squat.status == "Solve_Succeeded"), 1.0, ">="),
            Check(
                f"assisted squat, {name}: equations of motion by Pinocchio",
                residual,
                RESIDUAL_N,
                "<=",
                "N, N m",
            ),
            Check(f"assisted squat, {name}: movement of the feet", moved, MOVED_M, "<=", "m"),
            Check(f"assisted squat, {name}: energy against work, way down", energy, ENERGY, "<=", "share"),
            Check(f"assisted squat, {name}: breach of contact and motor", breach(found, squat), MARGIN, "<="),
        ]
    peaks = [float(np.abs(squat.muscles[1]).max()) for squat in (alone, assisted)]
    fine = found["optimal_squat"](found["planar"], 40.0, intervals=32)
    apart = float(np.abs(fine.muscles[1]).max()) / peaks[1] - 1.0
    peak = "assisted squat: peak torque of the knee's muscles"
    return [
        *rows,
        Check(f"{peak}, saved by the motor", peaks[0] - peaks[1], SAVED_NM, ">=", "N m"),
        Check(f"{peak}, on a mesh twice as fine, 40 N m", abs(apart), MESH, "<=", "share"),
        information(f"{peak}, no motor", peaks[0], "N m"),
        information(f"{peak}, 40 N m", peaks[1], "N m"),
    ]


def breach(found: dict[str, Any], squat: Any) -> float:
    """Greatest breach of the friction cone, of the sole by the centre of pressure, and of the motor's range.

    Args:
        found: Names of the example.
        squat: One of its squats.
    """
    planar, weight = found["planar"], found["planar"].body.mass_kg * 9.81
    x, z, turning = squat.reactions / weight
    margins = (
        found["FRICTION"] * z - np.abs(x),
        turning - planar.heel * z,
        planar.ball * z - turning,
        squat.motor,
        40.0 - squat.motor,
    )
    return -float(min(one.min() for one in margins))
