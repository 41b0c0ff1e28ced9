"""The door to all inertial files, the MATLAB sets, tables written and read again, mounts."""

import numpy as np
import pytest
import scipy.io

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.mat import read_imu_mat
from mbkf.io.imu.mount import ImuMount, read_mounts, write_mounts
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.table import read_imu_csv
from mbkf.io.imu.write import write_imu_csv, write_orientation_csv

RNG = np.random.default_rng(0)


def sensor(name, count=20, field=True, orientation=True):
    q = RNG.normal(size=(count, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    force = RNG.normal(size=(count, 3))
    force[3] = np.nan
    return ImuReadings(
        name, np.arange(count) / 50.0, force, RNG.normal(size=(count, 3)),
        RNG.normal(size=(count, 3)) if field else None, 50.0, "NWU" if orientation else "", q if orientation else None,
    )  # fmt: skip


def test_what_is_written_is_read_again(tmp_path):
    made = (sensor("right_thigh"), sensor("left foot", field=False, orientation=False))
    write_imu_csv(made, tmp_path / "a.csv")
    for one, found in zip(made, read_imu(tmp_path / "a.csv"), strict=True):
        assert (found.name, found.frame) == (one.name, one.frame)
        assert found.rate_hz == pytest.approx(50.0)
        for name in ("specific_force_mps2", "angular_velocity_rad_s", "magnetic_field", "orientation"):
            written, read = getattr(one, name), getattr(found, name)
            assert (written is None) == (read is None), name
            if written is not None:
                np.testing.assert_allclose(read, written, rtol=1e-8, atol=1e-9)
    with pytest.raises(InvalidInput, match="not sampled with"):
        write_imu_csv((made[0], sensor("b", 10)), tmp_path / "b.csv")


def test_orientations_are_written_with_their_units(tmp_path):
    one = sensor("a")
    euler = np.full((20, 3), np.pi)
    path = tmp_path / "o.csv"
    write_orientation_csv(
        path, one.time_s, one.orientation, euler, euler / 180, np.full((20, 3), 0.1), "ENU by ekf"
    )
    note, header, first = path.read_text().splitlines()[:3]
    assert "ENU" in note
    row = dict(zip(header.split(","), first.split(","), strict=True))
    assert float(row["yaw [deg]"]) == pytest.approx(180.0)
    assert float(row["gyro_bias_x [deg/s]"]) == pytest.approx(1.0)
    assert float(row["qw"]) == pytest.approx(one.orientation[0, 3])
    assert "sd_up [deg]" in row


def test_both_matlab_sets(tmp_path):
    acc, quat = RNG.normal(size=(30, 3)), np.tile([0.5, 0.1, 0.2, 0.3], (30, 1))
    broad = {"imu_acc": acc, "imu_gyr": acc, "imu_mag": acc, "opt_quat": quat, "sampling_rate": 100.0}
    scipy.io.savemat(tmp_path / "b.mat", broad)
    (one,) = read_imu(tmp_path / "b.mat")
    assert one.rate_hz == 100.0
    assert "ENU" in one.frame
    np.testing.assert_allclose(one.orientation[0], [0.1, 0.2, 0.3, 0.5])
    part = {"acc": acc, "gyr": acc, "quat": quat}
    scipy.io.savemat(tmp_path / "q.mat", {"t": np.arange(30) / 60.0, "hip": part, "foot_left": part})
    assert [s.name for s in read_imu_mat(tmp_path / "q.mat")] == ["hip", "foot_left"]
    scipy.io.savemat(tmp_path / "n.mat", {"a": 1.0})
    with pytest.raises(FileFormatError, match="no sensor"):
        read_imu_mat(tmp_path / "n.mat")
    (tmp_path / "x.mat").write_text("no")
    with pytest.raises(FileFormatError, match="not a MATLAB"):
        read_imu_mat(tmp_path / "x.mat")


def test_unknown_files_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_imu(tmp_path / "a.csv")
    (tmp_path / "a.bin").write_text("x")
    with pytest.raises(FileFormatError, match=r"\.bin"):
        read_imu(tmp_path / "a.bin")
    (tmp_path / "a.txt").write_text("acc_x [g],acc_y [g],acc_z [g]\n0,0,1\n0,0,1\n")
    assert read_imu(tmp_path / "a.txt", rate_hz=10.0)[0].samples == 2
    assert read_imu_csv(tmp_path / "a.txt", rate_hz=10.0)[0].name == "a"


def test_mounts_are_written_and_read_again(tmp_path):
    mounts = (
        ImuMount("a", "pelvis", np.array([0.1, 0, 0]), np.array([0, 0, 0, 2.0])),
        ImuMount("b", "torso", np.zeros(3), np.array([0.5, 0.5, 0.5, 0.5])),
    )
    write_mounts(mounts, tmp_path / "m.toml")
    for one, found in zip(mounts, read_mounts(tmp_path / "m.toml"), strict=True):
        assert (one.name, one.segment) == (found.name, found.segment)
        np.testing.assert_array_equal(one.position_m, found.position_m)
        np.testing.assert_allclose(one.rotation, found.rotation)
    assert mounts[0].rotation[3] == 1.0
    for text in (
        "x = 1",
        "[[imu]]\nname = 'a'",
        "[[imu]]\nname='a'\nsegment='b'\nposition_m=[0]\nrotation=[0,0,0,1]",
    ):
        (tmp_path / "bad.toml").write_text(text)
        with pytest.raises((FileFormatError, InvalidInput), match=r"bad\.toml"):
            read_mounts(tmp_path / "bad.toml")
    with pytest.raises(FileFormatError, match="no such file"):
        read_mounts(tmp_path / "none.toml")
