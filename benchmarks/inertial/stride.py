"""Strides measured by cameras, by the Kalman filter and by key points.

Part of the benchmark ``inertial``. Alone: ``python -m benchmarks.inertial.stride``. The paper that the key points come
from is redone by the benchmark ``stride_paper``.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.checks import Check, Context, within
from benchmarks.inertial.stride_measured import (
    FILTER,
    FOLDER,
    SMOOTHER,
    Compared,
    clipped,
    compare,
    compare_one,
    read_feet,
    reference_strides,
)
from mbkf.errors import MbkfError
from mbkf.trial.inertial.stride import StrideSettings

SMOOTHER_MM, FILTER_MM, OFFSET_MM = 52.0, 85.0, 25.0
SPREAD = 0.7, 1.3
CLIPPED_DEG_S, CLIPPED_MM, CLIPPED_SPREAD = (180, 250, 350), 120.0, 1.5


def rows(context: Context) -> list[Check]:
    """All rows of the measured strides."""
    folder = context.require_data() / FOLDER
    return [*measured_rows(compare(folder)), *clipped_rows(folder)]


def measured_rows(compared: Sequence[Compared]) -> Iterator[Check]:
    """The strides measured by cameras."""
    for one in compared:
        n = len(one.reference_m)
        head = f"gaitmap foot, {one.name}"
        judged = one.name in (SMOOTHER, FILTER)
        bound = {SMOOTHER: SMOOTHER_MM, FILTER: FILTER_MM}.get(one.name, math.inf)
        least = float(n) if judged else -math.inf
        yield Check(f"{head}: strides found of {n}", float(one.found), least, ">=")
        yield Check(f"{head}: RMSE", one.rmse_mm, bound, "<=", "mm")
        if one.name == SMOOTHER:
            yield Check(f"{head}: |mean error|", abs(one.mean_mm), OFFSET_MM, "<=", "mm")
        yield Check(f"{head}: mean error", one.mean_mm, math.inf, "<=", "mm")
        if one.name == SMOOTHER:
            yield from within(f"{head}: error by stated sd", math.sqrt(one.normalised), *SPREAD)
        elif judged:
            yield Check(f"{head}: squared error by stated variance", one.normalised, math.inf, "<=")


def clipped_rows(folder: Path) -> Iterator[Check]:
    """Strides from gyroscopes that clip softly: errors of their lengths, and the share within twice the spreads."""
    readings, reference = read_feet(folder), reference_strides(folder)
    for limit_deg_s in CLIPPED_DEG_S:
        cut = [clipped(one, math.radians(limit_deg_s)) for one in readings]
        found = compare_one(SMOOTHER, StrideSettings(SMOOTHER), cut, reference)
        head = f"gaitmap foot, {SMOOTHER}, gyroscopes clipped softly at {limit_deg_s} deg/s"
        n = len(found.reference_m)
        yield Check(f"{head}: strides found of {n}", float(found.found), float(n), ">=")
        yield Check(f"{head}: RMSE", found.rmse_mm, CLIPPED_MM, "<=", "mm")
        yield Check(f"{head}: error by stated sd", math.sqrt(found.normalised), CLIPPED_SPREAD, "<=")


def main() -> int:
    """Runs these rows alone."""
    data = os.environ.get("MBKF_DATA")
    try:
        checks = rows(
            Context(data=None if data is None else Path(data), out=Path(), quick="--quick" in sys.argv)
        )
    except MbkfError as error:
        print(f"inertial.stride: error: {error}", file=sys.stderr)
        return 2
    for check in checks:
        bound = f"{check.relation} {check.bound:g} {check.unit}" if check.bounded else "for information"
        print(f"{'' if check.passed else 'FAIL '}{check.name}: {check.value:.4g} ({bound})")
    return 0 if all(check.passed for check in checks) else 1


if __name__ == "__main__":
    sys.exit(main())
