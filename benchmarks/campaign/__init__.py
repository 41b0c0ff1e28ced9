"""A thousand random short trials against truth: no implausible result, and intervals that cover.

Motion, person, instruments' errors, gaps, exchanged labels, dropped frames, plates late or missing: all by the seed.
One trial again, as a row names it: ``python -m benchmarks.campaign --seed 17``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from benchmarks.campaign.rows import rows, severity
from benchmarks.campaign.trials import Outcome, outcome
from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel

TRIALS, QUICK_TRIALS = 1000, 40


def run(context: Context) -> list[Check]:
    """All rows; ``trials.json`` has a line for each trial."""
    with in_parallel() as mapper:
        found = mapper(outcome, range(QUICK_TRIALS if context.quick else TRIALS))
    write(found, context.out / "trials.json")
    return rows(found)


def write(outcomes: list[Outcome], path: Path) -> None:
    """A line for each trial, the worst first.

    Args:
        outcomes: What became of the trials.
        path: The file.
    """
    ranked = sorted(outcomes, key=lambda one: -severity(one) if one.errors else -np.inf)
    path.write_text("[\n" + ",\n".join(json.dumps(told(one)) for one in ranked) + "\n]\n", encoding="utf-8")


def told(one: Outcome) -> dict[str, object]:
    """A trial's outcome as plain data."""
    words: dict[str, object] = {
        "seed": one.trial.seed,
        "trial": str(one.trial),
        "seconds": round(one.seconds, 2),
    }
    if one.refused or one.failed:
        return words | {"refused": one.refused, "failed": one.failed}
    for error in one.errors:
        most = int(error.angle_rms_deg.argmax())
        known = np.isfinite(error.torque_nm).any()
        words["smoothed" if error.smoothed else "causal"] = {
            "worst_angle": error.worst_angle,
            "deg": round(error.worst_deg, 2),
            "sd": round(float(error.angle_doubt[most]), 2),
            "torque_nm": round(float(np.nanmax(error.torque_nm)), 1) if known else None,
            "nees": [round(value, 2) for value in error.judged.nees],
            "tracked": round(error.tracked, 3),
        }
    return words
