"""Labels become unique, missing samples NaN, derived points stand apart."""

import numpy as np
import pytest

from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.c3d_points import point_labels
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import build_c3d, standing_points


@pytest.mark.parametrize(
    ("stored", "expected", "remarks"),
    [
        (["A", "B"], ["A", "B", "*2"], 1),
        (["Anna:LASI", "Anna:RASI", "Anna:C7"], ["LASI", "RASI", "C7"], 0),
        (["Anna:LASI", "Bob:LASI", "C7"], ["Anna:LASI", "Bob:LASI", "C7"], 0),
        (["A", "A", "A"], ["A", "A_2", "A_3"], 1),
        (["A", "A_2", "A"], ["A", "A_2", "A_3"], 1),
        (["", "*1", ""], ["*0", "*1", "*2"], 0),
        (["A", "B", "C", "", ""], ["A", "B", "C"], 0),
        (["A", "B", "C", "D", ""], ["A", "B", "C"], 1),
        (np.ones(3), ["*0", "*1", "*2"], 1),
    ],
)
def test_labels(stored, expected, remarks):
    notes: list[str] = []
    assert point_labels(C3dParameters({"POINT": {"LABELS": stored}}), 3, notes) == expected
    assert len(notes) == remarks


@pytest.mark.parametrize(
    ("maker", "descriptions", "expected"),
    [
        ("Motion Analysis Corp.", ["R.Heel", "R.Hip", "R.Hand"], ["R.Heel", "R.Hip", "R.Hand"]),
        ("Motion Analysis Corp.", ["R.Heel", "", "R.Hand"], ["R.He", "R.Hi", "R.Ha"]),
        ("Motion Analysis Corp.", ["Heel", "Heel", "Hand"], ["R.He", "R.Hi", "R.Ha"]),
        ("Vicon", ["R.Heel", "R.Hip", "R.Hand"], ["R.He", "R.Hi", "R.Ha"]),
    ],
)
def test_whole_names_of_motion_analysis_stand_in_descriptions(maker, descriptions, expected):
    point = {"LABELS": ["R.He", "R.Hi", "R.Ha"], "DESCRIPTIONS": descriptions}
    notes: list[str] = []
    parameters = C3dParameters({"POINT": point, "MANUFACTURER": {"COMPANY": [maker]}})
    assert point_labels(parameters, 3, notes) == expected
    assert bool(notes) is (expected == descriptions)


def test_negative_residual_and_exact_zero_are_missing(tmp_path):
    points = standing_points(5, 6)
    points[2, 3] = 0.0
    residuals = np.zeros((5, 6))
    residuals[1, 4] = -1.0
    markers = read_c3d(build_c3d(tmp_path / "a.c3d", points, residuals=residuals), CaptureOptions()).markers
    expected = np.ones((5, 6), bool)
    expected[2, 3] = expected[1, 4] = False
    np.testing.assert_array_equal(markers.present, expected)
    np.testing.assert_allclose(markers.positions_m[expected], points[expected] / 1000.0, rtol=1e-6)


def test_more_points_than_one_parameter_holds(tmp_path):
    count = 600
    points = standing_points(3, count)
    labels = [f"P{i}" for i in range(count)]
    markers = read_c3d(build_c3d(tmp_path / "many.c3d", points, labels), CaptureOptions()).markers
    assert markers.names == tuple(labels)
    np.testing.assert_allclose(markers.positions_m, points / 1000.0, rtol=1e-6)


def test_derived_points_keep_their_unit_and_axes(tmp_path):
    labels = ["LASI", "RASI", "C7", "CLAV", "LKneeAngles", "Twist", "LHJC", "M7"]
    extra = {
        ("POINT", "ANGLES"): ["LKneeAngles"],
        ("POINT", "ANGLE_UNITS"): ["deg"],
        ("POINT", "MOMENTS"): ["Twist"],
        ("POINT", "MOMENT_UNITS"): ["Nmm"],
    }
    points = standing_points()
    capture = read_c3d(build_c3d(tmp_path / "d.c3d", points, labels, extra=extra), CaptureOptions(up="y"))
    assert capture.markers.names == ("LASI", "RASI", "C7", "CLAV", "M7")
    assert [(d.name, d.kind, d.unit) for d in capture.derived] == [
        ("LKneeAngles", "angle", "deg"),
        ("Twist", "moment", "Nmm"),
        ("LHJC", "point", "mm"),
    ]
    np.testing.assert_allclose(capture.derived[0].values, points[:, 4], rtol=1e-6)
