"""Plate readings of foot wrenches: the rigid transfer of thesis eqs. 4.10–4.13 and its derivatives."""

import numpy as np
import pytest

from mbkf.model.human_dynamics import WRENCH_FRAMES, HumanDynamics
from mbkf.sensors.foot_wrench import FootWrenchSensor
from tests.motions import assert_near, central_difference, moderate_pose, random_model

POINTS = np.array([[0.2, -0.1, 0.0], [-0.3, 0.15, 0.02]])
each_frame = pytest.mark.parametrize("frame", WRENCH_FRAMES)


def made(frame, seed=1):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    sensor = FootWrenchSensor(HumanDynamics(model, wrench_frame=frame))
    wrench = rng.normal(size=(2, 6)) * np.array([50.0, 50.0, 500.0, 40.0, 40.0, 20.0])
    return sensor, moderate_pose(model, rng), wrench


@each_frame
def test_a_plate_reads_what_was_put_on_the_foot(frame):
    sensor, q, wrench = made(frame)
    state = sensor.dynamics.wrench_state(q, wrench)
    assert_near(sensor.reading(q, state, np.zeros((2, 3))).wrench, wrench.ravel(), 1e-9)
    moved = wrench.copy()
    moved[:, 3:] -= np.cross(POINTS, wrench[:, :3])
    assert_near(sensor.reading(q, state, POINTS).wrench, moved.ravel(), 1e-9)


def test_the_printed_transfer():
    """Thesis eq. 4.11 with the thesis's state: [I, 0; r̃, A], r from the plate's centre to the foot's centre of mass."""
    sensor, q, wrench = made("thesis")
    state = sensor.dynamics.wrench_state(q, wrench)
    model = sensor.dynamics.model
    rotations, origins = model.placements(q)
    for side, joint in enumerate(sensor.ids):
        A, force, moment = (
            rotations[joint],
            state[6 * side : 6 * side + 3],
            state[6 * side + 3 : 6 * side + 6],
        )
        r = origins[joint] + A @ model.pin_model.inertias[int(joint)].lever - POINTS[side]
        expected = np.concatenate([force, np.cross(r, force) + A @ moment])
        found = sensor.reading(q, state, POINTS).wrench[6 * side : 6 * side + 6]
        assert_near(found, expected, 1e-9)


@each_frame
def test_derivatives(frame):
    sensor, q, wrench = made(frame)
    state = sensor.dynamics.wrench_state(q, wrench)
    found = sensor.reading(q, state, POINTS)
    by_q = central_difference(sensor.dynamics.model, lambda at: sensor.reading(at, state, POINTS).wrench, q)
    assert_near(found.by_q, by_q, 2e-6)
    columns = [
        sensor.reading(q, state + e, POINTS).wrench - sensor.reading(q, state, POINTS).wrench
        for e in np.eye(12)
    ]
    assert_near(found.by_state, np.stack(columns, axis=1), 1e-9)
