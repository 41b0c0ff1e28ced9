"""Errors of legs: the largest of a side, over the frames that count, against right results."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.verdict.errors import ANGLES, Right, errors, right_of

FRAMES = 4


def result(angles=None, torques=None, valid=(True, True, True, False)):
    zero = np.zeros(FRAMES)
    angles, torques = angles or {}, torques or {}
    return SimpleNamespace(
        tracked=np.ones(FRAMES, dtype=bool),
        valid=np.array(valid),
        subject=SimpleNamespace(mass_kg=50.0),
        angle=lambda name: angles.get(name, zero),
        moment=lambda name: torques.get(name, zero),
    )


def test_errors_are_those_of_the_worst_joint_by_side():
    right = Right({name: np.zeros(FRAMES) for name in ANGLES}, {name: np.zeros(FRAMES) for name in ANGLES})
    turned = {"hip_flexion_r": np.full(FRAMES, np.radians(4.0)), "knee_angle_l": np.full(FRAMES, 2.0 * np.pi)}
    angle, torque = errors(result(turned, {"ankle_angle_l": np.array([0.0, 0.0, 30.0, 900.0])}), right)
    assert angle == {"right_leg": pytest.approx(4.0), "left_leg": pytest.approx(0.0)}
    assert torque == {"right_leg_loads": 0.0, "left_leg_loads": pytest.approx(0.6 / np.sqrt(3.0))}


def test_right_torques_are_known_in_frames_that_count():
    right = right_of(result(torques={"hip_flexion_r": np.full(FRAMES, 100.0)}))
    np.testing.assert_array_equal(right.torques["hip_flexion_r"], [2.0, 2.0, 2.0, np.nan])
