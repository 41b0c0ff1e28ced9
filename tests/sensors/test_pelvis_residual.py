"""The pelvis residual near zero: what a true motion leaves of it, and a spread that says nothing."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.torque.plant import ForcedState
from mbkf.model.human_dynamics import FORCE_STATES, HumanDynamics
from mbkf.sensors.pelvis_residual import PelvisResidual
from tests.dynamics import prepared_at, trial
from tests.forced_bodies import forced_state
from tests.motions import assert_near, worst

FRAME = 100
each_state = pytest.mark.parametrize("force_state", FORCE_STATES)


def made(force_state, sd):
    m = trial("squat")
    body = HumanDynamics(m.model, force_state=force_state)
    motion, t = m.motion, FRAME
    u = body.forces(motion.q[t], motion.v[t], motion.a[t], motion.foot_wrench[t])

    class Here:
        q, v, a, w = motion.q[t], motion.v[t], motion.a[t], motion.foot_wrench[t].ravel()

    assert_near(forced_state(body, Here, np.eye(3)).u, u, 1e-12)
    block = PelvisResidual(body, np.asarray(sd))
    return body, block, forced_state(body, Here, np.eye(3))


@each_state
def test_a_true_motion_has_none(force_state):
    _, block, state = made(force_state, np.full(6, 2.0))
    found = block.linearise(prepared_at(block, state), None)
    assert worst(found.innovation) < 0.5
    assert (found.readings, found.first) == (0, 0)
    assert np.linalg.matrix_rank(found.jacobian, tol=1e-9 * worst(found.jacobian)) == 6


def test_a_residual_state_is_read_itself():
    """With torques as states, the pelvis's six are the residual."""
    body, block, state = made("torque", [10.0] * 3 + [5.0] * 3)
    found = block.linearise(prepared_at(block, state), None)
    at = slice(2 * body.nv, 2 * body.nv + 6)
    weight = np.repeat([1 / 10.0, 1 / 5.0], 3)
    assert_near(found.jacobian[:, at], np.diag(weight), 1e-12)
    assert_near(found.innovation, -state.u[:6] * weight, 1e-12)
    rest = found.jacobian.copy()
    rest[:, at] = 0.0
    assert not rest.any()


def test_a_foot_of_unknown_load_leaves_it_unread():
    m, t = trial("squat"), FRAME
    body, motion = HumanDynamics(m.model, loads_given=True), m.motion
    block, load = PelvisResidual(body, np.full(6, 2.0)), motion.foot_wrench[t].ravel()
    u = body.forces(motion.q[t], motion.v[t], motion.a[t], motion.foot_wrench[t])
    state = ForcedState(motion.q[t], motion.v[t], u, np.eye(3), given=load)
    found = block.linearise(prepared_at(block, state), None)
    assert worst(found.innovation) < 0.5
    unknown = replace(state, given=np.where(np.arange(12) < 6, np.nan, load))
    assert block.linearise(prepared_at(block, unknown), None) is None


@each_state
def test_an_infinite_spread_says_nothing(force_state):
    _, block, state = made(force_state, np.full(6, np.inf))
    assert block.linearise(prepared_at(block, state), None) is None
