"""The kernel reads worn sensors and resting points as the blocks' references do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.imu.placement import typical_mounts
from mbkf.kernel.loading import library
from mbkf.sensors.block import OperatingPoint
from mbkf.sensors.body_sensors import BodySensors
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.standing_feet import StandingFeet
from tests.dynamics import singer
from tests.motions import moderate_pose, random_model, worst

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

ROUNDING = 1e-12
SEGMENTS = ("pelvis", "torso", "right_thigh", "left_foot")


def assert_same(found, expected):
    assert found.shape == expected.shape
    assert worst(found - expected) <= ROUNDING * worst(expected)


def moving(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    q = moderate_pose(model, rng)
    q[:3] = 3.0 * rng.normal(size=3)
    return rng, model, q, 2.0 * rng.normal(size=model.nv)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 1e-3, 0.7]))
def test_worn_sensors_read_as_the_reference_has_it(seed, turned):
    rng, model, q, v = moving(seed)
    mounts, count = typical_mounts(model, SEGMENTS, seed=seed), len(SEGMENTS)
    block = BodySensors(InertialSensor(model, mounts), *np.ones((3, count, 3)))
    plant = singer(model, block.states())
    block.bind(plant.layout, model)
    biases, turns = 0.1 * rng.normal(size=(count, 3)), turned * rng.normal(size=(count, 3))
    extra, measured = np.concatenate([biases.ravel(), turns.ravel()]), 5.0 * rng.normal(size=(count, 6))
    state = DynamicState(
        q, v, 9.0 * rng.normal(size=model.nv), np.zeros(12), np.eye(plant.layout.size), extra
    )
    found = block.linearise(OperatingPoint(state, None), measured)
    rows, innovation = block._reference_rows(state, biases, turns, measured)
    assert_same(found.jacobian, rows)
    assert_same(found.innovation, innovation)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_points_of_the_feet_move_as_the_reference_has_it(seed):
    rng, model, q, v = moving(seed)
    feet = [model.joint(name).joint_id for name in model.roles.feet]
    joints, points = np.array([*feet, feet[0]], dtype=np.int32), 3.0 * rng.normal(size=(3, 3))
    found = model.tree.carried_points(q, v, joints, points)
    for one, other in zip(found, StandingFeet(model, 0.01)._reference(q, v, joints, points), strict=True):
        assert_same(one, other)
