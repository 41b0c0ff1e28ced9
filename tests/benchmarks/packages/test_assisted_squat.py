"""The example of optimal control: its physics is looked at by Pinocchio, and a squat out of reach is one sentence."""

import dataclasses
import runpy

import numpy as np
import pytest

import mbkf
from benchmarks.packages.assisted_squat import EXAMPLE, MARGIN, breach
from mbkf.errors import NotConverged

FOUND = runpy.run_path(str(EXAMPLE), run_name="example")
PLANAR = FOUND["PlanarBody"](mbkf.HumanModel.scaled({}, 80.0))
FOUND["planar"] = PLANAR
SQUAT = FOUND["optimal_squat"](PLANAR, 40.0, intervals=8)


def test_an_optimal_squat_obeys_newton_and_keeps_contact():
    residual, moved_m, unbalanced = FOUND["physics"](PLANAR, SQUAT)
    assert residual < 1e-6
    assert moved_m < 1e-9
    assert unbalanced < 1e-2
    assert breach(FOUND, SQUAT) < MARGIN
    assert np.rad2deg(SQUAT.nodes[1, 4]) == pytest.approx(90.0)


@pytest.mark.parametrize("spoilt", ["accelerations", "reactions", "torques"])
def test_a_squat_that_breaks_newtons_law_is_seen(spoilt):
    other = dataclasses.replace(SQUAT, **{spoilt: getattr(SQUAT, spoilt) * 1.001})
    assert FOUND["physics"](PLANAR, other)[0] > 1e-3


def test_a_slip_and_a_motor_that_is_too_strong_are_seen():
    slip = dataclasses.replace(SQUAT, reactions=SQUAT.reactions + 500.0 * np.eye(3)[:, :1])
    strong = dataclasses.replace(SQUAT, motor=SQUAT.motor + 1.0)
    assert breach(FOUND, slip) > 0.1
    assert breach(FOUND, strong) > 0.9


def test_a_squat_out_of_reach_is_reported_with_depth_and_status():
    with pytest.raises(NotConverged, match=r"squat of 170 degrees with '\w+' after \d+ iterations; choose"):
        FOUND["optimal_squat"](PLANAR, 0.0, depth_deg=170.0, intervals=4, iterations=40)


def test_both_sides_of_a_mirrored_body_are_of_one_size():
    person, _ = mbkf.synthesise("squat", seconds=1.0, seed=5)
    body = FOUND["mirrored_body"](person)
    factors = dict(zip(body.description.scale_factors, body.scale, strict=True))
    right, left = (person.scale_factors[f"{side}_thigh"] for side in ("right", "left"))
    assert right != left
    assert factors["right_thigh"] == factors["left_thigh"] == pytest.approx(0.5 * (right + left))
