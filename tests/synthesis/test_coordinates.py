"""The coordinates put the model's segments where the pose has them, and their rates are the configuration's own."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.synthesis.composition import compose
from mbkf.synthesis.coordinates import coordinates
from mbkf.synthesis.stand import stand_plan

TIMES, STEP_S = np.linspace(0.1, 0.9, 5), 1e-4


@pytest.fixture(scope="module")
def composition(body):
    return compose(body, stand_plan(body, 1.0, np.random.default_rng(1)))


def test_segments_are_where_the_pose_has_them(body, composition):
    pose = composition.pose(TIMES)
    q, _, _ = coordinates(body, pose)
    for k, configuration in enumerate(q):
        rotations, origins = body.placements(configuration)
        for name, origin in pose.origins.items():
            joint = body.joint(name).joint_id
            assert np.abs(origins[joint] - origin.value[k]).max() < 1e-12
            assert np.abs(rotations[joint] - pose.rotations[name].value[k]).max() < 1e-12


def test_velocity_and_acceleration_are_rates_along_the_configuration(body, composition):
    _, v, a = coordinates(body, composition.pose(TIMES))
    before, after = (coordinates(body, composition.pose(TIMES + step)) for step in (-STEP_S, STEP_S))
    for k in range(len(TIMES)):
        way = pin.difference(body.pin_model, before[0][k], after[0][k])
        assert np.abs(way / (2 * STEP_S) - v[k]).max() < 1e-6
        assert np.abs((after[1][k] - before[1][k]) / (2 * STEP_S) - a[k]).max() < 1e-6


def test_quaternions_do_not_jump(body, composition):
    q, _, _ = coordinates(body, composition.pose(np.linspace(0.0, 1.0, 101)))
    assert np.abs(np.diff(q, axis=0)).max() < 0.01


def test_every_third_frame_is_the_same_frame(body, composition):
    pose = composition.pose(np.linspace(0.0, 1.0, 10))
    for whole, third in zip(coordinates(body, pose), coordinates(body, pose, 3), strict=True):
        assert np.abs(whole[::3] - third).max() < 1e-12 * np.abs(whole).max()
