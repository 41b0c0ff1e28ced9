"""Momentum and weight are linear in inertial parameters: against Pinocchio, derivatives by finite differences."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.io.inertia import SegmentInertia
from mbkf.model.human import HumanModel
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from tests.motions import assert_near, moderate_pose, random_model

MODEL = random_model(np.random.default_rng(3))
REGRESSOR = InertialRegressor(MODEL)
SIZE = PER_OWN * len(REGRESSOR.names)


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def test_momentum_is_pinocchios(rng):
    q, v = moderate_pose(MODEL, rng), rng.normal(size=MODEL.nv)
    data = pin.Data(MODEL.pin_model)
    pin.computeCentroidalMomentum(MODEL.pin_model, data, q, v)
    expected = data.hg.vector.copy()
    expected[3:] += np.cross(data.com[0], expected[:3])
    assert_near(REGRESSOR.momentum(q, v) @ REGRESSOR.table(), expected, 1e-12)


def test_rate_of_momentum_less_weight_is_inverse_dynamics_at_the_root(rng):
    """The six equations of the pelvis, moved to the world's origin and axes."""
    q, v, a, dt = moderate_pose(MODEL, rng), rng.normal(size=MODEL.nv), rng.normal(size=MODEL.nv), 1e-5
    parameters = REGRESSOR.table()

    def momentum(t):
        return REGRESSOR.momentum(MODEL.integrate(q, v * t + 0.5 * a * t**2), v + a * t) @ parameters

    own = MODEL.inverse_dynamics(q, v, a)[:6]
    rotations, origins = MODEL.placements(q)
    force, moment = rotations[1] @ own[:3], rotations[1] @ own[3:]
    expected = np.concatenate([force, moment + np.cross(origins[1], force)])
    assert_near((momentum(dt) - momentum(-dt)) / (2 * dt) - REGRESSOR.weight(q) @ parameters, expected, 1e-5)


def test_own_parameters_are_those_of_a_body_with_them(rng):
    differs = 0.05 * rng.normal(size=SIZE)
    found, _ = REGRESSOR.own(differs)
    inertia = {
        name: SegmentInertia(1.0 + own[0], own[1:])
        for name, own in zip(REGRESSOR.names, differs.reshape(-1, PER_OWN), strict=True)
    }
    body = HumanModel(MODEL.description, MODEL.scale, found[::PER_SEGMENT].sum(), inertia)
    assert_near(InertialRegressor(body).table(), found, 1e-13)
    assert_near(REGRESSOR.own(np.zeros(SIZE))[0], REGRESSOR.table(), 1e-15)


def test_derivatives_of_own_parameters(rng):
    at, step = 0.05 * rng.normal(size=SIZE), 1e-6
    columns = [
        (REGRESSOR.own(at + step * e)[0] - REGRESSOR.own(at - step * e)[0]) / (2 * step) for e in np.eye(SIZE)
    ]
    assert_near(REGRESSOR.own(at)[1], np.array(columns).T, 1e-8)
