"""Real captures: the withheld plate, the table of moments, the rows of a summary, and one walk from the data."""

import numpy as np
import pytest

from benchmarks.dynamic.captures import (
    BOUNDS,
    LEFT,
    SOURCES,
    Bounds,
    Person,
    capture_rows,
    compare_withheld,
    load,
    moment_table,
    plate_under,
    summary_rows,
)
from benchmarks.dynamic.methods import Method
from benchmarks.dynamic.synthetic import MATCHED, make_case
from mbkf.errors import UnknownName
from mbkf.io.records import Capture

KINEMATIC = Method("kinematic")


@pytest.fixture(scope="module")
def squat():
    return make_case(("squat", 0), MATCHED, correct=False)


@pytest.fixture(scope="module")
def found(squat):
    return KINEMATIC.run(squat.capture, squat.subject)


def test_a_withheld_force_is_compared_in_the_judged_frames():
    measured = np.r_[np.nan, np.zeros(20), 500.0 + 100.0 * np.sin(np.arange(40) / 5.0), np.zeros(20)]
    judged = np.ones(81, dtype=bool)
    judged[70:] = False
    estimate = measured + 30.0
    estimate[75:] = 900.0
    found = compare_withheld(estimate, measured, judged, np.zeros(81, dtype=bool))
    assert found.r == pytest.approx(1.0)
    assert found.rms_n == pytest.approx(30.0)
    assert found.rms_everywhere_n > 200.0
    assert found.flagged == 1.0


def test_no_estimate_at_all_counts_as_no_force():
    measured = np.array([0.0, 100.0, 200.0])
    found = compare_withheld(np.full(3, np.nan), measured, np.ones(3, dtype=bool), np.ones(3, dtype=bool))
    assert np.isnan(found.r)
    assert found.rms_n == pytest.approx(np.sqrt(50000.0 / 3.0))
    assert found.flagged == 0.0


def test_moments_are_named_as_opensim_names_them(found):
    table = moment_table(found)
    np.testing.assert_array_equal(table.column("knee_angle_r_moment"), found.moment("knee_angle_r"))


def test_the_plate_under_a_foot_is_found_by_its_load(squat, found):
    person = Person("squat", squat.capture, squat.subject)
    name = plate_under(person, LEFT)
    withheld = KINEMATIC.run(squat.capture, squat.subject, without_plates=(name,))
    assert np.abs(withheld.foot_wrench[:, LEFT]).max() == 0.0
    np.testing.assert_allclose(withheld.foot_wrench[:, 0], found.foot_wrench[:, 0])
    with pytest.raises(UnknownName, match="plate"):
        plate_under(Person("bare", Capture("", squat.capture.markers), squat.subject), LEFT)


def test_a_summary_is_held_to_its_bounds_or_to_the_kinematic_filter():
    kinematic = {"marker_rms_mm": 5.0, "measured_frames": 100}
    summary = {
        "marker_rms_mm": 5.6,
        "residual_force_share": 0.04,
        "residual_lever_m": None,
        "measured_frames": 99,
        "plate_force_change_rms_n": 1.0,
    }
    rows = summary_rows("x", summary, kinematic, Bounds())
    assert [row.passed for row in rows] == [False, True, False, True]
    rows = summary_rows("x", summary, kinematic, Bounds(marker_mm=6.0, plates_n=2.0))
    assert [row.passed for row in rows] == [True, True, False, True, True]


def test_every_source_has_bounds():
    assert set(BOUNDS) == set(SOURCES)


def test_rajagopal_walk_gives_every_row_and_a_method_that_fails_its_own(real_data):
    person = load("rajagopal walk", real_data)
    assert plate_under(person, LEFT) == "l"
    rows = capture_rows("rajagopal walk", real_data, [KINEMATIC, Method("no such filter")])
    by_name = {row.name.partition(": ")[2]: row for row in rows}
    assert by_name["kinematic, marker RMS"].value < 5.5
    assert by_name["kinematic, ankle_angle torque against the 6 Hz reference, both at 6 Hz"].value < 0.1
    assert by_name["kinematic, without the left plate: its vertical force, RMS"].value > 400.0
    assert "no such filter does not run" in rows[-1].name
    assert not rows[-1].passed
