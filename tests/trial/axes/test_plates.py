"""What plates tell: where they push a person, and whether the feet are above them."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import AxesSource
from mbkf.io.turning import turned
from mbkf.model.protocol import load_protocol
from mbkf.trial.axes.evidence import marker_places
from mbkf.trial.axes.plates import LEAST_SAMPLES, contradiction, pushed_away
from tests.captures import made_capture

PROTOCOL = load_protocol("reference36")
CAPTURE = made_capture(10)
PLACES = marker_places(CAPTURE.markers.names, PROTOCOL.match(CAPTURE.markers.names), PROTOCOL.body)
BARE = replace(CAPTURE, plates=tuple(replace(plate, corners_m=None) for plate in CAPTURE.plates))
UPSIDE_DOWN = np.diag([1.0, -1.0, -1.0])


def test_plates_push_upwards_or_nowhere():
    assert pushed_away(CAPTURE.plates) == ""
    assert pushed_away(()) == ""
    unloaded = [replace(plate, force_n=0.01 * plate.force_n) for plate in CAPTURE.plates]
    assert (
        pushed_away(turned(replace(BARE, plates=tuple(unloaded)), UPSIDE_DOWN, AxesSource.BODY).plates) == ""
    )


@pytest.mark.parametrize(
    ("turn", "axis"), [(UPSIDE_DOWN, "-z"), (np.eye(3)[[2, 0, 1]], "x"), (np.eye(3)[[1, 2, 0]], "y")]
)
def test_a_wrong_push_is_named_by_its_axis(turn, axis):
    assert f"along {axis} of" in pushed_away(turned(BARE, turn, AxesSource.BODY).plates)


def test_few_samples_tell_nothing():
    plate = turned(BARE, UPSIDE_DOWN, AxesSource.BODY).plates[0]
    few = slice(LEAST_SAMPLES - 1)
    short = replace(
        plate,
        force_n=plate.force_n[few],
        moment_nm=plate.moment_nm[few],
        centre_of_pressure_m=plate.centre_of_pressure_m[few],
    )
    assert pushed_away([short]) == ""


def test_turns_that_leave_the_floor_below_agree_with_the_plates():
    for turn in (np.eye(3), np.diag([-1.0, -1.0, 1.0])):
        assert contradiction(CAPTURE, turn, PLACES) == ""
    assert contradiction(BARE, np.diag([1.0, -1.0, 1.0]), PLACES) == "", "no corners, so no sign of a mirror"
    assert "right and left" in contradiction(CAPTURE, np.diag([1.0, -1.0, 1.0]), PLACES)
    assert "surfaces face" in contradiction(CAPTURE, UPSIDE_DOWN, PLACES)
    assert "push along -z" in contradiction(BARE, UPSIDE_DOWN, PLACES)


def test_plates_beside_the_feet_are_noticed():
    plate, metre = BARE.plates[0], np.array([0.0, 1.0, 0.0])
    aside = replace(
        plate, centre_of_pressure_m=plate.centre_of_pressure_m + metre, origin_m=plate.origin_m + metre
    )
    assert "beside the feet" in contradiction(
        replace(BARE, plates=(aside,)), np.diag([1.0, -1.0, 1.0]), PLACES
    )


def test_one_odd_sample_turns_no_capture():
    force = np.array(CAPTURE.plates[0].force_n)
    force[3], force[4] = [1e9, 0.0, 0.0], np.nan
    odd = replace(CAPTURE.plates[0], force_n=force)
    assert pushed_away([odd, CAPTURE.plates[1]]) == ""


def test_a_plate_of_the_wrong_sign_does_not_doubt_the_axes():
    """It is told, and left out, where the readings are judged; where all plates pull, the vertical is wrong."""
    right, left = CAPTURE.plates
    pulling = replace(left, force_n=-3.0 * left.force_n)
    assert pushed_away([right, pulling]) == ""
    assert "along -z of" in pushed_away([pulling, pulling])
