"""How strides are compared with the cameras', and what the page shows."""

import numpy as np
import pytest

from benchmarks.inertial.cubic_steps import CASES, cubic_steps
from benchmarks.inertial.stride import measured_rows, study_rows
from benchmarks.inertial.stride_measured import Compared, ReferenceStride, matched
from benchmarks.inertial.stride_page import write_page
from benchmarks.inertial.stride_study import (
    KALMAN,
    KEY_POINTS,
    KEY_POINTS_WITH_BIAS,
    PHASES,
    kalman_errors,
    key_point_errors,
    measure_study,
    settings_of,
)
from mbkf.trial.inertial.stride import measure_strides
from tests.foot_walks import foot_walk


@pytest.fixture(scope="module")
def foot():
    walk = foot_walk((1.2, 0.8), force_noise_m_s2=0.02, rate_noise_rad_s=0.005)
    return measure_strides([walk.readings]).feet[0]


@pytest.fixture(scope="module")
def study():
    return measure_study([0])


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


def test_the_phase_of_the_windows_decides_for_key_points_and_not_for_the_filter():
    walk = cubic_steps()
    errors = [key_point_errors(walk, settings_of(KEY_POINTS, "clean", first))[0] for first in PHASES]
    assert max(errors) > 1.0
    assert errors[0] < 0.15
    assert max(kalman_errors(cubic_steps(delay_s=delay))[0] for delay in (0.0, 0.05, 0.13)) < 0.03


def test_every_method_case_and_phase_is_measured(study):
    assert set(study.errors) == {(m, c) for m in (KEY_POINTS, KEY_POINTS_WITH_BIAS, KALMAN) for c in CASES}
    assert {len(found) for found in study.errors.values()} == {10}
    judged = [row for row in study_rows(study, 1) if row.bounded]
    assert len(judged) == 16


def test_the_page_shows_everything(study, tmp_path):
    lengths = np.array([1.1, 1.2, 0.9])
    compared = [
        Compared(name, lengths, np.full(3, 0.05), lengths + 0.01, np.full(4, 0.25))
        for name in ("smoother", "filter")
    ]
    checks = [*study_rows(study, 1), *measured_rows(compared)]
    write_page(tmp_path, study, compared, checks)
    page = (tmp_path / "stride.html").read_text(encoding="utf-8")
    assert page.count("data:image/svg+xml;base64,") == 4
    assert all(str(value) in page for value in (0.32, 0.49, 0.47, 0.64))
    assert page.count("<span class='good'>pass</span>") == sum(c.passed for c in checks if c.bounded)
