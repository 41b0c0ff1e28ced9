"""Stride lengths: the study's simulated walk over the phase of its windows, and strides measured by cameras.

Part of the benchmark ``inertial``. Alone: ``python -m benchmarks.inertial_stride``. Writes ``stride.html``.
"""

from __future__ import annotations

import csv
import math
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.inertial_stride_page import write_page
from benchmarks.inertial_stride_study import (
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
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.imu.key_points import NOISY_WEIGHTS, KeyPointSettings
from mbkf.imu.zero_velocity import phases
from mbkf.io.imu import ImuReadings, read_imu_csv
from mbkf.pipelines.stride import FootResult, StrideSettings, measure_strides

SEEDS, QUICK_SEEDS = 10, 2

KALMAN_FINAL_M, KALMAN_MEAN_M = 0.03, 0.015
SMOOTHER_MM, FILTER_MM, OFFSET_MM = 60.0, 85.0, 25.0

FOLDER, RATE_HZ = "imu_gaitmap_foot", 204.8
NEAREST_S = 0.3
"""A rest further from a reference event is not the event's."""

_MM = 1e3

SMOOTHER, FILTER = "smoother", "filter"
VARIANTS: dict[str, StrideSettings] = {
    SMOOTHER: StrideSettings("smoother"),
    FILTER: StrideSettings("filter"),
    "key points as in the study": StrideSettings(
        "key-points", key_points=KeyPointSettings(weights=NOISY_WEIGHTS)
    ),
    "key points, sample by sample": StrideSettings(
        "key-points", key_points=KeyPointSettings(weights=NOISY_WEIGHTS, by_sample=True)
    ),
    "key points, windows of 5, sample by sample": StrideSettings(
        "key-points", key_points=KeyPointSettings(weights=NOISY_WEIGHTS, window=5, by_sample=True)
    ),
}
"""What is run on the measured strides, by what it is called in tables."""


@dataclass(frozen=True)
class ReferenceStride:
    """A stride as the cameras saw the heel: the foot's sensor, times of its two events, horizontal length."""

    sensor: str
    start_s: float
    end_s: float
    length_m: float


@dataclass(frozen=True)
class Compared:
    """A variant on the measured strides: lengths and standard deviations (n,), NaN where a stride is missed."""

    name: str
    lengths_m: Array
    sd_m: Array
    reference_m: Array
    rests_s: Array

    @property
    def found(self) -> int:
        """Strides with both rests found."""
        return int(np.isfinite(self.lengths_m).sum())

    @property
    def errors_mm(self) -> Array:
        """(n,) estimated minus measured."""
        return _MM * (self.lengths_m - self.reference_m)

    @property
    def rmse_mm(self) -> float:
        """Over the strides found."""
        return float(np.sqrt(np.nanmean(self.errors_mm**2)))

    @property
    def mean_mm(self) -> float:
        """Mean error over the strides found."""
        return float(np.nanmean(self.errors_mm))

    @property
    def normalised(self) -> float:
        """Mean of squared errors by stated variance; 1 is honest, NaN where none is stated."""
        if np.isnan(self.sd_m).all():
            return math.nan
        return float(np.nanmean((self.lengths_m - self.reference_m) ** 2 / self.sd_m**2))


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
        if judged:
            yield Check(f"{head}: squared error by stated variance", one.normalised, math.inf, "<=")


def compare(folder: Path) -> list[Compared]:
    """Every variant on the measured strides."""
    readings = read_imu_csv(folder / "imu_sample.csv", units={"acc": "m/s2", "gyr": "deg/s"}, rate_hz=RATE_HZ)
    reference = reference_strides(folder)
    return [compare_one(name, settings, readings, reference) for name, settings in VARIANTS.items()]


def compare_one(
    name: str,
    settings: StrideSettings,
    readings: Sequence[ImuReadings],
    reference: Sequence[ReferenceStride],
) -> Compared:
    """One variant. The reference's events only say which rests are meant; lengths are between our own rests."""
    feet = {foot.name: foot for foot in measure_strides(readings, settings).feet}
    found = np.array([matched(feet[one.sensor], one) for one in reference])
    rests = [
        float(foot.time_s[stop - 1] - foot.time_s[start])
        for foot in feet.values()
        for start, stop in phases(foot.still)
    ]
    return Compared(
        name, found[:, 0], found[:, 1], np.array([one.length_m for one in reference]), np.array(rests)
    )


def matched(foot: FootResult, reference: ReferenceStride) -> tuple[float, float]:
    """Length between the rests nearest to the reference's events, and its standard deviation; NaN if one is missing."""
    rests = phases(foot.still)
    ends = [_nearest(foot, rests, at) for at in (reference.start_s, reference.end_s)]
    if None in ends or ends[0] == ends[1]:
        return math.nan, math.nan
    i, j = ((rests[k][0] + rests[k][1] - 1) // 2 for k in ends if k is not None)
    way = foot.position_m[j] - foot.position_m[i]
    sd = [stride.length_sd_m for stride in foot.strides if i <= stride.first and stride.last <= j]
    return float(np.hypot(way[0], way[1])), float(np.linalg.norm(sd)) if sd else math.nan


def _nearest(foot: FootResult, rests: Sequence[tuple[int, int]], at_s: float) -> int | None:
    away = [max(foot.time_s[a] - at_s, at_s - foot.time_s[b - 1], 0.0) for a, b in rests]
    best = int(np.argmin(away))
    return best if away[best] <= NEAREST_S else None


def reference_strides(folder: Path) -> list[ReferenceStride]:
    """The strides of the cameras, with the events they were cut at."""
    with (folder / "position_sample.csv").open(encoding="utf-8", newline="") as file:
        paths: dict[tuple[str, str], list[list[float]]] = {}
        for row in list(csv.reader(file))[1:]:
            paths.setdefault((row[0], row[1]), []).append([float(cell) for cell in row[3:6]])
    with (folder / "stride_events_sample.csv").open(encoding="utf-8", newline="") as file:
        events = list(csv.DictReader(file))
    strides = []
    for event in events:
        sensor = f"{event['foot']}_sensor"
        path = np.array(paths[sensor, event["s_id"]])
        way = path[-1] - path[0]
        start, end = (float(event[key]) / RATE_HZ for key in ("start", "end"))
        strides.append(ReferenceStride(sensor, start, end, float(np.hypot(way[0], way[1]))))
    return strides


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
        print(f"inertial_stride: error: {error}", file=sys.stderr)
        return 2
    for check in checks:
        bound = f"{check.relation} {check.bound:g} {check.unit}" if check.bounded else "for information"
        print(f"{'' if check.passed else 'FAIL '}{check.name}: {check.value:.4g} ({bound})")
    return 0 if all(check.passed for check in checks) else 1


if __name__ == "__main__":
    sys.exit(main())
