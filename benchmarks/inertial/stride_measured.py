"""Strides measured by cameras, compared with the strides that each variant finds in the foot sensors' readings."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.key_points import NOISY_WEIGHTS, KeyPointSettings
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.table import read_imu_csv
from mbkf.numerics.runs import runs
from mbkf.trial.inertial.stride import FootResult, StrideSettings, measure_strides

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
        """Mean of squared errors over their stated variance: 1 for a consistent one, NaN where none is stated."""
        if np.isnan(self.sd_m).all():
            return math.nan
        return float(np.nanmean((self.lengths_m - self.reference_m) ** 2 / self.sd_m**2))


def compare(folder: Path) -> list[Compared]:
    """Every variant on the measured strides."""
    readings = read_feet(folder)
    reference = reference_strides(folder)
    return [compare_one(name, settings, readings, reference) for name, settings in VARIANTS.items()]


def read_feet(folder: Path) -> list[ImuReadings]:
    """Readings of the sensors on both feet.

    Args:
        folder: The capture's.
    """
    units = {"acc": "m/s2", "gyr": "deg/s"}
    return list(read_imu_csv(folder / "imu_sample.csv", units=units, rate_hz=RATE_HZ))


def clipped(reading: ImuReadings, limit_rad_s: float) -> ImuReadings:
    """The readings of a gyroscope that clips softly: beyond its limit they scatter over the last hundredth below it.

    Args:
        reading: The readings.
        limit_rad_s: Its limit on all axes.
    """
    rates = reading.angular_velocity_rad_s.copy()
    over = np.abs(rates) > limit_rad_s
    scattered = 1.0 - 0.008 * np.random.default_rng(0).random(rates.shape)
    rates[over] = (np.sign(rates) * limit_rad_s * scattered)[over]
    return replace(reading, angular_velocity_rad_s=rates)


def compare_one(
    name: str,
    settings: StrideSettings,
    readings: Sequence[ImuReadings],
    reference: Sequence[ReferenceStride],
) -> Compared:
    """One variant. The reference's events only select rests; lengths are those between the rests found.

    Args:
        name: Name of the variant.
        settings: Its settings.
        readings: Readings of both feet's sensors.
        reference: Strides measured by cameras.
    """
    feet = {foot.name: foot for foot in measure_strides(readings, settings).feet}
    found = np.array([matched(feet[one.sensor], one) for one in reference])
    rests = [
        float(foot.time_s[stop - 1] - foot.time_s[start])
        for foot in feet.values()
        for start, stop in runs(foot.still)
    ]
    return Compared(
        name, found[:, 0], found[:, 1], np.array([one.length_m for one in reference]), np.array(rests)
    )


def matched(foot: FootResult, reference: ReferenceStride) -> tuple[float, float]:
    """Length between the rests nearest to the reference's events, and its standard deviation; NaN if one is missing."""
    rests = runs(foot.still)
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
