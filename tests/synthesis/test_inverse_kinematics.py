"""Centre of mass and feet are where they were asked for, and the coordinates are the model's own."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.synthesis.composition import compose
from mbkf.synthesis.inverse_kinematics import InverseKinematics
from mbkf.synthesis.stand import stand_plan


@pytest.fixture(scope="module")
def standing(body):
    plan = stand_plan(body, 1.0, np.random.default_rng(1))
    return plan, compose(body, plan)


def test_centre_of_mass_and_feet_are_where_they_were_asked(body, standing):
    plan, composition = standing
    times = np.linspace(0, 1, 5)
    q, _, _ = composition.coordinates(times)
    com = np.array([body.centre_of_mass(x) for x in q])
    assert np.abs(com - composition.com(times).value).max() < 1e-10
    ankles = np.array([body.placements(x)[1][body.joint("left_foot").joint_id] for x in q])
    assert np.abs(ankles - plan.feet(times)["l"].ankle.value).max() < 1e-10


def test_momentum_is_pinocchios(body, standing):
    _, composition = standing
    times = np.linspace(0, 1, 5)
    pose = composition.pose(times)
    q, v, _ = composition.coordinates(times)
    data = pin.Data(body.pin_model)
    expected = [
        pin.computeCentroidalMomentum(body.pin_model, data, *state).angular.copy()
        for state in zip(q, v, strict=True)
    ]
    com, (spin, _) = composition.kinematics.momentum(pose)
    assert np.abs(spin - expected).max() < 1e-10
    assert np.abs(com.value[0] - body.centre_of_mass(q[0])).max() < 1e-10


def test_masses_add_up(body):
    assert InverseKinematics(body).total_mass == pytest.approx(body.mass_kg, abs=1e-9)
