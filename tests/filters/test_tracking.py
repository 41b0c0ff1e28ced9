"""Following whole trials: where the filter starts, what it does when it loses everything, and its accelerations."""

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import SETTLING_S, WarmStart
from mbkf.filters.tracking import track
from mbkf.filters.tracking_filter import TrackingFilter
from tests.motions import (
    angle_errors,
    marker_positions,
    protocol_sensor,
    reference_model,
    smooth_motion,
    worst,
)

MODEL = reference_model()
NV = MODEL.nv
RATE_HZ = 100.0
FRAMES = 80
SETTLED = round(SETTLING_S * RATE_HZ)


def kalman(**settings):
    sensor, _ = protocol_sensor(MODEL)
    return KinematicFilter(
        sensor, np.full(36, 0.005), 1 / RATE_HZ, np.zeros(NV, bool), KinematicSettings(**settings)
    )


def follow(measured, **options):
    """A trial of markers (T, M, 3) through the kinematic filter."""
    one = kalman()
    return track(
        TrackingFilter(KinematicReport(one), WarmStart(one)),
        Recording(measured, np.zeros((len(measured), 0, 6)), 1 / RATE_HZ),
        **options,
    )


LAG_S = 0.05
"""A constant-velocity plant trails a changing velocity by its acceleration times the filter's memory."""


@pytest.fixture(scope="module")
def motion():
    q, v, a = smooth_motion(MODEL, np.random.default_rng(1)).frames(FRAMES, RATE_HZ)
    return q, v, a, marker_positions(protocol_sensor(MODEL)[0], q)


@pytest.fixture(scope="module")
def followed(motion):
    return follow(motion[3], keep_covariance=True)


def test_a_clean_trial_is_followed_from_the_first_frame(motion, followed):
    assert followed.starts == (0,)
    assert followed.tracked.all()
    assert not followed.rejected.any()
    assert worst(angle_errors(MODEL, followed.q, motion[0])) < 0.03
    assert worst(followed.v - motion[1]) < LAG_S * worst(motion[2])


def test_a_run_that_is_ended_leaves_later_frames_blank(motion, followed):
    seen = []

    def goes_on(t, posterior):
        seen.append((t, posterior.q))
        return t < 10

    ended = follow(motion[3], filtered=goes_on)
    assert [t for t, _ in seen] == list(range(11))
    np.testing.assert_array_equal([q for _, q in seen], followed.q[:11])
    np.testing.assert_array_equal(ended.q[:10], followed.q[:10])
    assert np.isnan(ended.q[11:]).all() and not ended.tracked[11:].any()


def test_the_first_frame_already_knows_its_velocity(motion, followed):
    """The warm start's backward run: no transient from rest."""
    error = worst(followed.v[0] - motion[1][0])
    assert error < LAG_S * worst(motion[2])
    assert error < 0.6 * worst(motion[1][0])


def test_accelerations_are_differences_of_velocities(followed):
    """Thesis eq. 3.7 once the filter has settled."""
    expected = np.diff(followed.v, axis=0) * RATE_HZ
    np.testing.assert_allclose(followed.a[SETTLED + 1 :], expected[SETTLED:], rtol=1e-13, atol=1e-12)
    assert np.isfinite(followed.a).all()


def test_spreads_are_those_of_the_covariance(followed):
    variance = np.diagonal(followed.covariance, axis1=1, axis2=2)
    np.testing.assert_allclose(followed.sd_q**2, variance[:, :NV], rtol=1e-12)
    np.testing.assert_allclose(followed.sd_v**2, variance[:, NV:], rtol=1e-12)
    started = np.arange(FRAMES) == 0
    assert np.isnan(followed.torque_sd[started]).all()
    assert np.isfinite(followed.torque_sd[~started]).all()


def test_covariances_are_kept_only_on_request(motion):
    assert follow(motion[3][:5]).covariance is None


def test_every_reading_is_counted(followed):
    np.testing.assert_array_equal(followed.nis_readings[1:], 3 * 36)
    assert np.isnan(followed.nis[0])
    assert (followed.nis[1:] >= 0).all()


def test_a_short_loss_is_bridged(motion, followed):
    measured = motion[3].copy()
    measured[30:40] = np.nan
    result = follow(measured)
    assert result.starts == (0,)
    np.testing.assert_array_equal(np.flatnonzero(~result.tracked), np.arange(30, 40))
    assert np.isfinite(result.q).all()
    before, after = (result.sd_q[t, 0] for t in (29, 39))
    assert after > 5 * before


def test_after_a_total_loss_the_filter_starts_anew(motion):
    measured = motion[3].copy()
    measured[20:60] = np.nan  # 0.4 s, twice as long as it waits
    result = follow(measured)
    assert result.starts == (0, 60)
    np.testing.assert_array_equal(np.flatnonzero(~result.tracked), np.arange(20, 60))
    assert worst(angle_errors(MODEL, result.q[60:], motion[0][60:])) < 0.1
    assert np.isnan(result.nis[60])


def test_frames_before_the_first_markers_are_nan(motion):
    measured = motion[3].copy()
    measured[:12] = np.nan
    result = follow(measured)
    assert result.starts == (12,)
    assert not result.tracked[:12].any()
    for name in ("q", "v", "a", "sd_q", "sd_v", "angle_sd", "nis", "step_seconds"):
        assert np.isnan(getattr(result, name)[:12]).all(), name
    assert np.isfinite(result.q[12:]).all()
    assert worst(angle_errors(MODEL, result.q[12:], motion[0][12:])) < 0.03


def test_a_trial_of_one_frame(motion):
    result = follow(motion[3][:1])
    assert result.starts == (0,)
    np.testing.assert_array_equal(result.v, 0.0)
    np.testing.assert_array_equal(result.a, 0.0)


def test_an_outlier_is_refused_in_its_frame_alone(motion):
    measured = motion[3].copy()
    measured[40, 7] += [0.0, 0.0, 0.4]
    result = follow(measured)
    assert np.argwhere(result.rejected).tolist() == [[40, 7]]
    assert result.nis_readings[40] == 3 * 35


@pytest.mark.parametrize("markers", [5, 0])
def test_too_few_markers_cannot_be_followed(motion, markers):
    measured = motion[3].copy()
    measured[:, markers:] = np.nan
    with pytest.raises(NotObservable, match="in no frame do the markers fit"):
        follow(measured[:10])


def test_markers_of_nobody_cannot_be_followed():
    with pytest.raises(NotObservable, match="unit"):
        follow(np.random.default_rng(2).uniform(-2, 2, (3, 36, 3)))


def test_markers_in_another_unit_cannot_be_followed(motion):
    with pytest.raises(NotObservable, match="unit"):
        follow(1000 * motion[3][:3])


def test_the_result_does_not_depend_on_where_and_which_way_the_body_moves(motion, followed):
    c, s = np.cos(2.0), np.sin(2.0)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    result = follow(motion[3] @ turn.T + [3.0, -2.0, 0.5])
    np.testing.assert_allclose(result.q[:, 7:], followed.q[:, 7:], rtol=0, atol=1e-11)
    np.testing.assert_allclose(result.v, followed.v, rtol=0, atol=2e-9)


def test_progress_reaches_the_last_frame(motion):
    told = []
    follow(motion[3][:30], progress=lambda *step: told.append(step))
    assert told[-1] == (30, 30)
