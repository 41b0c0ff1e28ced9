"""The inertial benchmark's own parts: faults that are put in are told, and errors are measured against the truth."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.inertial.body import SAGITTAL, _angle_rows, worn
from benchmarks.inertial.orientation import _FAULTS
from mbkf.imu.checks import problems
from mbkf.trial.inertial.synth import BodyMotion
from tests.dynamics import trial
from tests.imu.turning import turning

MADE = turning(12.0, rate_rad_s=2.0)
NOISE = np.random.default_rng(0).normal(0.0, 0.01, MADE.gyro.shape)
ONE = MADE.readings(gyro=MADE.gyro + NOISE, force=MADE.force + NOISE)


@pytest.mark.parametrize("kind", _FAULTS)
def test_faults_are_told_by_their_kind(kind):
    assert kind.split()[0] in {problem.kind for problem in problems(_FAULTS[kind](ONE))}
    assert kind.split()[0] not in {problem.kind for problem in problems([replace(ONE)])}


def test_angles_are_judged_against_the_motion_they_were_made_from():
    one = trial("walk")
    motion = BodyMotion(one.model, one.motion.times_s, one.motion.q, one.motion.v, one.motion.a)
    rows = list(_angle_rows(worn("walk", motion, one.model.neutral()), long=False))
    bounded = [row for row in rows if row.bounded]
    assert [row.name for row in bounded] == [f"walk, {name}" for name in SAGITTAL]
    assert all(row.passed for row in bounded)
