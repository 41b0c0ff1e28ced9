"""Orientation of recordings: checked first, compared, judged against a reference in its own frame."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.frames import change_frame
from mbkf.imu.orientation import OrientSettings
from mbkf.trial.inertial.orient import orient, orientation_summary, prepared
from tests.imu.turning import turning

MADE = turning(5.0, rate_rad_s=2.0)
ONE = MADE.readings()


@pytest.mark.slow
def test_errors_are_those_against_the_reference_whatever_the_frame():
    found = {frame: orient([ONE], frame=frame).errors for frame in ("NWU", "NED")}
    assert found["NWU"][0][0] == "a"
    assert found["NWU"][0][1].total == pytest.approx(found["NED"][0][1].total, abs=1e-9)
    enu = replace(ONE, orientation=change_frame(MADE.truth, "NWU", "ENU"), frame="ENU")
    assert orient([enu], frame="NED").errors[0][1].total == pytest.approx(found["NED"][0][1].total, abs=1e-9)
    assert orient([replace(ONE, frame="somewhere")], frame="NED").errors == ()


def test_two_filters_are_compared():
    settings = OrientSettings("ekf")
    result = orient([ONE], frame="NWU", settings=settings, compare="madgwick")
    summary = orientation_summary(result, settings)
    assert (summary["method"], summary["compared_with"]) == ("ekf", "madgwick")
    row = summary["sensors"][0]
    assert 0.0 < row["difference_rms_deg"]["total"] < 10.0
    assert row["error_deg"]["samples"] == ONE.samples
    assert row["missing_fraction"] == 0.0


def test_bad_readings_are_refused_and_poor_ones_told():
    with pytest.raises(InvalidInput, match="deg/s"):
        orient([replace(ONE, angular_velocity_rad_s=ONE.angular_velocity_rad_s * 180 / np.pi)], frame="NWU")
    force = ONE.specific_force_mps2.copy()
    force[200:220] = np.nan
    assert "gap" in orient([replace(ONE, specific_force_mps2=force)], frame="NWU").warnings[0]


def test_sensors_are_chosen_by_name():
    both = [ONE, replace(ONE, name="b")]
    assert [one.name for one in prepared(both, ["b"])[0]] == ["b"]
    with pytest.raises(UnknownName, match="b"):
        prepared(both, ["c"])
    with pytest.raises(InvalidInput, match="same name"):
        prepared([ONE, ONE])


def test_errors_over_movement_phases_are_told_where_the_file_marks_them(real_data):
    from mbkf.io.imu.files import read_imu

    (one,) = read_imu(real_data / "imu_broad" / "16_undisturbed_fast_translation_B.mat")
    assert one.moving is not None and 0.3 < one.moving.mean() < 1.0
    result = orient([one], frame="ENU", settings=OrientSettings("madgwick"))
    ((name, whole),), ((same, moving),) = result.errors, result.moving_errors
    assert name == same == one.name and moving.samples < whole.samples
    summary = orientation_summary(result, OrientSettings("madgwick"))
    assert summary["sensors"][0]["error_moving_deg"]["samples"] == moving.samples
