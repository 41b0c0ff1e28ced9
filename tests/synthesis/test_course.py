"""A motion put together from parts: how high it stands, where it faces, and whether the time is enough."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.curves import path
from mbkf.synthesis.step_up import STEP_UP_S, add_step_up
from mbkf.synthesis.turn import add_turn, turn_seconds

SECONDS = 5.0


@pytest.fixture
def course(body):
    return Course(body, np.random.default_rng(2))


def test_the_body_rises_by_the_height_of_the_step_softly(course):
    course.now_s = 0.5
    add_step_up(course, 0, 0.18)
    assert course.now_s == pytest.approx(0.5 + STEP_UP_S)
    height = course.plan(SECONDS).height(np.linspace(0, SECONDS, 501))
    assert height.value[-1] - height.value[0] == pytest.approx(0.18, abs=0.01)
    assert np.abs(height.second).max() < 0.25 * GRAVITY_M_S2
    assert np.abs(height.first[[0, -1]]).max() < 1e-9


def test_raised_arms_lift_the_centre_of_mass_not_the_knees(course):
    raised = path([(1.0, 0.0), (2.5, 1.0), (4.0, 0.0)])
    course.bend(raised, {f"{side}_upper_arm": (0.0, -150.0, 0.0) for side in ("right", "left")})
    height = course.plan(SECONDS).height(np.array([0.0, 2.5, SECONDS]))
    assert height.value[1] - height.value[0] > 0.02
    assert height.value[2] == pytest.approx(height.value[0], abs=0.005)


@pytest.mark.parametrize("side", [0, 1])
def test_the_body_faces_where_the_feet_point_and_looks_ahead(course, side):
    begin = course.heading()
    add_turn(course, side, 1.2, 2, 0.4)
    assert course.now_s == pytest.approx(turn_seconds(2))
    sign = -1.0 if side == 0 else 1.0
    assert course.heading() - begin == pytest.approx(sign * 1.2)
    plan, times = course.plan(SECONDS), np.linspace(0, SECONDS, 501)
    pelvis = plan.angles["pelvis"][2](times).value
    assert sign * (pelvis[-1] - pelvis[0]) == pytest.approx(1.2, abs=0.1)
    turning = sign * np.sum([plan.angles[joint][2](times).value for joint in ("torso", "head")], axis=0)
    busy = (times > 0.7) & (times < course.now_s - 0.3)
    assert turning[busy].mean() > turning[times > course.now_s].mean() + 0.05


def test_time_that_is_left_over():
    assert spare(4.0, 3.0, "turning") == 1.0
    with pytest.raises(InvalidInput, match="turning takes"):
        spare(2.0, 3.0, "turning")
