"""Newton's law of markers alone: what is missing is told in body weights, and noise for what it is."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.checks.newton import expected_force, newton_findings
from tests.checked import evidence


def test_the_true_motion_lacks_nothing():
    force, moment = newton_findings(evidence())
    assert force.verdict == moment.verdict == "inside"
    assert force.value < 3.0 and moment.value < 1.0


def test_a_missing_wrench_is_told_in_body_weights():
    given = evidence("squat")
    exact = replace(given, asked=given.total.copy())
    force, moment = newton_findings(exact)
    assert force.value == pytest.approx(0.0, abs=1e-9) and moment.value == pytest.approx(0.0, abs=1e-9)
    off = np.zeros(6)
    off[[0, 2, 4]] = [0.12 * given.weight_n, 0.16 * given.weight_n, 0.07 * given.weight_n]
    force, moment = newton_findings(replace(exact, asked=exact.total + off))
    assert force.value == pytest.approx(20.0) and moment.value == pytest.approx(7.0)
    assert force.verdict == moment.verdict == "outside"


def test_more_is_expected_of_who_moves_more():
    squat = evidence("squat")
    still = np.zeros_like(squat.asked)
    still[:, 2] = squat.weight_n
    frames = squat.clear
    assert expected_force(replace(squat, asked=still), frames) == pytest.approx(0.025 * squat.weight_n)
    assert expected_force(squat, frames) > 0.025 * squat.weight_n


def test_without_frames_it_is_not_judged():
    given = evidence(read=())
    assert {one.verdict for one in newton_findings(given)} == {"not judged"}
