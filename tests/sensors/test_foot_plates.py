"""Plates as readings of wrench states: which feet are read, how exactly, and where contact is decided."""

import numpy as np
import pytest

from mbkf.filters.torque.plant import ForcedState
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.block import Frame, Notes
from mbkf.sensors.contact.records import Contact, ContactDecision
from mbkf.sensors.contact.sharing import SharedLoad
from mbkf.sensors.foot_plates import FootPlates, FootPlateSettings, FootReading, PlateDecision
from tests.dynamics import DT, prepared_at, trial
from tests.forced_bodies import torque_plant
from tests.motions import assert_near

FRAME = 100
NO_MARKERS = np.full((1, 3), np.nan)


def contact(right, left, wrench):
    return ContactDecision((right, left), wrench, np.zeros((2, 3)), False, None)


@pytest.fixture(scope="module")
def scene():
    m = trial("squat")
    body, motion = HumanDynamics(m.model), m.motion
    u = body.forces(motion.q[FRAME], motion.v[FRAME], motion.a[FRAME], motion.foot_wrench[FRAME])
    plant = torque_plant(body)
    block = FootPlates(body, m.detector(), DT)
    block.bind(plant.layout, plant.model)
    P = np.eye(plant.layout.size)
    return block, ForcedState(motion.q[FRAME], motion.v[FRAME], u, P), motion.foot_wrench[FRAME]


def test_what_is_known_of_feet():
    wrench = np.arange(12.0).reshape(2, 6)
    read = FootReading.of(contact(Contact.MEASURED, Contact.AIR, wrench))
    assert read.known.tolist() == [True, True] and read.airborne.tolist() == [False, True]
    np.testing.assert_array_equal(read.wrench, [wrench[0], np.zeros(6)])
    for kind in (Contact.UNMEASURED, Contact.SHARED):
        read = FootReading.of(contact(kind, Contact.MEASURED, wrench))
        assert read.known.tolist() == [False, True] and not read.airborne.any()


def test_noise_by_what_a_foot_stands_on(scene):
    block, wrench, s = scene[0], np.ones((2, 6)), FootPlateSettings()
    sd = block.sd(FootReading.of(contact(Contact.AIR, Contact.MEASURED, wrench)))
    plate = [s.plate_force_n] * 3 + [s.plate_moment_nm] * 3
    np.testing.assert_array_equal(sd, [s.air_force_n] * 3 + [s.air_moment_nm] * 3 + plate)
    assert np.isinf(block.sd(FootReading.of(contact(Contact.UNMEASURED, Contact.SHARED, wrench)))).all()


def test_vertical_forces_of_plates_have_their_own_noise(scene):
    block = FootPlates(
        scene[0].dynamics, scene[0].detector, DT, FootPlateSettings(plate_vertical_force_n=9.0)
    )
    sd = block.sd(FootReading.of(contact(Contact.AIR, Contact.MEASURED, np.ones((2, 6)))))
    np.testing.assert_array_equal(sd[6:], [5.0, 5.0, 9.0, 2.0, 2.0, 2.0])
    np.testing.assert_array_equal(
        sd[:6], scene[0].sd(FootReading.of(contact(Contact.AIR, Contact.AIR, np.ones((2, 6)))))[:6]
    )


def test_true_plates_leave_no_innovation(scene):
    block, state, wrench = scene
    decision = block.decide(prepared_at(block, state), Frame(NO_MARKERS, wrench), block.begin(), Notes())
    assert decision.contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    found = block.linearise(prepared_at(block, state), decision)
    assert found.readings == 12 and found.innovation @ found.innovation < 1e-12
    every = np.arange(block.layout.size)
    read = np.concatenate([every[block.layout.q], every[block.layout.wrench]])
    assert not found.jacobian[:, np.setdiff1d(every, read)].any()
    assert np.linalg.matrix_rank(found.jacobian[:, -12:]) == 12


