"""Xsens text exports: lost packets, rates, orientations, folders of sensors."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.imu.xsens_text import is_xsens, read_xsens, read_xsens_folder

COLUMNS = "PacketCounter\tSampleTimeFine\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z"
MATRIX = "".join(f"\tMat[{i}][{j}]" for j in (1, 2, 3) for i in (1, 2, 3))


def export(path, packets, rate="// Update Rate: 50.0Hz", columns=COLUMNS, rows=None):
    rows = rows or [f"{p:05d}\t\t{p}\t0\t9.8\t0.1\t\t0.3" for p in packets]
    path.write_text("\n".join(["// Start Time: Unknown", rate, columns, *rows]) + "\n", encoding="utf-8")
    return path


def test_lost_packets_become_missing_samples(tmp_path):
    one = read_xsens(export(tmp_path / "a.txt", [65534, 65535, 0, 3]))
    assert (one.rate_hz, one.samples) == (50.0, 6)
    np.testing.assert_array_equal(np.isnan(one.specific_force_mps2[:, 0]), [0, 0, 0, 1, 1, 0])
    np.testing.assert_allclose(np.diff(one.time_s), 0.02)
    np.testing.assert_array_equal(one.angular_velocity_rad_s[0, [0, 2]], [0.1, 0.3])
    assert np.isnan(one.angular_velocity_rad_s[0, 1])
    assert one.magnetic_field is None
    assert one.orientation is None


def test_matrices_are_turned_into_quaternions_sensor_to_world(tmp_path):
    R = Rotation.from_rotvec([0.3, -0.2, 0.9])
    cells = "\t".join(str(x) for x in R.as_matrix().T.ravel())  # column by column
    rows = [f"{p}\t\t0\t0\t9.8\t\t\t\t{cells}" for p in range(3)]
    one = read_xsens(export(tmp_path / "a.txt", [], columns=COLUMNS + MATRIX, rows=rows))
    np.testing.assert_allclose(Rotation.from_quat(one.orientation[1]).as_matrix(), R.as_matrix(), atol=1e-9)
    assert np.isnan(one.angular_velocity_rad_s).all()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"rate": "// nothing"}, "--rate"),
        ({"columns": "PacketCounter\tFoo", "rows": ["1\t2", "2\t2"]}, "Acc_X"),
        ({"columns": "Counter\tFoo"}, "not an Xsens"),
        ({"rows": ["1\t\t0\t0\tx\t0\t0\t0", "2\t\t0\t0\t1\t0\t0\t0"]}, "not a number"),
        ({"rows": ["1\t\t0", "2\t\t0"]}, "cells for"),
        ({"rows": ["1\t\t0\t0\t1\t0\t0\t0"]}, "cut short"),
        ({"rows": ["5\t\t0\t0\t1\t0\t0\t0", "5\t\t0\t0\t1\t0\t0\t0"]}, "count up"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, change, told):
    path = export(tmp_path / "a.txt", [1, 2, 3], **change)
    with pytest.raises((FileFormatError, InvalidInput), match=told):
        read_xsens(path)


def test_the_rate_follows_from_ticks_of_a_tenth_of_a_millisecond(tmp_path):
    """120 Hz are 83.3 ticks; a packet is lost, and the clock turns over."""
    packets = (0, 1, *range(3, 60))
    rows = [f"{p}\t{(4294967000 + round(p * 1e4 / 120.0)) % 2**32}\t0\t0\t9.8\t0\t0\t0" for p in packets]
    one = read_xsens(export(tmp_path / "a.txt", [], rate="// nothing", rows=rows))
    assert one.rate_hz == pytest.approx(120.0, rel=2e-4)
    assert one.samples == 60


def test_a_folder_is_cut_to_the_common_packets(tmp_path):
    export(tmp_path / "T_001.txt", range(10, 30))
    export(tmp_path / "T_002.txt", range(5, 25))
    (tmp_path / "map.xml").write_text(
        "<a><ExperimentalSensor name='_002'><name_in_model>femur_r_imu</name_in_model></ExperimentalSensor></a>"
    )
    (tmp_path / "notes.txt").write_text("nothing\n")
    first, second = read_xsens_folder(tmp_path)
    assert (first.name, second.name) == ("T_001", "femur_r")
    assert first.samples == second.samples == 15
    np.testing.assert_array_equal(first.specific_force_mps2[:, 0], second.specific_force_mps2[:, 0])
    assert first.time_s[0] == 0.0
    assert not is_xsens(tmp_path / "notes.txt")


def test_folders_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no Xsens"):
        read_xsens_folder(tmp_path)
    export(tmp_path / "a.txt", range(10))
    export(tmp_path / "b.txt", range(50, 60))
    with pytest.raises(InvalidInput, match="no time in common"):
        read_xsens_folder(tmp_path)
    export(tmp_path / "b.txt", range(10), rate="// Update Rate: 100Hz")
    assert {one.rate_hz for one in read_xsens_folder(tmp_path)} == {50.0}  # the slower one's


def test_the_opensense_walk(real_data):
    sensors = read_xsens_folder(real_data / "imu_opensense_walk")
    assert {one.name for one in sensors} >= {"pelvis", "torso", "femur_r", "tibia_l", "calcn_l"}
    assert len({one.samples for one in sensors}) == 1
    size = np.linalg.norm(sensors[0].specific_force_mps2, axis=1)
    assert 9.0 < np.nanmedian(size) < 11.0
