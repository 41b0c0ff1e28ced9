"""Cells of tables: delimiters, decimal commas, encodings, dates; channels of recorders."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.imu.channels import Channel, channel_signals
from mbkf.io.imu.table import read_imu_csv
from mbkf.io.imu.table_text import is_number, split_table
from mbkf.io.text import decoded

ROWS = [[0.0, 0.5, -1.25, 9.75], [0.01, 0.25, 1.5, 9.5], [0.02, 0.25, 1.5, 9.5]]
TITLES = ["time (s)", "acc_x (m/s²)", "acc_y (m/s²)", "acc_z (m/s²)"]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize(("mark", "comma"), [(",", False), (";", True), (";", False), ("\t", True)])
def test_delimiters_decimal_marks_and_encodings(tmp_path, encoding, mark, comma):
    rows = [mark.join(str(x).replace(".", ",") if comma else str(x) for x in row) for row in ROWS]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["Subject, nobody", mark.join(TITLES), *rows]) + "\n", encoding=encoding)
    (one,) = read_imu_csv(path)
    np.testing.assert_array_equal(np.column_stack([one.time_s, one.specific_force_mps2]), ROWS)


def test_a_line_may_state_the_delimiter(tmp_path):
    table = split_table(tmp_path, "sep=|\na|b,c\n1|2,5\n2|3,5\n")
    assert [cells for _, cells in table.rows] == [["a", "b,c"], ["1", "2,5"], ["2", "3,5"]]
    assert table.number("2,5") == 2.5


def test_dates_are_seconds(tmp_path):
    table = split_table(tmp_path, "time,x\n2026-01-02 03:04:05.250,1\n2026-01-02T03:04:05.260,1\n")
    first, second = (table.number(row[0]) for _, row in table.rows[1:])
    assert second - first == pytest.approx(0.01)
    assert is_number("2026-01-02 03:04:05")
    assert not is_number("walk")
    with pytest.raises(ValueError, match="could not convert"):
        table.number("walk")


def test_what_is_no_utf_8_is_read_as_windows_writes():
    assert decoded("µT °".encode("cp1252")) == "µT °"


def test_channels_of_a_sensor_and_a_clock(tmp_path):
    times = np.arange(3.0)
    columns = [Channel(f"IMU 1.ACC.{axis}", "g", times) for axis in "XYZ"]
    (signal,) = channel_signals(tmp_path, [*columns, Channel("Force.Fx1", "N", times)], times)
    assert (signal.sensor, signal.kind) == ("IMU 1", "acc")
    np.testing.assert_allclose(signal.values[2], 2.0 * 9.80665)
    assert channel_signals(tmp_path, columns[:2], times) == []  # an axis is not there
    volts = [Channel(one.label, "V", one.values) for one in columns]
    with pytest.raises(InvalidInput, match=r"'V'.*--units acc="):
        channel_signals(tmp_path, volts, times)
    (signal,) = channel_signals(tmp_path, volts, times, units={"acc": "m/s2"})
    np.testing.assert_array_equal(signal.values[2], 2.0)


@pytest.mark.parametrize("mark", [",", " ", "\t"])
def test_names_may_stand_in_a_comment_as_numpy_writes_them(tmp_path, mark):
    names = ["time", "acc_x", "acc_y", "acc_z"]
    path = tmp_path / "a.txt"
    np.savetxt(path, ROWS, header=mark.join(names), delimiter=mark, fmt="%8.3f")
    (one,) = read_imu_csv(path, units={"acc": "m/s2"})
    np.testing.assert_array_equal(np.column_stack([one.time_s, one.specific_force_mps2]), ROWS)


def test_a_comment_with_other_columns_than_the_numbers_is_no_row_of_names(tmp_path):
    table = split_table(tmp_path, "# recorded, today, outside\n1,2\n3,4\n")
    assert [cells for _, cells in table.rows] == [["1", "2"], ["3", "4"]]
    named = split_table(tmp_path, "# recorded,today\na,b\n3,4\n")
    assert named.rows[0][1] == ["a", "b"]
