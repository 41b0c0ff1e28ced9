"""Plates with a wrong sign, unit or place are named before anything is scaled, right ones never."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import Capture
from mbkf.io.wrench import centre_of_pressure
from mbkf.trial.checks.plate_contradictions import plate_contradictions
from tests.checked import recorded

UP = np.array([0.0, 0.0, 1.0])


def capture(name="walk", *, force=1.0, moment=1.0, corners=1.0, shift_m=0.0):
    """A trial whose plates are read with wrong factors, or placed elsewhere."""

    def read(plate):
        f, m = force * plate.force_n, moment * plate.moment_nm
        placed = corners * plate.corners_m + [shift_m, 0.0, 0.0]
        origin = placed.mean(axis=0)
        pressed = centre_of_pressure(f, m, origin, UP, plate.threshold_n)
        return replace(
            plate, force_n=f, moment_nm=m, corners_m=placed, origin_m=origin, centre_of_pressure_m=pressed
        )

    one = recorded(name)
    return Capture("", one.markers, tuple(read(plate) for plate in one.plates))


@pytest.mark.parametrize("name", ["walk", "squat"])
def test_right_plates_contradict_nothing(name):
    assert plate_contradictions(capture(name)) == ()
    bare = replace(capture(name), plates=tuple(replace(p, corners_m=None) for p in capture(name).plates))
    assert plate_contradictions(bare) == ()
    assert plate_contradictions(replace(bare, plates=())) == ()
    assert plate_contradictions(capture(name, force=np.nan)) == (), "nothing was read"


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"force": -1.0, "moment": -1.0}, "pull feet down; check their sign"),
        ({"force": 1e-3, "moment": 1e-3}, "s; check the unit of their forces"),
        ({"force": 0.0, "moment": 0.0}, "at most 0 N, and a foot stands on one for"),
        ({"moment": 1e3}, "m outside the area; check corners, and the unit of the moments"),
        ({"moment": 1e-3}, "mm of the middle; check the unit of the moments"),
        ({"corners": 1e3}, "m; check the unit of the corners"),
        ({"corners": 0.1}, "m; check the unit of the corners"),
        ({"shift_m": 2.0}, "m beside the feet; check the corners, their unit and axes"),
    ],
)
def test_each_fault_is_named_once_with_its_plates(wrong, message):
    (found,) = plate_contradictions(capture("squat", **wrong))
    assert message in found
    assert found.startswith("the force plates read" if wrong.get("force", -1.0) >= 0.0 else "force plates '")


def test_a_load_that_was_zeroed_and_lifted_is_no_wrong_sign():
    whole = capture("squat")
    far = whole.plates[0].corners_m + 3.0 * np.array([1.0, 0.0, 0.0])
    lifted = replace(
        whole.plates[0],
        name="box",
        force_n=np.zeros_like(whole.plates[0].force_n) - 150.0 * UP,
        corners_m=far,
        origin_m=far.mean(axis=0),
        centre_of_pressure_m=np.full_like(whole.plates[0].force_n, np.nan),
    )
    assert plate_contradictions(replace(whole, plates=(*whole.plates, lifted))) == ()
    heavy = replace(lifted, force_n=2.0 * lifted.force_n)
    assert len(plate_contradictions(replace(whole, plates=(*whole.plates, heavy)))) == 1
