"""The study's figures are drawn from its numbers."""

import numpy as np
import pytest

from benchmarks.full_body.drawings import survey_drawings, thesis_drawings
from benchmarks.full_body.real import RealScores, real_findings
from benchmarks.full_body.trials import JUMP
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
    gone = RealScores("a walk", "FDMC, as printed", np.inf, np.inf, np.inf, np.inf, np.inf, 1.0, 2.0, 0.1, 90)
    sheet = real_findings([*REAL, gone]).sheets[0]
    assert sheet.rows[-1][1] == "FDMC, as printed (lost the trial)"
    assert np.isnan(sheet.rows[-1][2])
    assert sheet.rows[-1][-1] == 90.0


@pytest.mark.slow
def test_the_jump_s_figure_holds_truth_and_filters():
    from benchmarks.dynamic.methods import in_turn

    drawn = list(thesis_drawings(in_turn, (JUMP,)))
    assert [one.number for one in drawn] == ["4.15"]
    labels = [line.get_label() for line in drawn[0].figure.axes[0].lines]
    assert labels[-1] == "truth"
    assert len(labels) == 4
