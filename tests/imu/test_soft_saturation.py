"""Soft clipping is found where gravity turns faster; steady turns and sound sensors are not accused."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.imu.checks import problems
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.soft_saturation import missing_turn_variance, soft_limits
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings

RATE_HZ = 100.0
TIME = np.arange(2000) / RATE_HZ
LIMIT = 7.3


def rocking(largest_rad_s):
    """A sensor that rocks about its x axis, with noise."""
    angle = largest_rad_s / 4.0 * np.sin(4.0 * TIME)
    gyro = np.zeros((len(TIME), 3))
    gyro[:, 0] = largest_rad_s * np.cos(4.0 * TIME)
    force = Rotation.from_rotvec(np.outer(angle, [1.0, 0.0, 0.0])).inv().apply([0.0, 0.0, 9.80665])
    noise = np.random.default_rng(0).normal(0.0, 0.01, (2, *gyro.shape))
    return ImuReadings("a", TIME, force + noise[0], gyro + noise[1], None, RATE_HZ)


def clipped(one):
    """Readings beyond the limit spread over the last hundredth below it."""
    rates = one.angular_velocity_rad_s.copy()
    over = np.abs(rates[:, 0]) > LIMIT
    below = LIMIT * (1.0 - 0.008 * np.random.default_rng(1).random(over.sum()))
    rates[over, 0] = np.sign(rates[over, 0]) * below
    return replace(one, angular_velocity_rad_s=rates), over


def test_a_soft_limit_is_found_on_both_sides_with_its_share():
    one, over = clipped(rocking(12.0))
    upper, lower = soft_limits(one)
    assert (upper.axis, round(upper.limit_rad_s, 1), round(lower.limit_rad_s, 1)) == (0, LIMIT, -LIMIT)
    assert abs((upper.reached | lower.reached).sum() - over.sum()) < 0.05 * over.sum()
    texts = [problem.text for problem in problems([one]) if problem.kind == "saturated"]
    assert len(texts) == 2
    assert "clips softly at 418" in texts[0]
    assert f"{upper.reached.mean():.1%}" in texts[0]


def test_steady_turns_and_swings_below_the_limit_are_sound():
    assert soft_limits(rocking(7.2)) == ()
    steady = rocking(0.0)
    turn = Rotation.from_rotvec(np.outer(LIMIT * TIME, [1.0, 0.0, 0.0]))
    force = turn.inv().apply([0.0, 0.0, 9.80665])
    rates = steady.angular_velocity_rad_s + np.array([LIMIT, 0.0, 0.0])
    assert soft_limits(replace(steady, specific_force_mps2=force, angular_velocity_rad_s=rates)) == ()


def test_readings_that_a_logger_holds_are_no_saturation():
    one = rocking(7.2)
    rates = np.repeat(one.angular_velocity_rad_s[::3], 3, axis=0)[: len(TIME)]
    held = replace(one, angular_velocity_rad_s=rates)
    assert [problem for problem in problems([held]) if problem.kind == "saturated"] == []


def test_spreads_grow_with_soft_clipping():
    sound = rocking(12.0)
    (before,) = orientations([sound], frame="NWU")
    (after,) = orientations([clipped(sound)[0]], frame="NWU")
    assert after.sd_rad[500:, :2].mean() > 5.0 * before.sd_rad[500:, :2].mean()


def test_a_real_trial_is_reported_and_its_tilt_is_within_its_spread(real_data):
    folder = real_data / "strangers3"
    (one,) = read_imu(folder / "gyro_soft_saturation_TStick05_30s_flat.csv")
    assert [(limit.axis, round(limit.limit_rad_s, 2)) for limit in soft_limits(one)] == [
        (0, 7.27),
        (0, -7.36),
    ]
    (trial,) = read_imu(folder / "repoimu_two_row_header_TStick05_12s.csv")
    (course,) = orientations([trial], frame="NWU", settings=OrientSettings("smooth"))
    up = Rotation.from_quat(trial.orientation).inv().apply([0.0, 0.0, 1.0])
    off = Rotation.from_quat(course.quaternion).apply(up)[400:, :2]
    ratio = np.sqrt((off**2).mean() / (course.sd_rad[400:, :2] ** 2).mean())
    assert 0.5 < ratio < 1.5


def test_two_axes_that_end_at_one_size_need_no_gravity():
    """A foot's force is no gravity; its two axes clip at the range of the gyroscope."""
    one = rocking(12.0)
    force = np.full_like(one.specific_force_mps2, 5.0)
    rates, noise = np.zeros_like(force), 0.005 * np.random.default_rng(2).random(len(TIME))
    rates[:, 0] = np.clip(one.angular_velocity_rad_s[:, 0], 0.0, 0.5 * LIMIT) * (1.0 - noise)
    rates[:, 1] = np.roll(rates[:, 0], 50)
    silent = replace(one, specific_force_mps2=force, angular_velocity_rad_s=rates)
    assert [limit.axis for limit in soft_limits(silent)] == [0, 1]
    alone = replace(silent, angular_velocity_rad_s=rates * [1.0, 0.0, 0.0])
    assert soft_limits(alone) == ()


def test_the_missing_turn_follows_from_how_steeply_peaks_reach_the_limit():
    """Peaks of 12 rad/s cut at 7.3: the turn that all samples of a peak miss together."""
    whole = rocking(12.0)
    one, over = clipped(whole)
    variance = missing_turn_variance(one)
    assert (variance[np.abs(whole.angular_velocity_rad_s[:, 0]) < 0.95 * LIMIT] == 0.0).all()
    assert (variance[:, 1:] == 0.0).all()
    missed = np.abs(whole.angular_velocity_rad_s - one.angular_velocity_rad_s)[over, 0].sum() / RATE_HZ
    peaks = np.diff(over.astype(int)).clip(0).sum() + over[0]
    assert 0.5 < np.sqrt(variance.sum() / peaks) / (missed / peaks) < 1.2
    assert missing_turn_variance(whole) is None
