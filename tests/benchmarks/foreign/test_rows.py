"""Rows: a score inside its bounds passes all of them, and each number outside fails its own row."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.checks import Check
from benchmarks.foreign.errors import Judged, Series
from benchmarks.foreign.rows import CHOSEN_ON, bounded_rows, calibration_rows, smoothing_rows, static_rows
from benchmarks.foreign.score import AngleScore, OffsetScore, Score

GOOD = AngleScore(2.0, 1.0, 0.94, 0.94, 0.03, 2.0)
SCORE = Score(
    GOOD, {"legs": GOOD, "lumbar": GOOD}, GOOD, OffsetScore(1.0, 1.0, 2.0),
    dict.fromkeys(("hip", "knee", "ankle"), 9.0), 0.05, 0.93, 1.0,
)  # fmt: skip


def failed(score: Score) -> list[str]:
    rows: list[Check] = [
        *bounded_rows("p", score, CHOSEN_ON),
        *calibration_rows("p", score),
        *static_rows("s", score),
    ]
    return [row.name for row in rows if not row.passed]


def test_good_scores_pass() -> None:
    assert failed(SCORE) == []


@pytest.mark.parametrize(
    ("score", "name"),
    [
        (replace(SCORE, offsets=OffsetScore(1.0, 1.6, 2.0)), "p: hip-flexion offset, sd between motions"),
        (replace(SCORE, centres_mm={"hip": 13.0, "knee": 0.0, "ankle": 0.0}), "p: hip centre, RMS"),
        (replace(SCORE, legs=replace(GOOD, varying=1.5)), "p: angles of legs without their means, RMS"),
        (replace(SCORE, legs=replace(GOOD, cover=0.89)), "p: legs, share in 95 % intervals, at least"),
        (replace(SCORE, legs=replace(GOOD, varying_cover=0.98)), "p: legs, share in 95 % intervals, varying, at most"),
        (replace(SCORE, groups={"lumbar": replace(GOOD, cover=0.8)}), "p: lumbar, share in 95 % intervals, at least"),
        (replace(SCORE, angles=replace(GOOD, calibration=0.06)), "p: expected calibration error of angles"),
        (replace(SCORE, moment=0.1), "p: moments of legs, RMS"),
        (replace(SCORE, moment_cover=0.8), "p: moments of legs, share in 95 % intervals, at least"),
        (replace(SCORE, moment_nees=3.0), "p: moments of legs, NEES, at most"),
    ],
)  # fmt: skip
def test_each_number_outside_fails_its_row(score: Score, name: str) -> None:
    assert failed(score) == [name]


def test_static_persons_have_a_bound_of_their_own() -> None:
    assert failed(replace(SCORE, legs=replace(GOOD, cover=0.87)))[1:] == ["s: legs, share in 95 % intervals"]


def test_a_trial_that_smoothing_makes_worse_fails_by_name() -> None:
    def moments(motion: str, error: list[float]) -> Judged:
        values = np.array(error)
        series = Series("one", motion, "legs", "knee_angle_r", values, values, values)
        return Judged("one", motion, (), (series,), {})

    smoothed = [moments("walk", [1.0, 1.0, np.nan]), moments("run", [3.0, 3.0, 9.0])]
    causal = [moments("walk", [2.0, 2.0, 50.0]), moments("run", [2.0, 2.0, np.nan])]
    (row,) = smoothing_rows("p", smoothed, causal)
    assert "one, run" in row.name
    assert row.value == pytest.approx(1.5)
    assert not row.passed
    assert smoothing_rows("p", smoothed[:1], causal[:1])[0].passed
