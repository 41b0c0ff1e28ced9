"""The folder ``mbkf imu stride`` writes: strides.csv, trajectory.csv and summary.json."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from mbkf.io.atomic import write_text
from mbkf.trial.inertial.stride import StrideMeasurement, stride_summary

STRIDES_FILE, TRAJECTORY_FILE, SUMMARY_FILE = "strides.csv", "trajectory.csv", "summary.json"

STRIDE_COLUMNS = (
    "foot", "stride", "start_s", "end_s", "length_m", "length_sd_m", "duration_s", "speed_m_s", "rise_m", "lift_m",
    "swing_s", "turn_deg", "refused",
)  # fmt: skip

TRAJECTORY_COLUMNS = (
    "foot", "time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "qx", "qy", "qz", "qw", "rest",
)  # fmt: skip


def write_stride_files(measured: StrideMeasurement, folder: Path) -> None:
    """Writes the tables into a folder that is not in use yet.

    Raises:
        OSError: A file cannot be written.
    """
    _write(folder / STRIDES_FILE, STRIDE_COLUMNS, _stride_rows(measured))
    _write(folder / TRAJECTORY_FILE, TRAJECTORY_COLUMNS, _trajectory_rows(measured))
    text = json.dumps(stride_summary(measured), indent=2, allow_nan=False, ensure_ascii=False)
    write_text(folder / SUMMARY_FILE, text + "\n")


def _stride_rows(measured: StrideMeasurement) -> Iterable[list[str]]:
    for foot in measured.feet:
        for number, stride in enumerate(foot.strides, start=1):
            values = [getattr(stride, name) for name in STRIDE_COLUMNS[2:-2]]
            turn = _cell(math.degrees(stride.turn_rad))
            yield [foot.name, str(number), *map(_cell, values), turn, stride.doubt]


def _trajectory_rows(measured: StrideMeasurement) -> Iterable[list[str]]:
    for foot in measured.feet:
        quaternions = foot.orientation
        if quaternions is None:
            quaternions = np.full((len(foot.time_s), 4), np.nan)
        numbers = np.column_stack([foot.time_s, foot.position_m, foot.velocity_m_s, quaternions])
        for row, still in zip(numbers, foot.still, strict=True):
            yield [foot.name, *map(_cell, row), str(int(still))]


def _cell(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def _write(path: Path, columns: Sequence[str], rows: Iterable[list[str]]) -> None:
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(columns)
    writer.writerows(rows)
    write_text(path, text.getvalue())
