"""The first x-IMU: its folder, its table, and the rate of its register."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.imu.files import read_imu

NAMES = [
    "Packet number",
    *(f"Gyroscope {axis} (deg/s)" for axis in "XYZ"),
    *(f"Accelerometer {axis} (g)" for axis in "XYZ"),
    *(f"Magnetometer {axis} (G)" for axis in "XYZ"),
]
TABLE = "00033_CalInertialAndMag.csv"


def recording(folder, register="9", name="00033"):
    rows = [[115 + 2 * k, 180.0, 0.0, k, 0.0, 0.0, 1.0, 0.2, 0.0, -0.4] for k in range(40)]
    text = "\n".join([",".join(NAMES), *(",".join(map(str, row)) for row in rows)])
    (folder / f"{name}_CalInertialAndMag.csv").write_text(text + "\n")
    (folder / f"{name}_Quaternion.csv").write_text("Packet number,Element 1\n116,1.0\n118,1.0\n")
    if register:
        (folder / f"{name}_Registers.csv").write_text(
            "Packet number,Address,Value,Fixed-point value,Name\n"
            f"69,68,3,NaN,BatteryAndThermometerDataRate\n70,69,{register},NaN,InertialAndMagneticDataRate\n"
        )
    return folder


@pytest.mark.parametrize(("register", "rate"), [("9", 256.0), ("1", 1.0), ("10", 512.0)])
@pytest.mark.parametrize("file", ["", TABLE])
def test_the_register_states_the_rate_as_a_power_of_two(tmp_path, register, rate, file):
    (one,) = read_imu(recording(tmp_path, register) / file)
    assert (one.name, one.rate_hz) == ("00033", rate)
    np.testing.assert_allclose(one.time_s, np.arange(40) / rate)
    np.testing.assert_allclose(one.angular_velocity_rad_s[:, 0], np.pi)
    np.testing.assert_allclose(one.specific_force_mps2[:, 2], 9.80665)
    np.testing.assert_allclose(one.magnetic_field[0], [20.0, 0.0, -40.0])


def test_a_rate_that_is_given_overrules_the_register(tmp_path):
    (one,) = read_imu(recording(tmp_path), rate_hz=128.0)
    assert one.rate_hz == 128.0


def test_without_the_register_the_rate_is_asked_for(tmp_path):
    with pytest.raises(InvalidInput, match=r"no 00033_Registers.csv beside it.*--rate"):
        read_imu(recording(tmp_path, register=""))


@pytest.mark.parametrize("register", ["0", "11", "NaN"])
def test_a_register_without_a_rate_is_refused(tmp_path, register):
    with pytest.raises(FileFormatError, match="InertialAndMagneticDataRate"):
        read_imu(recording(tmp_path, register))


def test_several_recordings_in_a_folder_are_named(tmp_path):
    recording(recording(tmp_path), name="00034")
    with pytest.raises(FileFormatError, match=r"00033, 00034"):
        read_imu(tmp_path)
