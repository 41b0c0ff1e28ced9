"""Joints of a scaled body against bodies whose scale factors are a little larger and smaller."""

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.model.scale_derivatives import OriginLevers
from tests.motions import assert_near, moderate_pose, random_model


def origin_derivatives(model, rotations):
    levers = OriginLevers(model)
    return levers.summed(rotations, levers.levers)


def test_origin_derivatives_are_differences_of_scaled_bodies():
    rng, h = np.random.default_rng(3), 1e-6
    model = random_model(rng)
    q = moderate_pose(model, rng)

    def origins(scale):
        return HumanModel(model.description, scale, model.mass_kg).placements(q)[1]

    slopes = [
        (origins(model.scale + h * one) - origins(model.scale - h * one)) / (2 * h) for one in np.eye(18)
    ]
    found = origin_derivatives(model, model.placements(q)[0])
    joints = [joint.joint_id for joint in model.joints.values()]
    assert_near(found[joints], np.moveaxis(slopes, 0, -1)[joints], 1e-9)


def test_levers_along_directions_are_the_derivatives_times_these():
    rng = np.random.default_rng(4)
    model = random_model(rng)
    rotations, _ = model.placements(moderate_pose(model, rng))
    levers, directions, joints = OriginLevers(model), rng.normal(size=(len(model.scale), 3)), np.array([4, 2])
    found = levers.summed(rotations, levers.levers @ directions, joints)
    assert_near(found, origin_derivatives(model, rotations)[joints] @ directions, 1e-12)


def test_many_configurations_are_each_by_itself():
    rng = np.random.default_rng(4)
    model = random_model(rng)
    rotations = np.array([model.placements(moderate_pose(model, rng))[0] for _ in range(5)])
    each = np.array([origin_derivatives(model, one) for one in rotations])
    assert_near(origin_derivatives(model, rotations), each, 1e-14)
