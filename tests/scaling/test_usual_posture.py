"""Postures that people usually have: in movement, in straight standing, and with a joint held otherwise on purpose."""

import numpy as np
import pytest

from mbkf.scaling.usual_posture import ON_PURPOSE, UsualPosture
from mbkf.sensors.posture_sensor import PostureSensor
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
STANDING_SD = 0.14
USUAL = UsualPosture(PostureSensor(MODEL), STANDING_SD)


def cost(q, stands):
    return USUAL.costs(USUAL.sensor.deviation(q)[0][None], np.array([stands]))[0]


def equations(q, stands):
    return USUAL.equations(*USUAL.sensor.deviation(q), stands)


def turned(joint, angle_rad):
    step = np.zeros(MODEL.nv)
    step[MODEL.joint(joint).v.start] = angle_rad
    return MODEL.integrate(MODEL.neutral(), step)


@pytest.mark.parametrize("stands", [False, True])
def test_the_gradient_is_half_the_slope_of_the_cost(stands):
    rng, h = np.random.default_rng(1), 1e-6
    q, step = moderate_pose(MODEL, rng), rng.normal(size=MODEL.nv)
    slope = (cost(MODEL.integrate(q, h * step), stands) - cost(MODEL.integrate(q, -h * step), stands)) / (
        2 * h
    )
    assert 2 * equations(q, stands)[1] @ step == pytest.approx(slope, rel=1e-7)


def test_near_neutral_a_standing_joint_costs_the_square_of_its_angle():
    assert cost(turned("right_upper_arm", 1e-3), True) == pytest.approx((1e-3 / STANDING_SD) ** 2, rel=1e-4)
    assert cost(MODEL.neutral(), True) == 0.0


def test_a_stiff_joint_strays_no_further_in_standing_than_in_movement():
    assert (USUAL.standing_sd <= USUAL.sensor.sd).all()
    assert USUAL.standing_sd.max() == STANDING_SD


def test_an_arm_held_out_is_hardly_pulled():
    dof = MODEL.joint("right_upper_arm").v.start
    pull = [equations(turned("right_upper_arm", a), True)[1][dof] for a in (STANDING_SD, np.pi / 2)]
    assert pull[0] == pytest.approx(1.0 / STANDING_SD / (1.0 + ON_PURPOSE**-2))
    assert pull[1] < 0.5 * pull[0]
