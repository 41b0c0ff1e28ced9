"""Strides compared with those of cameras."""

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from benchmarks.inertial.stride import measured_rows
from benchmarks.inertial.stride_measured import Compared, ReferenceStride, matched
from mbkf.trial.inertial.stride import measure_strides


@pytest.fixture(scope="module")
def foot():
    walk = foot_walk((1.2, 0.8), force_noise_m_s2=0.02, rate_noise_rad_s=0.005)
    return measure_strides([walk.readings]).feet[0]


def test_a_stride_is_measured_between_our_own_rests(foot):
    for shift in (-0.2, 0.0, 0.2):  # of the reference's events
        length, sd = matched(foot, ReferenceStride("left_foot", 1.3 + shift, 2.4 + 0.5 * shift, 0.0))
        assert length == pytest.approx(1.2, abs=0.02)
        assert 0.0 < sd < 0.2


def test_a_reference_stride_over_two_of_ours_is_their_sum(foot):
    assert matched(foot, ReferenceStride("left_foot", 1.2, 4.0, 0.0))[0] == pytest.approx(2.0, abs=0.03)


def test_a_stride_without_its_rests_is_missed(foot):
    assert np.isnan(matched(foot, ReferenceStride("left_foot", 2.4, 2.5, 0.0))[0])
    assert np.isnan(matched(foot, ReferenceStride("left_foot", 1.2, 9.0, 0.0))[0])


def test_scores_leave_missed_strides_out_and_count_them():
    one = Compared(
        "smoother", np.array([1.0, 1.3, np.nan]), np.array([0.1, 0.1, np.nan]), np.ones(3), np.ones(1)
    )
    assert one.found == 2
    assert one.rmse_mm == pytest.approx(300.0 / np.sqrt(2.0))
    assert one.mean_mm == pytest.approx(150.0)
    assert one.normalised == pytest.approx(4.5)
    rows = {row.name: row.passed for row in measured_rows([one])}
    assert not rows["gaitmap foot, smoother: strides found of 3"]
    assert not rows["gaitmap foot, smoother: RMSE"]
    assert not rows["gaitmap foot, smoother: |mean error|"]
