"""The calibration page: curves of known errors, tables side by side, failures listed worst first."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.foreign.calibration import FIGURE, PAGE, curve, page, write_page
from benchmarks.foreign.errors import GROUPS, Judged, Series
from benchmarks.foreign.score import LEVELS

SAMPLES = 4000


def person(name: str, motion: str = "walk", offset: float = 0.0) -> Judged:
    """Normal errors of 2°, with their deviation, about a mean error in degrees."""
    rng = np.random.default_rng(8)
    sd = np.full(SAMPLES, 2.0)
    angles = tuple(
        Series(name, motion, group, angle, offset + rng.normal(0.0, 2.0, SAMPLES), sd, 0.5 * sd)
        for group, names in GROUPS.items()
        for angle in names
    )
    return Judged(
        name, motion, angles, (), {(joint, "r"): np.full(9, 0.01) for joint in ("hip", "knee", "ankle")}
    )


SETS = {"first": [person("anna"), person("anna", "squat")], "second": [person("long_legs", offset=15.0)]}


def test_curve_of_calibrated_errors_is_the_diagonal() -> None:
    np.testing.assert_allclose(curve(SETS["first"], "lumbar", varying=False), LEVELS, atol=0.02)
    assert (curve(SETS["first"], "lumbar", varying=True) < LEVELS - 0.03).all()
    assert curve(SETS["second"], "elbow", varying=False).max() < 0.01


def test_tables_stand_side_by_side() -> None:
    lines = list(page(SETS))
    (joint,) = [line for line in lines if line.startswith("| elbow flex |")]
    cells = joint.split("|")[2:4]
    assert cells[0].split(", ")[1:3] == ["2.0", "95 %"]
    assert cells[1].split(", ")[2] == "0 %"
    (squat,) = [line for line in lines if line.startswith("| squat |")]
    assert squat.endswith("|  |")


def test_failures_are_counted_and_listed() -> None:
    lines = list(page(SETS))
    angles = sum(map(len, GROUPS.values()))
    assert any(line.startswith(f"{angles} of {3 * angles} curves") for line in lines)
    listed = [line for line in lines if line.startswith("| second | long legs, walk |")]
    assert len(listed) == 15
    assert all(float(line.split("|")[5]) == pytest.approx(15.0, abs=0.2) for line in listed)


def test_page_and_figure_are_written(tmp_path: Path) -> None:
    write_page(tmp_path, tmp_path, SETS)
    assert (tmp_path / PAGE).read_text(encoding="utf-8").startswith("# Calibration\n")
    drawn = (tmp_path / FIGURE).read_text(encoding="utf-8")
    assert "<svg" in drawn
