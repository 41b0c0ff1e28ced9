"""Names in two rows become one; tables with one row of names stay."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.io.imu.files import read_imu
from mbkf.io.imu.spanning_headers import joined_header
from mbkf.io.imu.table_text import split_table

TWO = (
    "Measured at noon;;;;;;\nTime (s);Foot Acceleration (g);;;Foot Gyroscope;;\n"
    ";X;Y;Z;X (deg/s);Y (deg/s);Z (deg/s)\n"
)
NUMBERS = "0;0;0;1;5;6;7\n0.01;0;0;1;5;6;7\n"


def test_a_quantity_stands_for_all_axes_below_it():
    rows = joined_header(split_table(Path("a.csv"), TWO + NUMBERS)).rows
    assert rows[1][1] == [
        "Time (s)",
        *(f"Foot Acceleration {axis} [g]" for axis in "XYZ"),
        *(f"Foot Gyroscope {axis} [deg/s]" for axis in "XYZ"),
    ]
    assert len(rows) == 4


@pytest.mark.parametrize("names", ["Time (s);X (g);Y (g);Z (g)", "Remarks;of;a;walk\nTime (s);X;Y;Z"])
def test_axes_under_no_quantity_stay(names):
    text = split_table(Path("a.csv"), names + "\n0;1;2;3\n1;1;2;3\n")
    assert joined_header(text) == text


def test_the_table_is_read(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(TWO + NUMBERS)
    (one,) = read_imu(path)
    assert one.name == "Foot"
    np.testing.assert_allclose(one.specific_force_mps2[0], [0.0, 0.0, 9.80665])
    np.testing.assert_allclose(np.degrees(one.angular_velocity_rad_s[1]), [5.0, 6.0, 7.0])
