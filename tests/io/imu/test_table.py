"""Inertial tables: names, units, several sensors, gaps, and what is told when something is missing."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import FileFormatError, InvalidInput, MbkfError, ShapeError
from mbkf.io.imu.readings import ImuReadings, on_regular_grid, rate_of
from mbkf.io.imu.table import read_imu_csv
from mbkf.io.imu.units import unit_name

DEGREE = np.pi / 180.0


def write(path, *lines):
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_units_in_the_names_are_converted(tmp_path):
    path = write(
        tmp_path / "a.csv",
        "time [ms],Acc_X (g),Acc_Y (g),Acc_Z (g),gyr_x_deg_s,gyr_y_deg_s,gyr_z_deg_s,mag_x [nT],mag_y [nT],mag_z [nT]",
        "0,0,0,1,90,0,0,1000,0,0",
        "10,0,0,1,90,,0,1000,0,0",
    )
    (one,) = read_imu_csv(path)
    assert one.name == "a"
    np.testing.assert_allclose(one.time_s, [0.0, 0.01])
    assert one.rate_hz == pytest.approx(100.0)
    np.testing.assert_allclose(one.specific_force_mps2, [[0, 0, GRAVITY_M_S2]] * 2)
    np.testing.assert_allclose(one.angular_velocity_rad_s[0], [np.pi / 2, 0, 0])
    assert np.isnan(one.angular_velocity_rad_s[1, 1])
    np.testing.assert_allclose(one.magnetic_field[0], [1.0, 0, 0])


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_several_sensors_share_a_table(tmp_path, delimiter):
    names = [f"{s} {k}_{x}" for s in ("left_foot", "right_foot") for k in ("acc", "gyr") for x in "xyz"]
    rows = [delimiter.join(str(10 * t + c) for c in range(12)) for t in range(3)]
    path = write(tmp_path / "b.csv", delimiter.join(names), *rows)
    left, right = read_imu_csv(path, units={"acc": "m/s^2", "gyr": "rad/s"}, rate_hz=50.0)
    assert (left.name, right.name) == ("left_foot", "right_foot")
    np.testing.assert_array_equal(left.specific_force_mps2[1], [10, 11, 12])
    np.testing.assert_array_equal(right.angular_velocity_rad_s[2], [29, 30, 31])
    np.testing.assert_allclose(right.time_s, [0, 0.02, 0.04])


def test_sensors_may_stand_in_a_row_above_and_units_in_one_below(tmp_path):
    two = write(tmp_path / "c.csv", "sensor,foot,foot,foot", "axis,acc_x,acc_y,acc_z", "0,1,2,3", "1,1,2,3")
    (one,) = read_imu_csv(two, units={"acc": "g"}, rate_hz=10.0)
    assert one.name == "foot"
    assert np.isnan(one.angular_velocity_rad_s).all()
    below = write(tmp_path / "d.csv", "acc_x,acc_y,acc_z", "m/s2,m/s2,m/s2", "1,2,3", "1,2,3")
    np.testing.assert_array_equal(read_imu_csv(below, rate_hz=10.0)[0].specific_force_mps2[0], [1, 2, 3])


def test_a_given_unit_overrules_a_wrong_one_in_the_file(tmp_path):
    path = write(tmp_path / "e.csv", "acc_x [m/s2],acc_y [m/s2],acc_z [m/s2]", "0,0,1", "0,0,1")
    (one,) = read_imu_csv(path, units={"acc": "g"}, rate_hz=10.0)
    np.testing.assert_allclose(one.specific_force_mps2[0], [0, 0, GRAVITY_M_S2])


@pytest.mark.parametrize(
    ("lines", "options", "told"),
    [
        (["acc_x,acc_y,acc_z", "0,0,1", "0,0,1"], {"rate_hz": 10.0}, "--units acc="),
        (["acc_x,acc_y,acc_z", "9,-4,1001", "0,2,998"], {"rate_hz": 10.0}, "--units acc=mg"),
        (["acc_x,acc_y,acc_z", "9,-4,16001", "0,2,16400"], {"rate_hz": 10.0}, "raw counts"),
        (
            ["acc_x [LSB],acc_y [LSB],acc_z [LSB]", "9,-4,1", "0,2,1"],
            {"rate_hz": 10.0},
            "'acc_x \\[LSB\\]' holds raw",
        ),
        (
            ["l_acc_x,l_acc_y,l_acc_z,r_acc_x,r_acc_y,r_acc_z", "9,-4,1001,5,1003,0", "0,2,998,7,999,3"],
            {"rate_hz": 10.0},
            "--units acc=mg",
        ),
        (["acc_x [g],acc_y [g],acc_z [g]", "0,0,1", "0,0,1"], {}, "--rate"),
        (["acc_x [g],acc_y [g]", "0,0", "0,0"], {"rate_hz": 10.0}, "acc_z"),
        (["gyr_x [deg/s],b", "0,0", "0,0"], {"rate_hz": 10.0}, "no accelerometer"),
        (["time,acc_x [g],acc_y [g],acc_z [g]", "0,0,0,x", "1,0,0,1"], {}, "'x' is not a number"),
        (["acc_x [furlong],acc_y [g],acc_z [g]", "0,0,1"], {"rate_hz": 10.0}, "furlong"),
        (["time,acc_x [g],acc_y [g],acc_z [g]", "1,0,0,1", "1,0,0,1"], {}, "do not increase"),
        (["1,2,3", "4,5,6"], {}, "names no columns"),
        (["acc_x [g],acc_y [g],acc_z [g]"], {"rate_hz": 10.0}, "cut short"),
        (["acc_x [g],acc_y [g],acc_z [g]", "0,0,1", "0,0,1"], {"rate_hz": -1.0}, "positive"),
    ],
)
def test_what_is_missing_is_told(tmp_path, lines, options, told):
    with pytest.raises(MbkfError, match=told):
        read_imu_csv(write(tmp_path / "bad.csv", *lines), **options)


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_imu_csv(tmp_path / "nothing.csv")


@pytest.mark.parametrize(
    ("text", "unit"), [("m/s²", "m/s2"), ("m s^-2", "m/s2"), ("G", "g"), ("mps2", "m/s2")]
)
def test_units_have_many_spellings(text, unit):
    assert unit_name("acc", text, "") == unit


@pytest.mark.parametrize(("text", "unit"), [("°/s", "deg/s"), ("dps", "deg/s"), ("rad s-1", "rad/s")])
def test_so_have_rates(text, unit):
    assert unit_name("gyr", text, "") == unit


def test_gaps_in_time_do_not_change_the_rate_and_become_missing_samples():
    times = np.delete(np.arange(100) / 64.0, range(20, 35))
    assert rate_of(times, "") == pytest.approx(64.0)
    force = np.column_stack([np.arange(85.0)] * 3)
    one = ImuReadings("a", times, force, force, None, 64.0)
    regular = on_regular_grid(one)
    assert regular.samples == 100
    missing = np.isnan(regular.specific_force_mps2[:, 0])
    np.testing.assert_array_equal(np.flatnonzero(missing), np.arange(20, 35))
    np.testing.assert_array_equal(regular.angular_velocity_rad_s[~missing], force)
    assert on_regular_grid(regular) is regular


def test_a_record_checks_its_shapes_and_cannot_be_written_to():
    force = np.zeros((5, 3))
    with pytest.raises(ShapeError):
        ImuReadings("a", np.arange(4.0), force, force, None, 1.0)
    with pytest.raises(InvalidInput):
        ImuReadings("a", np.arange(5.0), force, force, None, 0.0)
    one = ImuReadings("a", np.arange(5.0), force, force, None, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        one.specific_force_mps2[0, 0] = 1.0


def test_real_foot_sensors(real_data):
    path = real_data / "imu_gaitmap_foot" / "imu_sample.csv"
    left, right = read_imu_csv(path, units={"acc": "m/s2", "gyr": "deg/s"}, rate_hz=204.8)
    assert (left.name, right.name, left.samples) == ("left_sensor", "right_sensor", 7928)
    size = np.median(np.linalg.norm(right.specific_force_mps2, axis=1))
    assert 9.5 < size < 12.0
