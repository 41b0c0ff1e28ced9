"""Plates as known inputs: loads of measured, airborne, sharing and unread feet; no information on the state."""

import numpy as np
import pytest

from mbkf.filters.torque.plant import ForcedState
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.block import Frame, Notes
from mbkf.sensors.contact.records import Contact, ContactDecision
from mbkf.sensors.foot_plates import FootReading
from mbkf.sensors.given_plates import GivenPlates
from tests.dynamics import DT, prepared_at, trial
from tests.forced_bodies import torque_plant

FRAME = 100


@pytest.fixture(scope="module")
def scene():
    m = trial("squat")
    body, motion = HumanDynamics(m.model, loads_given=True), m.motion
    wrench = motion.foot_wrench[FRAME]
    u = body.forces(motion.q[FRAME], motion.v[FRAME], motion.a[FRAME], wrench)
    plant = torque_plant(body)
    block = GivenPlates(body, m.detector(), DT)
    block.bind(plant.layout, plant.model)
    P = np.eye(plant.layout.size)
    state = ForcedState(motion.q[FRAME], motion.v[FRAME], u, P, given=wrench.ravel())
    return block, state, wrench


def test_contact_is_decided_and_nothing_read(scene):
    block, state, wrench = scene
    frame = Frame(np.full((1, 3), np.nan), wrench)
    decision = block.decide(prepared_at(block, state), frame, block.begin(), Notes())
    assert decision.contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    assert block.linearise(prepared_at(block, state), decision) is None
    assert block.log_noise(decision) == 0.0
    np.testing.assert_array_equal(block.loads(decision.reading), wrench.ravel())
    assert not block.sd(decision.reading).any()


@pytest.mark.parametrize(
    ("kinds", "loads"),
    [
        ((Contact.MEASURED, Contact.AIR), [range(1, 7), [0.0] * 6]),
        ((Contact.UNMEASURED, Contact.MEASURED), [[np.nan] * 6, range(7, 13)]),
    ],
)
def test_loads_by_what_a_foot_stands_on(scene, kinds, loads):
    wrench = np.arange(1.0, 13.0).reshape(2, 6)
    feet = FootReading.of(ContactDecision(kinds, wrench, np.zeros((2, 3)), False, None))
    np.testing.assert_array_equal(scene[0].loads(feet), np.ravel([list(part) for part in loads]))


def test_an_unknown_load_moves_the_body_as_none_would(scene):
    _, state, _ = scene
    unknown = ForcedState(state.q, state.v, state.u, state.P, given=np.full(12, np.nan))
    np.testing.assert_array_equal(unknown.forces, np.concatenate([state.u, np.zeros(12)]))
