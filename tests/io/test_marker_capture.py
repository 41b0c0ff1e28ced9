"""Coordinates of a file as a capture: whose unit and axis hold, and what is said of them."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.marker_capture import StatedUnit, marker_capture
from mbkf.io.records import AxesSource
from tests.io.c3d_builder import standing_points

FILE, NAMES = Path("a.txt"), tuple("abcdefgh")


def capture(options, unit="mm", up="z", **more):
    return marker_capture(FILE, NAMES, standing_points(5), 100.0, 0.5, up, unit, options, ["first"], **more)


def test_the_unit_of_the_options_goes_before_the_files_and_that_before_the_default():
    notes = []
    stated = StatedUnit("Units", "Millimeters", "m")
    assert stated.of(FILE, CaptureOptions(unit="cm"), notes) == "cm"
    assert stated.of(FILE, CaptureOptions(), notes) == "mm" and notes == []
    assert StatedUnit("Units", "", "m").of(FILE, CaptureOptions(), notes) == "m"
    assert notes == ["Units states no length unit; lengths taken as m, the format's default"]
    with pytest.raises(FileFormatError, match=r"a\.txt, line 3: Units is 'ells', not a unit of length"):
        StatedUnit("Units", "ells", "m", 3).of(FILE, CaptureOptions(), notes)
    with pytest.raises(UnknownName):
        stated.of(FILE, CaptureOptions(unit="ells"), notes)


def test_places_are_metres_in_world_axes_with_where_the_axis_is_from():
    found = capture(CaptureOptions(), up="y", source=AxesSource.SCREEN)
    np.testing.assert_allclose(found.markers.positions_m[0, :, 2], standing_points(1)[0, :, 1] / 1e3)
    assert (found.axes, found.axes_source, found.notes) == ("x,-z,y", AxesSource.SCREEN, ("first",))
    assert (found.markers.names, found.markers.start_time_s) == (NAMES, 0.5)
    assert capture(CaptureOptions(up="z")).axes_source == AxesSource.UP_GIVEN


def test_a_body_of_another_size_is_refused_unless_the_unit_was_given():
    with pytest.raises(InvalidInput, match="read in m, the markers spread over"):
        capture(CaptureOptions(), unit="m")
    assert capture(CaptureOptions(unit="m"), unit="m").markers.positions_m.max() > 1e3
