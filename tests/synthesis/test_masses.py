"""Moving masses against Pinocchio's: centre of mass, angular momentum about the world's origin, and its derivative."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.synthesis import dual_numbers
from mbkf.synthesis.composition import compose
from mbkf.synthesis.coordinates import coordinates
from mbkf.synthesis.masses import Masses
from mbkf.synthesis.stand import stand_plan

TIMES = np.linspace(0.0, 1.0, 5)


@pytest.fixture(scope="module")
def pose(body):
    return compose(body, stand_plan(body, 1.0, np.random.default_rng(1))).pose(TIMES)


def test_moving_masses_are_pinocchios(body, pose):
    moving, data = Masses(body).moving(pose.rotations, pose.origins), pin.Data(body.pin_model)
    momentum, change = 2.0 * dual_numbers.axial(moving.second)
    for k, state in enumerate(zip(*coordinates(body, pose), strict=True)):
        pin.computeCentroidalMomentumTimeVariation(body.pin_model, data, *state)
        com = data.com[0].copy()
        assert np.abs(moving.moment.value[k] - body.mass_kg * com).max() < 1e-9
        for found, moved in ((momentum, data.hg), (change, data.dhg)):
            about_origin = moved.angular + np.cross(com, moved.linear)
            assert np.abs(found[k] - about_origin).max() < 1e-9


def test_without_accelerations_the_momentum_has_no_derivative(body, pose):
    slow = {name: origin.upto(1) for name, origin in pose.origins.items()}
    found, whole = (Masses(body).moving(pose.rotations, origins) for origins in (slow, pose.origins))
    assert len(found.second) == 1
    assert np.array_equal(found.second[0], whole.second[0])


def test_masses_add_up(body):
    assert sum(Masses(body).kg.values()) == pytest.approx(body.mass_kg, abs=1e-9)
