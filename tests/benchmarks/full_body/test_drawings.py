"""The study's figures are drawn from its numbers."""

from dataclasses import replace

import numpy as np

from benchmarks.full_body.drawings import squat_drawings, survey_drawings, with_truth
from benchmarks.full_body.filters import FCDI
from benchmarks.full_body.real import RealScores, real_findings
from benchmarks.full_body.trials import LOST
from tests.benchmarks.full_body.conftest import made_survey

REAL = [
    RealScores(capture, name, 5.0, 1.0, 3.0, 2.0, 0.1, 40.0, residual, 0.2, 0)
    for capture, residual in (("a walk", 10.0), ("b run", 20.0))
    for name in ("FCDI", "dynamic")
]


def test_bars_show_the_pooled_numbers():
    drawn = list(survey_drawings(made_survey({"dynamic": 0.5}), REAL))
    assert len({one.file for one in drawn}) == len(drawn) == 3
    first = drawn[0].figure.axes[0]
    heights = [patch.get_height() for patch in first.patches]
    assert len(heights) == 4 * 5
    assert np.isclose(heights[-1] / heights[0], 0.5)


def test_a_lost_capture_shows_no_numbers():
    gone = RealScores("a walk", "FDMC as printed", np.inf, np.inf, np.inf, np.inf, np.inf, 1.0, 2.0, 0.1, 90)
    sheet = real_findings([*REAL, gone]).sheets[0]
    assert sheet.rows[-1][1] == "FDMC as printed (lost the trial)"
    assert np.isnan(sheet.rows[-1][2])
    assert sheet.rows[-1][-1] == 90.0


def test_a_trial_s_figures_hold_truth_and_filters(short_squat):
    trial, run = short_squat
    lost = replace(trial, movement=LOST)
    drawn = list(squat_drawings(*(with_truth(one, {FCDI: run}) for one in (trial, lost))))
    assert [one.number for one in drawn] == ["4.9", "4.10", "4.11", "4.12", "4.13", "4.14"]
    lines = drawn[0].figure.axes[0].lines
    assert [line.get_label() for line in lines] == [FCDI, "truth"]
    np.testing.assert_array_equal(lines[0].get_xdata(), run.times_s)
    assert np.ptp(lines[1].get_ydata()) > 30.0
    assert not drawn[2].figure.axes[0].patches
    assert len(drawn[5].figure.axes[0].patches) == 1
