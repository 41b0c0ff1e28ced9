"""A seat without plates: the centre of pressure of the whole reaction, its distance from the feet, and who sits."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.numerics.runs import runs
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.sensors.supports.momentum import WholeBody
from mbkf.sensors.supports.seat import centre_on_floor, distance_to_feet, sits
from tests.dynamics import trial
from tests.motions import assert_near


def test_about_the_centre_on_the_floor_no_horizontal_moment_is_left():
    rng = np.random.default_rng(0)
    force = rng.normal(size=(20, 3)) * 50.0 + [0.0, 0.0, 700.0]
    centre, moment, floor = rng.normal(size=(20, 3)), rng.normal(size=(20, 3)) * 30.0, -0.2
    point = np.column_stack([centre_on_floor(np.hstack([force, moment]), centre, floor), np.full(20, floor)])
    left = moment - np.cross(point - centre, force)
    assert_near(left[:, :2], 0.0, 1e-9)


def test_distance_is_that_from_the_nearest_line_between_two_ends():
    soles = np.zeros((1, 2, 3, 2))
    soles[0, 0] = [[0.0, -0.1], [0.2, -0.1], [0.3, -0.1]]
    soles[0, 1] = [[0.0, 0.1], [0.2, 0.1], [0.3, 0.1]]

    def away(x, y):
        return distance_to_feet(np.array([[x, y]]), soles)[0]

    assert_near(
        [away(0.15, -0.1), away(0.0, 0.0), away(-0.4, 0.0), away(0.15, 0.4)], [0.0, 0.0, 0.4, 0.3], 1e-12
    )


def sitting(motion, fallen_m=0.0):
    """(T,) frames of a motion found to be sitting; the seat may be lower than the body has it, by (T,) metres."""
    made = trial(motion)
    model, q, v = made.model, made.motion.q, made.motion.v
    parts = BearingParts(model)
    at = [parts.at(*one) for one in zip(q, v, strict=True)]
    seat = np.array([one.points_m[parts.seat] for one in at])
    seat[:, 2] -= fallen_m
    speed = np.array([one.speeds_m_s[parts.seat] for one in at])
    return sits(WholeBody.of(model, q, v), sole_points(model, q), seat, speed, made.motion.rate_hz, 0.0)


@pytest.mark.parametrize(("motion", "seated"), [("sit_to_stand", True), ("squat", False), ("walk", False)])
def test_who_sits_is_found_and_nobody_else(motion, seated):
    made, found = trial(motion), sitting(motion)
    model = made.model
    if not seated:
        assert not found.any()
        return
    share = made.motion.support_wrench[:, 0, 2] / (9.80665 * model.mass_kg)
    inside = np.arange(len(share)) > 10
    assert found[(share > 0.6) & inside].all() and not found[share == 0.0].any()


def test_who_falls_while_sitting_does_not_sit():
    """A fall of a tenth of a second; one just before the seat bears is that of sitting down."""
    made = trial("sit_to_stand")
    found, rate_hz = sitting("sit_to_stand"), made.motion.rate_hz
    first, after = runs(found)[0]

    def fallen_from(frame):
        seconds = np.clip((np.arange(len(found)) - frame) / rate_hz, 0.0, 0.1)
        return 0.5 * GRAVITY_M_S2 * seconds**2

    middle = (first + after) // 2
    assert not sitting("sit_to_stand", fallen_from(middle))[first:after].any()
    before = fallen_from(first - round(0.1 * rate_hz))
    np.testing.assert_array_equal(sitting("sit_to_stand", before), found)
