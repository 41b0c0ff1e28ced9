"""The example of optimal control: its physics is looked at by Pinocchio, and a squat out of reach is one sentence."""

import dataclasses
import runpy

import numpy as np
import pytest

import mbkf
from benchmarks.packages.assisted_squat import EXAMPLE, MARGIN, breach
from mbkf.errors import NotConverged


@pytest.fixture(scope="module")
def example():
    """The example's functions, and a body in the plane."""
    found = runpy.run_path(str(EXAMPLE), run_name="example")
    return {**found, "planar": found["PlanarBody"](mbkf.HumanModel.scaled({}, 80.0))}


@pytest.fixture(scope="module")
def squat(example):
    """A squat with the motor, on a coarse mesh."""
    return example["optimal_squat"](example["planar"], 40.0, intervals=8)


def test_an_optimal_squat_obeys_newton_and_keeps_contact(example, squat):
    residual, moved_m, unbalanced = example["physics"](example["planar"], squat)
    assert residual < 1e-6
    assert moved_m < 1e-9
    assert unbalanced < 1e-2
    assert breach(example, squat) < MARGIN
    assert np.rad2deg(squat.nodes[1, 4]) == pytest.approx(90.0)


@pytest.mark.parametrize("spoilt", ["accelerations", "reactions", "torques"])
def test_a_squat_that_breaks_newtons_law_is_seen(example, squat, spoilt):
    other = dataclasses.replace(squat, **{spoilt: getattr(squat, spoilt) * 1.001})
    assert example["physics"](example["planar"], other)[0] > 1e-3


def test_a_slip_and_a_motor_that_is_too_strong_are_seen(example, squat):
    slip = dataclasses.replace(squat, reactions=squat.reactions + 500.0 * np.eye(3)[:, :1])
    strong = dataclasses.replace(squat, motor=squat.motor + 1.0)
    assert breach(example, slip) > 0.1
    assert breach(example, strong) > 0.9


def test_a_squat_out_of_reach_is_reported_with_depth_and_status(example):
    with pytest.raises(NotConverged, match=r"squat of 170 degrees with '\w+' after \d+ iterations; choose"):
        example["optimal_squat"](example["planar"], 0.0, depth_deg=170.0, intervals=4, iterations=40)


def test_both_sides_of_a_mirrored_body_are_of_one_size(example):
    person, _ = mbkf.synthesise("squat", seconds=1.0, seed=5)
    body = example["mirrored_body"](person)
    factors = dict(zip(body.description.scale_factors, body.scale, strict=True))
    right, left = (person.scale_factors[f"{side}_thigh"] for side in ("right", "left"))
    assert right != left
    assert factors["right_thigh"] == factors["left_thigh"] == pytest.approx(0.5 * (right + left))
