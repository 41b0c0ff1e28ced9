"""The plans of the motions: feet that stay put while they carry, and never go through the floor."""

import numpy as np
import pytest

from mbkf.synthesis import dual_numbers
from mbkf.synthesis.contact import sole_outline
from mbkf.synthesis.general import general_plan
from mbkf.synthesis.jump import jump_plan
from mbkf.synthesis.kneel import kneel_plan
from mbkf.synthesis.one_foot import one_foot_plan
from mbkf.synthesis.plan import JOINTS, MotionPlan
from mbkf.synthesis.rail import rail_plan
from mbkf.synthesis.reach import reach_plan
from mbkf.synthesis.sit_to_stand import sit_to_stand_plan
from mbkf.synthesis.squat import squat_plan
from mbkf.synthesis.stand import stand_plan
from mbkf.synthesis.standing import pressed
from mbkf.synthesis.step_up import step_up_plan
from mbkf.synthesis.turn import turn_plan
from mbkf.synthesis.walk import walk_plan

PLANS = {
    "stand": (stand_plan, 3.0),
    "squat": (squat_plan, 3.0),
    "walk": (walk_plan, 3.0),
    "jump": (jump_plan, 3.0),
    "turn": (turn_plan, 4.0),
    "one_foot": (one_foot_plan, 5.0),
    "reach": (reach_plan, 3.0),
    "step_up": (step_up_plan, 3.5),
    "general": (general_plan, 10.0),
    "kneel": (kneel_plan, 6.8),
    "rail": (rail_plan, 3.2),
    "sit_to_stand": (sit_to_stand_plan, 5.6),
}


@pytest.fixture(params=PLANS, scope="module")
def plan(request, body):
    make, seconds = PLANS[request.param]
    return make(body, seconds, np.random.default_rng(7))


def sole(body, side, foot, x):
    """(T, 3) dual number of the point of the sole at x, in the foot's frame."""
    turned = dual_numbers.rotation(2, foot.yaw) @ dual_numbers.rotation(1, foot.pitch)
    return foot.ankle + turned.apply(np.array([x, 0.0, sole_outline(body, side).height]))


def test_every_joint_is_planned(plan):
    assert isinstance(plan, MotionPlan)
    planned = set(plan.angles) | ({"pelvis"} if plan.flight else set())
    assert planned == {"pelvis", *JOINTS}


def test_feet_stay_above_the_floor_but_for_the_round_heel(plan, body):
    times = np.linspace(0, 3, 601)
    surfaces = plan.load(times).surfaces.min(axis=1)
    for side, foot in plan.feet(times).items():
        outline = sole_outline(body, side)
        toes = body.description.segment("right_toes").origin_m[0]
        assert (sole(body, side, foot, 0.95 * toes).value[:, 2] - surfaces).min() > -0.004
        assert (sole(body, side, foot, outline.heel_x).value[:, 2] - surfaces).min() > -0.010


def test_loaded_feet_touch_what_bears_them(plan, body):
    """Until the end of their load, with the heel or about the joints of the toes, over which they roll."""
    times = np.linspace(0.0, 3.0, 601)
    load, toes = plan.load(times), body.description.segment("right_toes").origin_m[0]
    for foot, (side, pose) in enumerate(plan.feet(times).items()):
        ends = [sole(body, side, pose, x).value[:, 2] for x in (sole_outline(body, side).heel_x, toes)]
        loaded = (load.shares[:, foot] > 0) & load.grounded
        assert (np.minimum(*ends) - load.surfaces[:, foot])[loaded].max() < 0.03, side


def test_loaded_feet_do_not_slide(plan, body):
    times = np.linspace(0.0, 3.0, 601)
    load = plan.load(times)
    for foot, (side, pose) in enumerate(plan.feet(times).items()):
        steady = (load.shares[:, foot] > 0) & load.grounded & (np.abs(pose.pitch.first) < 1e-12)
        assert steady.any()
        assert np.abs(pose.ankle.first[steady]).max() < 1e-9, side


def test_motion_is_smooth(plan):
    """Neither joint angles nor feet jump in position, velocity or acceleration."""
    times, h = np.linspace(0.0005, 2.9995, 2999), 1e-6
    curves = [curve for axes in plan.angles.values() for curve in axes]
    for curve in (*curves, plan.height):
        late, early = curve(times + h), curve(times - h)
        assert np.abs(late.value - early.value).max() < 1e-3
        assert np.abs(late.first - early.first).max() < 1e-2
    late, early = plan.feet(times + h), plan.feet(times - h)
    for side in late:
        assert np.abs(late[side].ankle.first - early[side].ankle.first).max() < 1e-2
        assert np.abs(late[side].ankle.second - early[side].ankle.second).max() < 0.5


def test_pressed_is_ahead_of_the_ankle(plan):
    foot = plan.feet(np.array([0.0]))["r"]
    c, s = np.cos(foot.yaw.value[0]), np.sin(foot.yaw.value[0])
    assert np.allclose(pressed(foot, np.array([0.1]))[0], foot.ankle.value[0, :2] + 0.1 * np.array([c, s]))
