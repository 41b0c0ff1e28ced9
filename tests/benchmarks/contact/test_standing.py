"""Persons with a given stance: the feet are where they are wanted, and pressed where they are said to be."""

import numpy as np
import pytest

from benchmarks.contact.standing import PERSONS, SHIFT, motion_of
from mbkf.sensors.contact.soles import sole_points
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.motions import motion_names
from tests.motions import reference_model

MODEL = reference_model()


@pytest.mark.parametrize("person", PERSONS)
def test_feet_stand_and_are_pressed_where_they_should(person):
    name = motion_of("stand", 0.2, person)
    assert name not in motion_names() and motion_of("stand", 0.2, person) == name
    motion = synthesise_motion(MODEL, name, 2.0, 20.0, seed=1)
    ankles = [MODEL.placements(motion.q[0])[1][MODEL.joint(foot).joint_id] for foot in MODEL.roles.feet]
    assert ankles[1][1] - ankles[0][1] == pytest.approx(0.2, abs=1e-6)
    share = motion.foot_wrench[:, 0, 2] / motion.foot_wrench[:, :, 2].sum(axis=1)
    assert np.abs(share - 0.5).max() <= SHIFT + 1e-6 and np.ptp(share) > 0.5 * SHIFT
    soles = sole_points(MODEL, motion.q)
    along = soles[:, :, 2, :2] - soles[:, :, 0, :2]
    to = motion.centre_of_pressure[:, :, :2] - soles[:, :, 0, :2]
    left = (along[:, :, 0] * to[:, :, 1] - along[:, :, 1] * to[:, :, 0]) / np.linalg.norm(along, axis=2)
    middle = 0.5 * (MODEL.description.sole.inner_y_m + MODEL.description.sole.outer_y_m)
    np.testing.assert_allclose(left.mean(axis=0), PERSONS[person], atol=abs(middle) + 2e-3)
