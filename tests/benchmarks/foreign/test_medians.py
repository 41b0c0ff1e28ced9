"""Medians and their baseline: what is written is read, and a median that grows breaks its row."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.foreign.errors import Judged, Series
from benchmarks.foreign.medians import median_rows, medians, read_baseline, write_baseline


def found() -> list[Judged]:
    """Three motions whose errors are 1, 2 and 6."""
    motions = []
    for size in (1.0, 2.0, 6.0):
        error = size * np.array([1.0, -1.0, 1.0, -1.0])
        one = Series("p", str(size), "legs", "knee_angle_r", error, np.ones(4), np.ones(4))
        trunk = Series("p", str(size), "lumbar", "lumbar_bending", 100.0 + error, np.ones(4), np.ones(4))
        centres = {("hip", "r"): np.full(4, 1e-3 * size), ("knee", "r"): np.full(4, 1.0)}
        motions.append(Judged("p", str(size), (one, trunk), (one,), centres))
    return motions


def test_medians_are_of_legs_and_hips() -> None:
    assert medians(found()) == pytest.approx({"raw": 2.0, "varying": 2.0, "hip": 2.0, "moment": 2.0})


def test_baseline_is_read_as_written(tmp_path: Path) -> None:
    path = tmp_path / "baseline.toml"
    assert read_baseline(path) == {}
    held = {"adult and child, session": medians(found())}
    write_baseline({}, path)
    write_baseline(held, path)
    assert read_baseline(path) == held


def test_a_larger_median_breaks_its_row() -> None:
    held = {"a": {"raw": 1.8, "varying": 2.0, "hip": 1.95, "moment": 5.0}}
    assert [row.passed for row in median_rows("a", found(), held)] == [False, True, True, True]
    assert not any(row.bounded for row in median_rows("another", found(), held))
