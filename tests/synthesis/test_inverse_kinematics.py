"""Centre of mass and feet are where they were asked for, and the coordinates are the model's own."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.synthesis.composition import compose
from mbkf.synthesis.coordinates import coordinates
from mbkf.synthesis.kneel import kneel_plan
from mbkf.synthesis.stand import stand_plan


@pytest.fixture(scope="module")
def standing(body):
    plan = stand_plan(body, 1.0, np.random.default_rng(1))
    return plan, compose(body, plan)


def test_centre_of_mass_and_feet_are_where_they_were_asked(body, standing):
    plan, composition = standing
    times = np.linspace(0, 1, 5)
    q, _, _ = coordinates(body, composition.pose(times))
    com = np.array([body.centre_of_mass(x) for x in q])
    assert np.abs(com - composition.com(times).value).max() < 1e-10
    ankles = np.array([body.placements(x)[1][body.joint("left_foot").joint_id] for x in q])
    assert np.abs(ankles - plan.feet(times)["l"].ankle.value).max() < 1e-10


def test_momentum_is_pinocchios(body, standing):
    _, composition = standing
    times = np.linspace(0, 1, 5)
    pose = composition.pose(times)
    q, v, a = coordinates(body, pose)
    data = pin.Data(body.pin_model)
    expected = [
        pin.computeCentroidalMomentumTimeVariation(body.pin_model, data, *state).angular.copy()
        for state in zip(q, v, a, strict=True)
    ]
    com, (spin, change) = composition.kinematics.momentum(pose)
    assert np.abs(change - expected).max() < 1e-9
    for k, state in enumerate(zip(q, v, strict=True)):
        moving = pin.computeCentroidalMomentum(body.pin_model, data, *state)
        assert np.abs(spin[k] - moving.angular).max() < 1e-10
    assert np.abs(com.value[0] - body.centre_of_mass(q[0])).max() < 1e-10


def test_a_kneeling_body_moves_with_its_centre_of_mass(body):
    """A leg whose knee bends towards a point, and an arm whose hand comes and goes."""
    composition = compose(body, kneel_plan(body, 6.8, np.random.default_rng(1)))
    times = np.linspace(0.0, 6.8, 35)
    wanted, (com, rates) = composition.com(times), composition.kinematics.momentum(composition.pose(times))
    for found, asked, tolerance in zip(com.orders, wanted.orders, (1e-12, 1e-11, 1e-9), strict=True):
        assert np.abs(found - asked).max() < tolerance
    slow, still = (composition.com(times).upto(order) for order in (1, 0))
    posture = composition.posture(composition.given(times))
    same, (less,) = composition.kinematics.momentum(composition.kinematics.pose(slow, posture))
    assert np.abs(less - rates[0]).max() < 1e-9
    assert len(same.orders) == 2
    assert len(composition.kinematics.pose(still, posture).origins["pelvis"].orders) == 1
