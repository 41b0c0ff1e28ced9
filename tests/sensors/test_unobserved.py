"""Joints that nothing observes: their velocities and accelerations are read as zero, those of others not at all."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.model.layout import Layout
from mbkf.sensors.unobserved import UnobservedJoints, UnobservedSettings
from tests.dynamics import notes_of, prepared_at

NV = 5
V, A = np.array([1.0, -2.0, 3.0, -4.0, 5.0]), np.array([10.0, 20.0, 30.0, 40.0, 50.0])
STATE = SimpleNamespace(v=V, a=A)
DOFS = np.array([1, 4])


def said(block, dofs=DOFS):
    block.bind(Layout.of(NV, q=NV, v=NV, a=NV), None)
    at = prepared_at(block, STATE)
    return block.linearise(at, block.decide(at, None, None, notes_of(unobserved=dofs)))


def test_velocity_and_acceleration_are_read_as_zero():
    velocity_sd, acceleration_sd = np.arange(1.0, 6.0), 10.0 * np.arange(1.0, 6.0)
    found = said(UnobservedJoints(velocity_sd, acceleration_sd))
    assert found.first == NV and found.readings == 0
    expected = np.zeros((4, 2 * NV))
    expected[[0, 1], DOFS], expected[[2, 3], NV + DOFS] = 1.0 / velocity_sd[DOFS], 1.0 / acceleration_sd[DOFS]
    np.testing.assert_array_equal(found.jacobian, expected)
    np.testing.assert_allclose(found.innovation, -expected @ np.concatenate([V, A]), rtol=1e-15)


def test_without_accelerations_in_the_state_only_velocities_are_read():
    found = said(UnobservedJoints(np.full(NV, 2.0)))
    np.testing.assert_array_equal(found.jacobian, 0.5 * np.eye(NV)[DOFS])
    np.testing.assert_array_equal(found.innovation, -0.5 * V[DOFS])


def test_while_all_is_observed_nothing_is_said():
    assert said(UnobservedJoints(np.ones(NV)), np.zeros(0, dtype=np.intp)) is None


@pytest.mark.parametrize(("movement", "velocity_sd"), [(20.0, 10.0), (200.0, 15.0), (1000.0, 30.0)])
def test_spreads_follow_the_joints_movement_within_a_range(movement, velocity_sd):
    found = said(UnobservedJoints.of(np.full(NV, movement), UnobservedSettings()))
    np.testing.assert_allclose(found.jacobian.sum(axis=1)[:2], 1.0 / velocity_sd)
    np.testing.assert_allclose(found.jacobian.sum(axis=1)[2:], 1.0 / (10.0 * movement))
