"""The folder of `mbkf imu stride`."""

import csv
import json

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.trial.inertial.stride import StrideSettings, measure_strides
from mbkf.trial.inertial.stride_folder import (
    STRIDE_COLUMNS,
    STRIDES_FILE,
    SUMMARY_FILE,
    TRAJECTORY_COLUMNS,
    TRAJECTORY_FILE,
    write_stride_files,
)


@pytest.fixture(scope="module")
def measured():
    return measure_strides([foot_walk(force_noise_m_s2=0.05, rate_noise_rad_s=0.01).readings])


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        return tuple(reader.fieldnames), list(reader)


def test_tables_hold_what_was_measured(measured, tmp_path):
    write_stride_files(measured, tmp_path)
    (foot,) = measured.feet
    names, strides = table(tmp_path / STRIDES_FILE)
    assert names == STRIDE_COLUMNS
    assert [float(row["length_m"]) for row in strides] == pytest.approx(
        [s.length_m for s in foot.strides], rel=1e-5
    )
    assert [float(row["turn_deg"]) for row in strides] == pytest.approx(
        np.degrees([s.turn_rad for s in foot.strides]), rel=1e-4
    )
    assert {row["foot"] for row in strides} == {"left_foot"}
    names, path = table(tmp_path / TRAJECTORY_FILE)
    assert names == TRAJECTORY_COLUMNS
    found = np.array([[float(row[key]) for key in ("x_m", "y_m", "z_m")] for row in path])
    assert np.allclose(found, foot.position_m, atol=1e-4)
    assert [int(row["rest"]) for row in path] == foot.still.astype(int).tolist()
    summary = json.loads((tmp_path / SUMMARY_FILE).read_text(encoding="utf-8"))
    assert summary["feet"]["left_foot"]["strides"] == 3


def test_what_is_unknown_is_blank(tmp_path):
    walk = foot_walk(
        (1.2,), rate_hz=50.0, mounting_rad=(0.0, 0.0, 0.0), force_noise_m_s2=0.02, rate_noise_rad_s=0.002
    )
    write_stride_files(measure_strides([walk.readings], StrideSettings("key-points")), tmp_path)
    _, strides = table(tmp_path / STRIDES_FILE)
    assert [row["turn_deg"] for row in strides] == [""] * len(strides) != []
    _, path = table(tmp_path / TRAJECTORY_FILE)
    assert path[0]["qx"] == ""
