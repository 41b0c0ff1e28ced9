"""Quaternions that files state, beside those of filters: from the same file, from another, with and without times."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.imu.frames import change_frame
from mbkf.imu.orientation import OrientSettings
from mbkf.io.imu.write import write_imu_csv
from mbkf.trial.inertial.orient import COMPARED, orient, orientation_summary
from mbkf.trial.inertial.stated_orientation import OWN, stated_orientations
from tests.imu.turning import apart_deg, turning

MADE = turning(2.0)
ONE = MADE.readings("thigh")


def technaid_quaternions(path, q=MADE.truth, names="  qW , qX, qY ,qZ"):
    """As the source's conversion of a .capq file: names with blanks, w first, no times."""
    rows = [",".join(f"{x:.7f}" for x in row) for row in q[:, [3, 0, 1, 2]]]
    path.write_text("\n".join([names, *rows]) + "\n", encoding="utf-8")
    return path


def test_the_sensors_own_file_states_them():
    (course,), notes = stated_orientations([ONE], "ENU", OWN)
    np.testing.assert_allclose(course.quaternion, change_frame(MADE.truth, "NWU", "ENU"))
    assert (course.method, notes) == ("file", ())
    with pytest.raises(InvalidInput, match="--compare FILE"):
        stated_orientations([replace(ONE, orientation=None)], "ENU", OWN)


def test_a_table_without_times_counts_samples_and_its_world_is_noted(tmp_path):
    path = technaid_quaternions(tmp_path / "q.csv")
    (course,), notes = stated_orientations([ONE], "NWU", path)
    assert apart_deg(course.quaternion, MADE.truth).max() < 1e-4
    assert course.method == "q.csv"
    assert "those of NWU" in notes[0]
    with pytest.raises(FileFormatError, match="qw, qx, qy, qz"):
        stated_orientations([ONE], "NWU", technaid_quaternions(path, names="a,b,c,acc_x"))


def test_another_clock_is_followed(tmp_path):
    """Every second sample, later by 0.5 s: the samples in common are compared, the others are missing."""
    times = ONE.time_s[50::2]
    late = replace(ONE, orientation=None, magnetic_field=None).at(times, lambda values, _: values[50::2])
    write_imu_csv([replace(late, orientation=MADE.truth[50::2], frame="NWU")], tmp_path / "late.csv")
    (course,), _ = stated_orientations([ONE], "NWU", tmp_path / "late.csv")
    there = np.isfinite(course.quaternion).all(axis=1)
    assert 149 <= there.sum() <= 151  # half a step beyond its ends
    assert not there[:49].any()
    inside = np.flatnonzero(there)[1:-1]
    assert apart_deg(course.quaternion[inside], MADE.truth[inside]).max() < 0.1
    far = replace(late, time_s=late.time_s + 100.0, orientation=MADE.truth[50::2], frame="NWU")
    write_imu_csv([far], tmp_path / "far.csv")
    with pytest.raises(InvalidInput, match="one recording"):
        stated_orientations([ONE], "NWU", tmp_path / "far.csv")


def test_as_many_samples_of_another_rate_are_followed_by_their_times(tmp_path):
    made = turning(4.0)
    whole, half = made.readings("thigh"), len(made.truth) // 2
    first = replace(whole, orientation=None).at(whole.time_s[:half], lambda values, _: values[:half])
    slow = whole.at(whole.time_s[::2][:half], lambda values, _: values[::2][:half])
    write_imu_csv([slow], tmp_path / "slow.csv")
    (course,), _ = stated_orientations([first], "NWU", tmp_path / "slow.csv")
    assert apart_deg(course.quaternion, made.truth[:half]).max() < 0.1


def test_of_several_sensors_names_decide(tmp_path):
    other = turning(2.0, 3).readings("foot")
    write_imu_csv([other, ONE], tmp_path / "both.csv")
    courses, _ = stated_orientations([ONE, other], "NWU", tmp_path / "both.csv")
    np.testing.assert_allclose(courses[1].quaternion, other.orientation, atol=1e-9)
    with pytest.raises(UnknownName, match="shank"):
        stated_orientations([replace(ONE, name="shank"), other], "NWU", tmp_path / "both.csv")


def test_a_filter_is_compared_and_begins_where_the_file_does(tmp_path):
    path = technaid_quaternions(tmp_path / "q.csv")
    result = orient([ONE], frame="NWU", compare=path, start=COMPARED)
    assert apart_deg(result.courses[0].quaternion[:1], MADE.truth[:1])[0] < 1e-4
    row = orientation_summary(result, OrientSettings())["sensors"][0]
    error = orient([ONE], frame="NWU", start=MADE.truth[0]).errors[0][1]
    assert row["difference_rms_deg"]["total"] == pytest.approx(np.degrees(error.total), abs=1e-3)
    assert 0.0 < max(row["difference_mean_quaternion"].values()) < 0.1


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"start": [0.0, 0.0, 0.0, 2.0]}, "length 2"),
        ({"start": COMPARED}, "--compare"),
        ({"start": COMPARED, "compare": "ekf"}, "--compare"),
    ],
)
def test_a_start_that_is_not_known_is_refused(changes, told):
    with pytest.raises(InvalidInput, match=told):
        orient([ONE], frame="NWU", **changes)


def test_one_start_is_for_one_sensor():
    both = [ONE, replace(ONE, name="shank")]
    with pytest.raises(InvalidInput, match="--sensor"):
        orient(both, frame="NWU", start=[0.0, 0.0, 0.0, 1.0])
    result = orient(both, frame="NWU", start=[0.0, 0.0, 0.0, 1.0], only=["shank"])
    np.testing.assert_allclose(result.courses[0].quaternion[0], [0.0, 0.0, 0.0, 1.0], atol=1e-12)
    with pytest.raises(UnknownName, match="madgwick"):
        orient([ONE], frame="NWU", compare="kalman")
