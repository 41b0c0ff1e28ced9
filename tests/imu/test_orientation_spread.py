"""Stated spreads: offsets that turn with the sensor, late fields, late samples; each against its own closed form."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.imu.frames import exponential, rotate
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.orientation_ekf import OrientationSettings
from mbkf.imu.orientation_spread import heading_memory_s, stated_sd, tilt_memory_s
from mbkf.io.imu.readings import ImuReadings

RATE = 50.0
FIELD = np.array([20.0, 0.0, -40.0])
NOTHING = OrientationSettings(
    accelerometer_offset_mps2=0.0, field_offset=0.0, field_direction_sd_rad=0.0, field_delay_s=0.0, clock_sd_s=0.0
)  # fmt: skip


def spread(settings, axis=(0.0, 0.0, 0.0), seconds=600.0, field=False, smooth=True, lost=()):
    """Stated sd (T, 3) of a sensor that turns steadily about an axis of the world, of a filter that is sure."""
    samples = round(seconds * RATE)
    turns = np.arange(samples)[:, None] / RATE * np.array(axis)
    local = np.tile(np.array(axis), (samples, 1))  # a steady turn has one axis in world and sensor
    seen = None
    if field:
        seen = rotate(exponential(-turns), np.tile(FIELD, (samples, 1)))
        seen[list(lost)] = np.nan
    return stated_sd(np.zeros((samples, 3)), exponential(turns), local, seen, RATE, settings, smooth=smooth)


@pytest.mark.parametrize("smooth", [True, False])
def test_an_offset_tilts_a_sensor_that_keeps_its_direction_by_its_share_of_gravity(smooth):
    sd = spread(replace(NOTHING, accelerometer_offset_mps2=0.1), smooth=smooth)
    np.testing.assert_allclose(sd[:, :2], 0.1 / GRAVITY_M_S2, rtol=1e-9)
    np.testing.assert_array_equal(sd[:, 2], 0.0)


def test_a_turn_averages_offsets_across_its_axis_and_keeps_the_one_along_it():
    """About north: the offset along north stays there, and tilts about west."""
    sd = spread(replace(NOTHING, accelerometer_offset_mps2=0.1), axis=(8.0, 0.0, 0.0))[15000]
    assert sd[1] == pytest.approx(0.1 / GRAVITY_M_S2, rel=1e-3)
    assert sd[0] < 0.05 * sd[1]


def test_an_offset_of_the_accelerometer_errs_as_it_is_stated():
    offset = np.array([0.0, 0.1, 0.0])
    times = np.arange(1500) / RATE
    force = np.tile(offset + np.array([0.0, 0.0, GRAVITY_M_S2]), (1500, 1))
    one = ImuReadings("a", times, force, np.zeros_like(force), None, RATE)
    settings = OrientSettings("smooth", ekf=replace(NOTHING, accelerometer_offset_mps2=0.1))
    (course,) = orientations([one], frame="NWU", settings=settings)
    (sure,) = orientations([one], frame="NWU", settings=replace(settings, ekf=NOTHING))
    lasting = np.sqrt(course.sd_rad[750, 0] ** 2 - sure.sd_rad[750, 0] ** 2)
    assert abs(2.0 * course.quaternion[750, 0]) == pytest.approx(lasting, rel=1e-3)


def test_times_that_are_late_err_by_the_turn_in_between():
    sd = spread(replace(NOTHING, clock_sd_s=0.003), axis=(1.0, -2.0, 4.0))
    np.testing.assert_allclose(sd, np.tile([0.003, 0.006, 0.012], (len(sd), 1)), rtol=1e-9)


@pytest.mark.parametrize("lost", [(), range(0, 30000, 2), range(30000)])
def test_an_offset_of_the_magnetometer_bends_headings_by_its_share_of_the_level_field(lost):
    sd = spread(replace(NOTHING, field_offset=0.01), field=True, lost=lost)[15000]
    seen = len(lost) < 30000
    assert sd[2] == pytest.approx(0.01 * np.sqrt(5.0) if seen else 0.0, rel=1e-6)
    np.testing.assert_array_equal(sd[:2], 0.0)


def test_a_field_that_is_late_turns_with_the_sensor():
    """About the vertical by τ ω; about north the steep part of the field turns, by τ ω times the tangent of its dip."""
    late = replace(NOTHING, field_delay_s=0.01)
    up, north = (spread(late, axis=axis, field=True)[15000, 2] for axis in ((0.0, 0.0, 2.0), (2.0, 0.0, 0.0)))
    assert up == pytest.approx(0.02, rel=1e-6)
    assert north == pytest.approx(0.04, rel=1e-6)


def test_a_lasting_bend_is_part_of_headings_that_have_a_field():
    bent = replace(NOTHING, field_direction_sd_rad=0.05)
    np.testing.assert_allclose(spread(bent, field=True)[:, 2], 0.05, rtol=1e-9)
    np.testing.assert_array_equal(spread(bent)[:, 2], 0.0)


def test_what_is_stated_at_once_does_not_depend_on_later_samples():
    settings = OrientationSettings()
    whole = spread(settings, (0.3, 1.0, 0.2), 60.0, field=True, smooth=False)
    part = spread(settings, (0.3, 1.0, 0.2), 20.0, field=True, smooth=False)
    np.testing.assert_allclose(whole[: len(part)], part, rtol=1e-9)


def test_the_filters_own_spread_is_scaled_and_adds_to_the_rest():
    still = np.zeros((3, 3))
    upright = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
    settings = replace(NOTHING, spread_scale=0.5, accelerometer_offset_mps2=0.3 * GRAVITY_M_S2)
    sd = stated_sd(np.full((3, 3), 0.64), upright, still, None, RATE, settings, smooth=True)
    np.testing.assert_allclose(sd, np.tile([0.5, 0.5, 0.4], (3, 1)), rtol=1e-12)


def test_memories_follow_from_the_ratio_of_noises():
    settings = OrientationSettings()
    worse = replace(settings, gyro_noise=4.0 * settings.gyro_noise)
    assert heading_memory_s(settings) == pytest.approx(4.0 * heading_memory_s(worse))
    assert tilt_memory_s(settings) == pytest.approx(2.0 * tilt_memory_s(worse))