def test_feet_without_a_reading_are_left_out(scene):
    block, state, wrench = scene
    decision = contact(Contact.UNMEASURED, Contact.MEASURED, wrench)
    first = block.decide(prepared_at(block, state), Frame(NO_MARKERS, wrench), block.begin(), Notes())
    found = block.linearise(
        prepared_at(block, state), first._replace(contact=decision, reading=FootReading.of(decision))
    )
    assert found.readings == 6
    assert not found.jacobian[:, -12:-6].any() and found.jacobian[:, -6:].any()


def shared(wrench, sd=(20.0, 20.0, 30.0, 10.0, 10.0, 5.0)):
    """A decision on feet that share a plate, right and left with these wrenches."""
    load = SharedLoad(wrench, np.array([[0.1, -0.1, 0.0], [0.15, 0.1, 0.0]]), np.array(sd))
    total = np.tile(wrench.sum(axis=0), (2, 1))
    return ContactDecision((Contact.SHARED, Contact.SHARED), total, np.zeros((2, 3)), False, None, load)


def linearised(scene, decision):
    block, state, wrench = scene
    first = block.decide(prepared_at(block, state), Frame(NO_MARKERS, wrench), block.begin(), Notes())
    reading = FootReading.of(decision)
    return block.linearise(prepared_at(block, state), first._replace(contact=decision, reading=reading))


def test_a_shared_plate_is_read_as_shares(scene):
    """True shares leave no innovation; shares that are wrong are worth what their spread says, whatever the sum."""
    _, _, wrench = scene
    read = FootReading.of(shared(wrench))
    assert read.known.all() and not read.airborne.any()
    np.testing.assert_array_equal(read.wrench, wrench)
    right = linearised(scene, shared(wrench))
    assert right.readings == 12 and right.innovation @ right.innovation < 1e-12
    off = np.array([0.0, 0.0, 60.0, 60.0 * -0.1, 60.0 * -0.1, 0.0])  # 60 N at the right foot's centre
    found = linearised(scene, shared(wrench + np.array([off, -off])))
    assert found.innovation @ found.innovation == pytest.approx((60.0 / 30.0) ** 2)


def test_shares_leave_the_sum_as_exact_as_the_plate(scene):
    block, _, wrench = scene
    s = block.settings
    heavier = np.array([0.0, 0.0, 10.0, -1.0, -1.5, 0.0])  # 10 N on the left foot alone
    found = linearised(scene, shared(wrench + np.array([np.zeros(6), heavier])))
    assert found.innovation @ found.innovation >= (10.0 / s.plate_force_n) ** 2
    assert np.linalg.matrix_rank(found.jacobian[:, -12:]) == 12
    sd = block.sd(FootReading.of(shared(wrench)))
    assert np.isfinite(sd).all() and sd[2] == pytest.approx(np.hypot(30.0, s.plate_force_n))


def test_the_noise_of_shares_is_that_of_their_whitening(scene):
    """Log det R is minus twice the log of the whitening's determinant."""
    block, state, wrench = scene
    points = block.dynamics.model.placements(state.q)[1][block.sensor.ids]
    decision = shared(wrench)
    rows = block._whitening(decision.shared, points)
    found = block.log_noise(PlateDecision(decision, FootReading.of(decision)))
    assert found == pytest.approx(-2.0 * np.linalg.slogdet(rows)[1])


def test_contact_is_decided_where_the_posterior_leads(scene):
    block, state, wrench = scene
    at, frame, notes = prepared_at(block, state), Frame(NO_MARKERS, wrench), Notes()
    decision = block.decide(at, frame, block.begin(), notes)
    memory = block.remember(state, at, decision, block.begin())
    assert notes.contact is decision.contact and memory.contact is decision.contact.memory
    a = block.dynamics.acceleration(state.q, state.v, state.u)
    assert_near(memory.ahead.q, block.dynamics.integrate(state.q, DT * state.v), 0.0)
    assert_near(memory.ahead.v, state.v + DT * a, 0.0)
    assert_near(memory.ahead.a, a, 0.0)
