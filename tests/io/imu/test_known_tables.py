"""Tables of public sets are recognised by their names; others get no statements."""

from pathlib import Path

from mbkf.io.imu.files import read_imu
from mbkf.io.imu.known_tables import defaults_of
from mbkf.io.imu.table_text import split_table


def test_all_marks_are_needed():
    head = "Vicon Orientation;IMU Acceleration;IMU Gyroscope;IMU Magnetometer"
    assert defaults_of(split_table(Path("a.csv"), f"{head}\n1;1;1;1\n")).units["gyr"] == "rad/s"
    assert defaults_of(split_table(Path("a.csv"), f"{head[:-4]}\n1;1;1;1\n")).units == {}


def test_public_files_of_makers_need_no_options(real_data):
    folder = real_data / "strangers3"
    (repo,) = read_imu(folder / "repoimu_two_row_header_TStick05_12s.csv")
    assert round(repo.rate_hz, 6) == 100.0
    assert repo.specific_force_mps2[0, 2] == 9.7625
    assert repo.angular_velocity_rad_s[0, 0] == 0.004823
    assert repo.orientation[0, 3] == 1.0
    apdm = read_imu(folder / "apdm_motion_studio_60rows.csv")
    assert [one.name for one in apdm] == ["Static", "Upper", "Middle", "Lower"]
    assert round(apdm[0].rate_hz, 2) == 128.0
    assert abs(apdm[0].orientation[0, 3] - 0.979286) < 1e-6
    (xsens,) = read_imu(folder / "xsens_sample_rate_header_100rows.txt")
    assert (xsens.rate_hz, xsens.samples) == (50.0, 100)
    assert xsens.angular_velocity_rad_s[0, 0] == 0.059158
    assert abs(xsens.orientation[0, 3] - 0.567189) < 1e-6
