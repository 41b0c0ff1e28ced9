"""Start of the torque filter: motion and reactions made to agree, or forces by inverse dynamics alone."""

import numpy as np
import pytest

from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.noise import ForceNoise
from mbkf.filters.torque.plant import TorquePlant
from mbkf.filters.torque.settings import TorqueSettings, preset
from mbkf.filters.torque.start import TorqueStart
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.foot_plates import FootReading
from tests.dynamics import DT, trial
from tests.motions import assert_near

FRAME = 100
BOTH, NEITHER = np.ones(2, dtype=bool), np.zeros(2, dtype=bool)
PLATE_SD = np.tile(np.repeat([5.0, 2.0], 3), 2)


def made(settings, sd):
    m = trial("squat")
    body = HumanDynamics(m.model, None, settings.wrench_frame, settings.force_state)
    plant = TorquePlant(body, DT, ForceNoise(body, DT, settings), settings.scheme, wrenches=True)
    motion = m.motion
    P = np.diag(np.repeat([0.003, 0.1], body.nv) ** 2)
    known = KinematicState(motion.q[FRAME], motion.v[FRAME], P)
    return body, TorqueStart(body, plant, settings, sd), known, motion.a[FRAME], motion.foot_wrench[FRAME]


def test_a_wrong_acceleration_is_corrected_by_the_plates():
    body, start, motion, a, wrench = made(TorqueSettings(), np.repeat([10.0, 5.0], 3))
    wrong = a + np.random.default_rng(0).normal(size=body.nv)
    state = start.state(motion, wrong, FootReading(wrench, BOTH, NEITHER), PLATE_SD)
    before = body.forces(motion.q, motion.v, np.where(body.kinematic, 0.0, wrong), wrench)
    left, was = (
        np.abs(body.joint_forces(*x).torque[:3]).max()
        for x in ((state.q, state.v, state.u), (motion.q, motion.v, before))
    )
    assert left < 0.2 * was
    assert np.linalg.eigvalsh(state.P).min() > -1e-9 * state.P.max()


def test_a_foot_without_a_reading_may_carry_what_a_second_brings():
    _, start, motion, a, wrench = made(TorqueSettings(), np.repeat([10.0, 5.0], 3))
    known = start.state(motion, a, FootReading(wrench, BOTH, NEITHER), PLATE_SD)
    sd = np.concatenate([PLATE_SD[:6], np.full(6, np.inf)])
    open_ = start.state(motion, a, FootReading(wrench, np.array([True, False]), NEITHER), sd)
    assert (np.diag(open_.P)[-6:-3] > 2.0 * np.diag(known.P)[-6:-3]).all()
    assert open_.P[-4, -4] > 100.0


@pytest.mark.parametrize("name", ["FD", "FDMC"])
def test_independent_forces_are_inverse_dynamics(name):
    body, start, motion, a, wrench = made(preset(name, literal=True), np.full(6, np.inf))
    state = start.state(motion, a, FootReading(wrench, BOTH, NEITHER), PLATE_SD)
    expected = body.forces(motion.q, motion.v, np.where(body.kinematic, 0.0, a), wrench)
    assert_near(state.u, expected, 0.0)
    assert state.q is motion.q
    assert_near(state.P[: 2 * body.nv, : 2 * body.nv], motion.P, 0.0)
    assert not state.P[: 2 * body.nv, 2 * body.nv :].any()
