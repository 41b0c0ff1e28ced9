"""Stride lengths: the study's simulated walk over the phase of its windows, and strides measured by cameras.

Part of the benchmark ``inertial``. Alone: ``python -m benchmarks.inertial.stride``. Writes ``stride.html``.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.checks import Check, Context, within
from benchmarks.inertial.stride_measured import FILTER, FOLDER, SMOOTHER, Compared, compare
from benchmarks.inertial.stride_page import write_page
from benchmarks.inertial.stride_study import (
    ALIGNED,
    DELAYS_S,
    FINAL_M,
    KALMAN,
    KEY_POINTS,
    KEY_POINTS_WITH_BIAS,
    MEAN_M,
    PHASES,
    STUDY_FINAL_M,
    STUDY_MEAN_M,
    Study,
    measure_study,
)
from mbkf.errors import MbkfError

SEEDS, QUICK_SEEDS = 10, 2

KALMAN_FINAL_M, KALMAN_MEAN_M = 0.03, 0.015
SMOOTHER_MM, FILTER_MM, OFFSET_MM = 52.0, 85.0, 25.0
SPREAD = 0.7, 1.3


def rows(context: Context) -> list[Check]:
    """All rows of the stride table; writes the page."""
    seeds = range(QUICK_SEEDS if context.quick else SEEDS)
    study = measure_study(seeds)
    folder = context.require_data() / FOLDER
    compared = compare(folder)
    checks = [*study_rows(study, len(seeds)), *measured_rows(compared)]
    write_page(context.out, study, compared, checks)
    return checks


def study_rows(study: Study, seeds: int) -> Iterator[Check]:
    """The simulated walk: largest errors over the seeds, and for the Kalman filter over all phases."""
    for case in study.cases:
        final, mean = study.largest(KEY_POINTS, case, PHASES.index(ALIGNED))
        head = f"key points, {case}, aligned, {seeds} seeds"
        yield Check(f"{head}: final (study {STUDY_FINAL_M[case]})", final, FINAL_M, "<=", "m")
        yield Check(f"{head}: mean (study {STUDY_MEAN_M[case]})", mean, MEAN_M, "<=", "m")
    for case in study.cases:
        final, mean = study.largest(KEY_POINTS_WITH_BIAS, case, PHASES.index(ALIGNED))
        head = f"key points, {case}, aligned, gyroscope's bias left in"
        yield Check(f"{head}: final", final, math.inf, "<=", "m")
        yield Check(f"{head}: mean", mean, math.inf, "<=", "m")
    for case in study.cases:
        worst = [study.largest(KEY_POINTS, case, k) for k in range(len(PHASES))]
        yield Check(f"key points, {case}, worst phase: final", max(f for f, _ in worst), math.inf, "<=", "m")
    for case in study.cases:
        worst = [study.largest(KALMAN, case, k) for k in range(len(DELAYS_S))]
        head = f"Kalman, {case}, {len(DELAYS_S)} phases, {seeds} seeds"
        yield Check(f"{head}: final", max(f for f, _ in worst), KALMAN_FINAL_M, "<=", "m")
        yield Check(f"{head}: mean", max(m for _, m in worst), KALMAN_MEAN_M, "<=", "m")


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


def main() -> int:
    """Runs these rows alone; the page goes to results/inertial."""
    out = Path("results/inertial")
    out.mkdir(parents=True, exist_ok=True)
    data = os.environ.get("MBKF_DATA")
    try:
        checks = rows(
            Context(data=None if data is None else Path(data), out=out, quick="--quick" in sys.argv)
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
