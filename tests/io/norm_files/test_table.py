"""Tables of bands: long and wide, groups in the columns, ends in place of mean and spread; faults with their place."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.table import Table, bands_of_table, is_table_of_bands

PATH = Path("norms.csv")


def table(*rows):
    return Table(PATH, rows[0], tuple(enumerate(rows[1:], start=2)))


def test_a_wide_table_has_a_curve_for_each_pair():
    found = bands_of_table(
        table(
            ("% cycle", "Knee [deg] mean", "Knee [deg] sd", "Hip_lower", "Hip_upper", "Notes"),
            ("0", "1,5", "2", "3", "5", "x"), ("50", "", "", "", "", ""), ("100", "2.5", "2", "4", "8", ""),
        )
    )  # fmt: skip
    knee, hip = found
    assert (knee.label, knee.unit, hip.label, hip.unit) == ("Knee", "deg", "Hip", "")
    np.testing.assert_array_equal([knee.mean, knee.sd, knee.percent], [[1.5, 2.5], [2, 2], [0, 100]])
    np.testing.assert_array_equal([hip.mean, hip.sd], [[4, 6], [1, 2]])


def test_a_long_table_has_rows_for_each_curve_group_and_speed():
    found = bands_of_table(
        table(
            ("Moment", "PercentageGaitCycle", "SlowMean", "SlowSd", "FreeMean", "FreeSd", "n", "speed_from_m_s",
             "speed_to_m_s"),
            ("Hip", "0", "1", "2", "3", "4", "12", "0.9", "1.1"), ("Hip", "1", "5", "6", "7", "8", "12", "0.9", "1.1"),
            ("Knee", "0", "9", "1", "9", "1", "", "", ""), ("", "", "", "", "", "", "", "", ""),
        )
    )  # fmt: skip
    assert [(b.label, b.group, b.persons, b.speeds, b.quantity) for b in found] == [
        ("Hip", "Slow", 12, (0.9, 1.1), "torque"),
        ("Hip", "Free", 12, (0.9, 1.1), "torque"),
        ("Knee", "Slow", 0, None, "torque"),
        ("Knee", "Free", 0, None, "torque"),
    ]
    np.testing.assert_array_equal(found[1].mean, [3, 7])
    np.testing.assert_array_equal(found[1].sd, [4, 8])


def test_measures_have_one_row_without_a_per_cent():
    rows = (("quantity", "curve", "percent", "mean", "sd"), ("measure", "Speed", "", "1.2", "0.1"))
    (found,) = bands_of_table(table(*rows))
    assert (found.label, found.quantity, found.mean.tolist(), len(found.percent)) == (
        "Speed",
        "measure",
        [1.2],
        0,
    )


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([("frame", "a mean", "a sd"), ("0", "1", "1")], "no column states the per cent"),
        ([("percent", "a mean"), ("0", "1")], "'a' has mean alone"),
        ([("percent", "a", "b"), ("0", "1", "1")], "no columns of mean and sd"),
        ([("percent", "a mean", "a sd", "a mean"), ("0", "1", "1", "2")], "stands twice"),
        ([("percent", "a mean", "a sd"), ("0", "x", "1")], r"line 2: 'x' in column 'a mean' is not a number"),
        (
            [
                ("curve", "percent", "mean", "sd", "speed_from_m_s", "speed_to_m_s"),
                ("a", "0", "1", "1", "2", "1"),
            ],
            "the lower one comes first",
        ),
    ],
)
def test_faults_are_named(rows, message):
    with pytest.raises(FileFormatError, match=message):
        bands_of_table(table(*rows))


def test_heads_of_bands_are_told_from_others():
    assert is_table_of_bands(["Percent of the gait cycle", "mean"]) and is_table_of_bands(["%", "x_SD"])
    assert not is_table_of_bands(["Frame0", "Frame2"]) and not is_table_of_bands(["percent", "median"])
