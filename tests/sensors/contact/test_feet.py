"""Both feet at a state: points by the markers' arithmetic, velocities by differences in time, planes by rotations."""

import numpy as np
import pytest

from mbkf.model.soles import sole_locals
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.rules import FACES_DOWN
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
FEET = FeetOnBody(MODEL)
STEP_S = 1e-6


def moving(seed):
    rng = np.random.default_rng(seed)
    return moderate_pose(MODEL, rng), rng.normal(size=MODEL.nv)


@pytest.mark.parametrize("seed", range(4))
def test_soles_middles_and_pelvis_lie_where_the_body_has_them(seed):
    q, v = moving(seed)
    feet, soles = FEET.at(q, v), sole_points(MODEL, q[None])[0]
    np.testing.assert_allclose(feet.soles, soles, atol=1e-14)
    np.testing.assert_allclose(feet.middles_m, 0.5 * (soles[:, 0] + soles[:, 2]), atol=1e-14)
    np.testing.assert_allclose(feet.pelvis_m, MODEL.placements(q)[1][MODEL.root.joint_id], atol=1e-14)


@pytest.mark.parametrize("tilt_rad", np.linspace(0.0, np.pi, 8))
def test_a_sole_faces_down_up_to_a_tilt(tilt_rad):
    """The whole body pitched over on straight legs, so that both feet are tilted alike."""
    step = np.zeros(MODEL.nv)
    step[4] = tilt_rad
    q = MODEL.integrate(MODEL.neutral(), step)
    down = FEET.at(q, np.zeros(MODEL.nv)).facing_down
    assert down == (np.cos(tilt_rad) > FACES_DOWN,) * 2


@pytest.mark.parametrize("seed", range(4))
def test_points_move_with_the_feet_at_their_velocity(seed):
    q, v = moving(seed)
    feet, sensor = FEET.at(q, v), MarkerSensor(MODEL, *sole_locals(MODEL))
    later, earlier = (sensor.positions(MODEL.integrate(q, sign * STEP_S * v)) for sign in (1.0, -1.0))
    expected = ((later - earlier) / (2.0 * STEP_S)).reshape(2, 3, 3)
    for foot, sole in enumerate(feet.soles):
        for point, velocity in zip(sole, expected[foot], strict=True):
            np.testing.assert_allclose(feet.velocity(foot, point), velocity, atol=1e-6)


def test_speed_is_against_the_floor():
    q, v = moving(5)
    feet = FEET.at(q, v)
    point = feet.soles[1][0]
    x, y, z = feet.velocity(1, point)
    assert feet.speed(1, point, (0.0, 0.0)) == pytest.approx(np.linalg.norm([x, y, z]))
    assert feet.speed(1, point, (x, y)) == pytest.approx(abs(z))
