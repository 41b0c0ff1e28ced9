"""What a torque state says of motion and forces, and how sure it is."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.torque.plant import ForcedState
from mbkf.filters.torque.report import TorqueState
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.foot_wrench import FootWrenchSensor
from tests.dynamics import trial
from tests.forced_bodies import torque_plant
from tests.motions import assert_near

FRAME, FIXED = 100, (40, 41)


@pytest.fixture(scope="module")
def scene():
    m = trial("squat")
    fixed = np.zeros(m.model.nv, dtype=bool)
    fixed[list(FIXED)] = True
    body, motion = HumanDynamics(m.model, fixed), m.motion
    a = np.where(body.kinematic, 0.0, motion.a[FRAME])
    u = body.forces(motion.q[FRAME], motion.v[FRAME], a, motion.foot_wrench[FRAME])
    P = 1e-6 * np.eye(2 * body.nv + body.nu)
    return body, a, motion.foot_wrench[FRAME], ForcedState(motion.q[FRAME], motion.v[FRAME], u, P)


def test_motion_and_wrenches_are_given_back(scene):
    body, a, wrench, state = scene
    found = TorqueState.of(body, FootWrenchSensor(body), state)
    assert_near(found.a, a, 1e-8)
    assert_near(found.foot_wrench, wrench, 1e-9)
    expected = body.joint_forces(state.q, state.v, state.u).torque
    assert_near(found.tau[body.torque_dofs], expected, 1e-6)
    assert found.finite
    assert not replace(found, tau=np.full_like(found.tau, np.nan)).finite


def test_spreads_are_those_of_small_errors(scene):
    """Standard deviations of torques and wrenches against errors drawn from the covariance."""
    body, _, _, state = scene
    plant, wrenches = torque_plant(body), FootWrenchSensor(body)
    found = TorqueState.of(body, wrenches, state)
    rng = np.random.default_rng(0)
    drawn = [
        TorqueState.of(body, wrenches, plant.retract(state, 1e-3 * rng.normal(size=len(state.P)), state.P))
        for _ in range(300)
    ]
    free = body.torque_dofs[~body.fixed[body.torque_dofs]]
    spread = np.std([one.tau for one in drawn], axis=0)
    np.testing.assert_allclose(spread[free], found.tau_sd[free], rtol=0.2)
    np.testing.assert_allclose(
        np.std([one.foot_wrench for one in drawn], axis=0), found.foot_wrench_sd, rtol=0.2
    )
    assert np.isnan(found.tau_sd[list(FIXED)]).all()
