"""Sensors on one clock: what they have in common, at the slowest rate; stamps since a date begin at zero."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.imu.clocks import on_one_clock
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.session import read_folder, read_together, sensor_files
from mbkf.io.imu.signals import Signal, readings_of, resampled
from mbkf.io.imu.times import times_s
from mbkf.io.imu.write import write_imu_csv


def sensor(name, start_s, seconds, rate_hz):
    """Readings that are straight lines of time, so that interpolation is exact."""
    times = start_s + np.arange(round(seconds * rate_hz)) / rate_hz
    line = np.outer(times - 1.0, [1.0, 2.0, 3.0])
    return ImuReadings(name, times, line, -line, 2.0 * line, rate_hz)


@settings(max_examples=60, deadline=None)
@given(start_s=st.floats(0.0, 1.0), rate_hz=st.sampled_from([60.0, 100.0, 148.148]))
def test_lines_stay_lines_on_a_common_clock(start_s, rate_hz):
    first, second = on_one_clock([sensor("a", 0.0, 4.0, 100.0), sensor("b", start_s, 4.0, rate_hz)])
    np.testing.assert_allclose(first.time_s, second.time_s, rtol=0.0, atol=1e-6)
    assert first.rate_hz == pytest.approx(min(100.0, rate_hz))
    assert first.time_s[0] >= start_s - 0.01
    inner = slice(1, -1)  # at the ends half a step may be held
    for one in (first, second):
        line = np.outer(one.time_s - 1.0, [1.0, 2.0, 3.0])
        np.testing.assert_allclose(one.specific_force_mps2[inner], line[inner], atol=1e-9)
        np.testing.assert_allclose(one.magnetic_field[inner], 2.0 * line[inner], atol=1e-9)


def test_sensors_in_step_stay_as_they_are():
    pair = [sensor("a", 12.3, 1.0, 50.0), sensor("b", 12.3, 1.0, 50.0)]
    assert on_one_clock(pair)[1] is pair[1]


def test_stamps_since_a_date_begin_at_zero():
    first, second = on_one_clock([sensor("a", 1.7e9, 2.0, 100.0), sensor("b", 1.7e9 + 0.5, 2.0, 100.0)])
    assert first.time_s[0] == 0.0
    assert second.specific_force_mps2[0, 0] == pytest.approx(1.7e9 + 0.5 - 1.0)


def test_recordings_without_a_common_time_are_refused_and_what_to_say_is_told():
    pair = [sensor("a", 0.0, 2.0, 100.0), sensor("b", 500.0, 2.0, 100.0)]
    with pytest.raises(InvalidInput, match="--started-together"):
        on_one_clock(pair)
    first, second = on_one_clock(pair, started_together=True)
    np.testing.assert_allclose(first.time_s, second.time_s, rtol=0.0, atol=1e-6)


def test_a_quaternion_and_its_negative_are_one_turn():
    turn = np.tile([0.0, 0.0, np.sin(0.3), np.cos(0.3)], (10, 1)) * np.array([1.0, -1.0] * 5)[:, None]
    found = resampled(Signal("a", "quat", np.arange(10.0), turn), np.arange(9.0) + 0.5)
    np.testing.assert_allclose(np.abs(found[:, 3]), np.cos(0.3))


def test_long_gaps_are_not_bridged():
    times = np.array([0.0, 1.0, 2.0, 9.0, 10.0])
    found = resampled(Signal("a", "acc", times, np.ones((5, 3))), np.array([0.5, 5.0, 9.5]))
    np.testing.assert_array_equal(np.isnan(found[:, 0]), [False, True, False])


def test_gravity_is_put_back_where_a_filter_took_it(tmp_path):
    times = np.arange(5.0)
    turn = np.tile(
        [np.sin(np.pi / 4), 0.0, 0.0, np.cos(np.pi / 4)], (5, 1)
    )  # x stays, the world's z is the sensor's y
    signals = [Signal("a", "free", times, np.zeros((5, 3))), Signal("a", "quat", times, turn)]
    (one,) = readings_of(tmp_path / "a.csv", signals, 1.0)
    np.testing.assert_allclose(one.specific_force_mps2, np.tile([0.0, 9.80665, 0.0], (5, 1)), atol=1e-9)


@pytest.mark.parametrize(("unit", "scale"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
@pytest.mark.parametrize("rate_hz", [6.0, 100.0, 4000.0])
def test_a_step_tells_the_unit_of_a_clock(tmp_path, unit, scale, rate_hz):
    counted = scale * (7.0 + np.arange(50) / rate_hz)
    found = times_s(tmp_path, counted, "", "time")
    np.testing.assert_allclose(np.diff(found), 1.0 / rate_hz, rtol=1e-6)
    np.testing.assert_allclose(times_s(tmp_path, counted, unit, "time"), found)


def test_a_counter_is_no_clock_and_32_bits_turn_over(tmp_path):
    with pytest.raises(InvalidInput, match="--rate"):
        times_s(tmp_path, np.arange(10.0), "", "time")
    counted = (2.0**32 - 50_000.0 + 10_000.0 * np.arange(10)) % 2.0**32
    np.testing.assert_allclose(np.diff(times_s(tmp_path, counted, "us", "t")), 0.01)


def test_a_folder_is_read_without_the_tables_that_are_no_sensors(tmp_path):
    for name, start in (("left_foot", 0.0), ("right_foot", 0.25)):
        write_imu_csv([sensor(name, start, 2.0, 100.0)], tmp_path / f"{name}.csv")
    (tmp_path / "angles.csv").write_text("time,knee_angle\n0,1\n1,2\n")
    (tmp_path / "notes.txt").write_text("nothing\n")
    assert [path.name for path in sensor_files(tmp_path, (".csv", ".txt"))] == [
        "left_foot.csv",
        "right_foot.csv",
    ]

    def read(path):
        from mbkf.io.imu.table import read_imu_csv

        return read_imu_csv(path)

    left, right = read_folder(tmp_path, (".csv", ".txt"), read)
    assert left.time_s[0] == pytest.approx(0.25)
    np.testing.assert_allclose(left.specific_force_mps2[1:-1], right.specific_force_mps2[1:-1], atol=1e-9)
    with pytest.raises(InvalidInput):
        read_together([tmp_path / "left_foot.csv"], lambda _: (_ for _ in ()).throw(InvalidInput("no")))
