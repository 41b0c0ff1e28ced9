"""The paper's windows, threshold and weights."""

import numpy as np
import pytest

from benchmarks.inertial.cubic_steps import cubic_steps
from benchmarks.stride_paper import printed
from benchmarks.stride_paper.choices import Separation, choice_findings, motion
from benchmarks.stride_paper.choices import _separation as separation
from benchmarks.stride_paper.choices import _threshold_claim as threshold_claim


def test_windows_know_how_long_they_move():
    share = motion(cubic_steps(), printed.simulated("clean", 5))
    moving = np.flatnonzero(share)
    assert list(moving) == [4, 5, 6, 7, 8, 9, 14, 15, 16, 17, 18, 19]
    assert share[5] == 1.0
    assert 0.4 <= share[4] <= 0.6


def test_aligned_windows_part_rest_from_motion_and_others_do_not():
    aligned, misled = separation(0, 2), separation(7, 2)
    assert aligned.resting < 0.2
    assert aligned.moving > 1.3
    assert misled.moving < 0.3


def test_a_threshold_between_rest_and_motion_needs_no_change():
    good = [Separation(first, 0.1, 1.4) for first in range(10)]
    assert threshold_claim(good).verdict == "reproduced"
    assert "10 of 10 phases" in threshold_claim(good).measured
    bad = [Separation(first, 0.1, 0.4) for first in range(10)]
    assert threshold_claim(bad).verdict == "differs"


def test_every_choice_has_its_verdict(monkeypatch):
    monkeypatch.setattr("benchmarks.stride_paper.choices.SEEDS", 1)
    found = choice_findings(1)
    assert all(band.kept for band in found.bands)
    verdicts = {claim.statement: claim.verdict for claim in found.claims}
    assert list(verdicts.values()) == [
        "reproduced", "reproduced", "differs", "reproduced", "reproduced", "differs"
    ]  # fmt: skip
    sizes = {row[1]: row for row in found.sheets[1].rows}
    assert sizes["5 samples, 0.1 s"][-1] > sizes["10 samples, 0.2 s"][-1]
    assert sizes["20 samples, 0.2 s"][2] == pytest.approx(sizes["10 samples, 0.2 s"][2], rel=0.05)
