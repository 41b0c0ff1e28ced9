"""The benchmark of motions on other models: its measures."""

import numpy as np
import pytest

from benchmarks.bridges.opensim_onto import CASES, TURNS, worst_angle


def test_a_constant_difference_is_no_error_and_the_largest_change_counts():
    names = ("pelvis_tilt", "hip_flexion_r", "hip_rotation_l")
    other = np.zeros((4, 3))
    q = np.deg2rad([[9.0, 5.0, 1.0], [-9.0, 5.0, -1.0], [9.0, 5.0, 1.0], [-9.0, 5.0, -1.0]])
    assert worst_angle(names, q, other) == (pytest.approx(1.0), "hip_rotation_l")
    q[:2, 1] += np.deg2rad(4.0)
    assert worst_angle(names, q, other) == (pytest.approx(2.0), "hip_flexion_r")
    assert worst_angle(names, q, other, TURNS)[1] == "hip_rotation_l"


def test_poses_of_a_capture_belong_to_a_model_of_the_capture():
    assert all(case.model is not None for case in CASES.values() if case.poses is not None)
