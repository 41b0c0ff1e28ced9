"""Names of columns: sensor, quantity, axis and unit in the spellings that makers and people have."""

import pytest

from mbkf.io.imu.column_names import parse_column_name, time_unit


@pytest.mark.parametrize(
    ("name", "sensor", "kind", "axis", "unit"),
    [
        ("left_foot_acc_x [m/s^2]", "left_foot", "acc", 0, "m/s2"),
        ("left_sensor gyr_y", "left_sensor", "gyr", 1, ""),
        ("Gyr_Z (deg/s)", "", "gyr", 2, "deg/s"),
        ("mag_y_ut", "", "mag", 1, "ut"),
        ("accX", "", "acc", 0, ""),
        ("gx_deg_s", "", "gyr", 0, "deg/s"),
        ("acc_1", "", "acc", 0, ""),
        ("gyr_3", "", "gyr", 2, ""),
        ("Quat_q0", "", "quat", 3, ""),
        ("q3", "", "quat", 2, ""),
        ("Quat_W", "", "quat", 3, ""),
        ("qz", "", "quat", 2, ""),
        ("Shimmer_6A92_Accel_LN_X_CAL", "Shimmer_6A92", "acc", 0, ""),
        ("Low Noise Accelerometer X", "", "acc", 0, ""),
        ("Foot Accel Sensor X LT (mG)", "Foot LT", "acc", 0, "mg"),
        ("Noraxon MyoMotion-Segments-Foot LT-Gyroscope-x (deg/s)", "Foot LT", "gyr", 0, "deg/s"),
        ("Avanti sensor 1: ACC.X 1 [g]", "Avanti sensor 1", "acc", 0, "g"),
        ("accelerometer_right_foot_x", "right foot", "acc", 0, ""),
        ("accX_LF", "LF", "acc", 0, ""),
        ("Angular Velocity X (deg/s)", "", "gyr", 0, "deg/s"),
        ("specific_force_y [m/s2]", "", "acc", 1, "m/s2"),
        ("Magnetic field x (µT)", "", "mag", 0, "ut"),
        ("FreeAcc_X", "", "free", 0, ""),
        ("Linear Acceleration x (m/s^2)", "", "free", 0, "m/s2"),
        ("Acelerometro X", "", "acc", 0, ""),
        ("Giroscopio_Y", "", "gyr", 1, ""),
        ("Magnetometro Z (uT)", "", "mag", 2, "ut"),
        ("acc_z [furlong]", "", "acc", 2, "furlong"),
    ],
)
def test_readings(name, sensor, kind, axis, unit):
    found = parse_column_name(name)
    assert (found.sensor, found.kind, found.axis, found.unit) == (sensor, kind, axis, unit)


@pytest.mark.parametrize(
    "name",
    [
        "PacketCounter", "Mat[1][1]", "gyro_bias_x [deg/s]", "Absolute acceleration (m/s^2)", "temperature_x", "x",
        "sd_up [deg]", "angular acceleration x", "EMG 1 [V]", "m_pelvis_x", "", "force_x", "knee_angle",
        "Gyroscope X (lsb)", "acc_x [counts]",
    ],
)  # fmt: skip
def test_what_is_no_reading(name):
    assert parse_column_name(name) is None


def test_an_axis_alone_is_of_the_quantity_that_the_file_is_called_by():
    found = parse_column_name("X (m/s^2)", "acc")
    assert (found.kind, found.axis, found.unit) == ("acc", 0, "m/s2")
    assert parse_column_name("Time (s)", "acc") is None


def test_the_wide_range_is_told_from_the_low_noise():
    assert parse_column_name("Accel_WR_X_CAL").wide
    assert not parse_column_name("Accel_LN_X_CAL").wide


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time [s]", "s"), ("Timestamp (us)", "us"), ("Shimmer_40AC_Timestamp_Unix_CAL", ""), ("X[s]", "s"),
        ("t_ms", "ms"),
        ("SampleTimeFine", "us"), ("time", ""), ("x", None), ("X (g)", None), ("runtime error", None),
    ],
)  # fmt: skip
def test_times(name, unit):
    assert time_unit(name) == unit
