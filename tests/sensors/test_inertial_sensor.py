"""Inertial sensors on a body: free fall, rest, turning on the spot."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import UnknownName
from mbkf.io.imu.mount import ImuMount
from mbkf.model.human import HumanModel
from mbkf.sensors.inertial_sensor import InertialSensor

MODEL = HumanModel.scaled()
STRAIGHT = np.array([0.0, 0.0, 0.0, 1.0])
SENSOR = InertialSensor(
    MODEL,
    [
        ImuMount("a", "pelvis", np.array([0.1, 0.0, 0.0]), STRAIGHT),
        ImuMount("b", "left_foot", np.zeros(3), STRAIGHT),
    ],
)
REST = np.zeros(MODEL.nv)


def test_at_rest_they_read_one_g_up_and_in_free_fall_nothing():
    np.testing.assert_allclose(
        SENSOR.values(MODEL.neutral(), REST, REST)[:, 3:], [[0, 0, GRAVITY_M_S2]] * 2, atol=1e-9
    )
    falling = REST.copy()
    falling[2] = -GRAVITY_M_S2
    np.testing.assert_allclose(SENSOR.values(MODEL.neutral(), REST, falling), 0.0, atol=1e-9)


def test_turning_about_the_vertical_pulls_outwards():
    v = REST.copy()
    v[5] = 3.0
    pelvis = SENSOR.values(MODEL.neutral(), v, REST)[0]
    np.testing.assert_allclose(pelvis[:3], [0, 0, 3.0], atol=1e-12)
    np.testing.assert_allclose(pelvis[3:], [-9.0 * 0.1, 0, GRAVITY_M_S2], atol=1e-9)


def test_a_turn_of_the_world_about_the_vertical_changes_nothing():
    rng = np.random.default_rng(1)
    q = MODEL.integrate(MODEL.neutral(), rng.normal(0, 0.4, MODEL.nv))
    v, a = rng.normal(0, 1, (2, MODEL.nv))
    turn, (x, y, z, w) = np.array([np.sin(0.4), np.cos(0.4)]), q[3:7]
    other = q.copy()
    s, c = turn
    other[3:7] = [c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z]
    np.testing.assert_allclose(SENSOR.values(other, v, a), SENSOR.values(q, v, a), atol=1e-9)
    np.testing.assert_array_equal(SENSOR.reading(q, v, a).values, SENSOR.values(q, v, a))


def test_orientations_are_those_of_the_segments():
    q = MODEL.integrate(MODEL.neutral(), np.random.default_rng(2).normal(0, 0.4, MODEL.nv))
    rotations, _ = MODEL.placements(q)
    np.testing.assert_allclose(SENSOR.orientations(q)[1], rotations[MODEL.joint("left_foot").joint_id])


def test_a_segment_that_the_body_does_not_have_is_refused():
    with pytest.raises(UnknownName):
        InertialSensor(MODEL, [ImuMount("a", "tail", np.zeros(3), STRAIGHT)])
