"""Sensors whose biases and mounts are states: derivatives by both, and what a turned mount reads."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import typical_mounts
from mbkf.io.imu.mount import ImuMount
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.sensors.block import OperatingPoint
from mbkf.sensors.body_sensors import BIASES, TURNS, BodySensors, BodySensorSettings
from mbkf.sensors.inertial_sensor import InertialSensor
from tests.dynamics import singer
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
MOUNTS = typical_mounts(MODEL, ("pelvis", "right_thigh", "left_foot"), seed=3)
RNG = np.random.default_rng(7)
Q, V, A = moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv), 3.0 * RNG.normal(size=MODEL.nv)
SETTINGS = BodySensorSettings(worn_rate_sd_rad_s=1.0, worn_force_sd_m_s2=1.0)


def block_of(mounts):
    count = len(mounts)
    block = BodySensors(
        InertialSensor(MODEL, mounts),
        np.zeros((count, 3)),
        np.ones((count, 3)),
        np.ones((count, 3)),
        SETTINGS,
    )
    plant = singer(MODEL, block.states())
    block.bind(plant.layout, plant.model)
    return block, plant


def state(plant, extra):
    return DynamicState(Q, V, A, np.zeros(12), np.eye(plant.layout.size), extra)


def said(block, plant, extra, measured):
    return block.linearise(OperatingPoint(state(plant, extra), None), measured)


@pytest.mark.parametrize("size", [0.0, 0.05, 0.6])
def test_rows_are_the_derivatives_by_biases_and_turns_too(size):
    block, plant = block_of(MOUNTS)
    extra = size * np.random.default_rng(1).normal(size=18)
    measured, start = np.zeros((3, 6)), state(plant, extra)
    rows, h = said(block, plant, extra, measured).jacobian, 1e-6
    numeric = np.empty_like(rows)
    for k, one in enumerate(np.eye(plant.layout.size)):
        moved = [plant.retract(start, sign * h * one, start.P) for sign in (1.0, -1.0)]
        ahead, back = (block.linearise(OperatingPoint(s, None), measured).innovation for s in moved)
        numeric[:, k] = -(ahead - back) / (2 * h)
    np.testing.assert_allclose(rows, numeric, atol=2e-7 * np.abs(numeric).max())


def test_a_turned_mount_reads_what_the_same_mount_reads_when_it_is_calibrated_so():
    block, plant = block_of(MOUNTS)
    turns, biases = 0.3 * RNG.normal(size=(3, 3)), 0.02 * RNG.normal(size=(3, 3))
    turned = [
        ImuMount(m.name, m.segment, m.position_m,
                 matrix_quaternion(Rotation.from_rotvec(turn).as_matrix() @ quaternion_matrices(m.rotation)))
        for m, turn in zip(MOUNTS, turns, strict=True)
    ]  # fmt: skip
    readings = InertialSensor(MODEL, turned).values(Q, V, A)
    readings[:, :3] += biases
    extra = np.zeros(18)
    extra[plant.layout.extra_index(BIASES)] = biases.ravel()
    extra[plant.layout.extra_index(TURNS)] = turns.ravel()
    np.testing.assert_allclose(said(block, plant, extra, readings).innovation, 0.0, atol=1e-9)


def test_missing_components_are_left_out():
    block, plant = block_of(MOUNTS)
    measured = np.zeros((3, 6))
    measured[1, 2] = np.nan
    whole, part = (said(block, plant, np.zeros(18), one) for one in (np.zeros((3, 6)), measured))
    assert len(part.innovation) == 17 == part.readings
    np.testing.assert_array_equal(part.jacobian, np.delete(whole.jacobian, 8, axis=0))


def test_the_order_of_sensors_changes_nothing_but_the_order_of_their_states():
    order = [2, 0, 1]
    measured, own = RNG.normal(size=(3, 6)), 0.1 * RNG.normal(size=(2, 3, 3))
    (one, plant), (other, _) = block_of(MOUNTS), block_of([MOUNTS[k] for k in order])
    mine = said(one, plant, own.ravel(), measured)
    theirs = said(other, plant, own[:, order].ravel(), measured[order])
    kept = slice(0, plant.layout[BIASES].start)
    for J, K in ((mine.jacobian[:, kept], theirs.jacobian[:, kept]),):
        np.testing.assert_allclose(J.T @ J, K.T @ K, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(J.T @ mine.innovation, K.T @ theirs.innovation, rtol=1e-9, atol=1e-9)
