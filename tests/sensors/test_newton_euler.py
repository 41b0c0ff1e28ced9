"""Newton's law at the pelvis as a reading of zero, as exact as it is said to be."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.layout import SUPPORT, ExtraState
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.contact.records import Contact, ContactDecision
from mbkf.sensors.newton_euler import NewtonEulerLaw, NewtonEulerSettings
from tests.dynamics import notes_of, prepared_at, random_state, singer, standing
from tests.motions import assert_near, reference_model

MODEL = reference_model()
SETTINGS = NewtonEulerSettings(residual_force_n=2.0, residual_moment_nm=0.5, imu_residual_scale=30.0)
HIDDEN = np.arange(3)


def law():
    block = NewtonEulerLaw(NewtonEuler(MODEL), SETTINGS)
    state = random_state(MODEL, np.random.default_rng(0), standing(MODEL))
    return block, state, prepared_at(block, state)


def test_the_residual_is_read_as_zero():
    _, s, at = law()
    residual = NewtonEuler(MODEL).root(s.q, s.v, s.a, s.w).residual
    assert_near(at.prepared.innovation[:3], -residual[:3] / 2.0, 1e-12 * np.abs(residual).max())
    assert_near(at.prepared.innovation[3:], -residual[3:] / 0.5, 1e-12 * np.abs(residual).max())
    assert at.prepared.readings == 6


def test_rows_stay_what_they_are_when_other_states_are_looked_at():
    """Pinocchio's derivatives live in arrays that its next call overwrites."""
    block, _, at = law()
    kept = at.prepared.jacobian.copy(), at.prepared.innovation.copy()
    block.prepare(random_state(MODEL, np.random.default_rng(9)), None)
    block.balance.torques(MODEL.neutral(), *np.zeros((2, MODEL.nv)), np.zeros(12))
    np.testing.assert_array_equal(at.prepared.jacobian, kept[0])
    np.testing.assert_array_equal(at.prepared.innovation, kept[1])


@pytest.mark.parametrize(
    ("notes", "scale"),
    [
        ({}, 1.0),
        ({"unobserved": HIDDEN}, 1.0),
        ({"imus": np.zeros((1, 6))}, 1.0),
        ({"imus": np.zeros((1, 6)), "unobserved": HIDDEN}, 30.0),
    ],
)
def test_it_is_loosened_where_inertial_sensors_read_and_a_limb_is_unobserved(notes, scale):
    """And what counts is what stands in the notes when all blocks have decided."""
    block, _, at = law()
    told = notes_of()
    decision = block.decide(at, None, None, told)
    for name, value in notes.items():
        setattr(told, name, value)
    found = block.linearise(at, decision)
    np.testing.assert_array_equal(found.jacobian, at.prepared.jacobian / scale)
    np.testing.assert_array_equal(found.innovation, at.prepared.innovation / scale)
    assert found.readings == 6


@pytest.mark.parametrize(("stray", "shown"), [(False, False), (True, True), (True, False)])
def test_the_law_is_loose_while_a_loaded_plate_belongs_to_a_foot_that_is_never_seen(stray, shown):
    """A foot that is hidden for a while stays where it is predicted, and its plate with it."""
    foot = MODEL.joint("right_foot").v
    unobservable = np.zeros(MODEL.nv, dtype=bool)
    unobservable[foot] = not shown
    _, _, at = law()
    block = NewtonEulerLaw(NewtonEuler(MODEL), SETTINGS, unobservable)
    contact = ContactDecision((Contact.AIR, Contact.AIR), np.zeros((2, 6)), np.zeros((2, 3)), stray, None)
    found = block.linearise(at, notes_of(contact=contact, unobserved=np.arange(foot.start, foot.stop)))
    scale = SETTINGS.stray_residual_scale if stray and not shown else 1.0
    np.testing.assert_array_equal(found.jacobian, at.prepared.jacobian / scale)
    np.testing.assert_array_equal(found.innovation, at.prepared.innovation / scale)


def test_its_noise_is_that_of_six_equations():
    block, _, _ = law()
    assert block.log_noise(notes_of()) == pytest.approx(2.0 * 3.0 * (np.log(2.0) + np.log(0.5)))


def test_the_wrench_of_other_contacts_counts_like_a_foots():
    """Rows along the whole state, against finite differences; without that state they are what they were."""
    plain, state, _ = law()
    extras = [ExtraState(SUPPORT, np.zeros(6), np.ones(6), np.zeros(6))]
    other = [ExtraState("mine", np.zeros(2), np.ones(2), np.zeros(2))]
    plant = singer(MODEL, [*other, *extras])
    block = NewtonEulerLaw(NewtonEuler(MODEL), SETTINGS)
    block.bind(plant.layout, plant.model)
    wrench = np.array([20.0, -30.0, 400.0, 50.0, -80.0, 10.0])
    at = replace(state, extra=np.concatenate([[7.0, 7.0], wrench]))
    found, size = block.prepare(at, None), plant.layout.size
    assert found.jacobian.shape == (6, size)

    def moved(x):
        return block.prepare(plant.retract(at, x, at.P), None).innovation

    # The law is linear in accelerations and wrenches, and steps along these can be larger.
    steps = np.where(np.arange(size) < plant.layout.a.start, 1e-6, 1e-2)
    numeric = [(moved(h * e) - moved(-h * e)) / (2 * h) for h, e in zip(steps, np.eye(size), strict=True)]
    assert_near(found.jacobian, -np.array(numeric).T, 1e-6 * np.abs(found.jacobian).max())
    np.testing.assert_array_equal(found.jacobian[:, plant.layout["mine"]], 0.0)
    mine = found.jacobian[:, plant.layout[SUPPORT]]
    np.testing.assert_array_equal(mine, found.jacobian[:, plant.layout.wrench][:, :6])
    on_the_foot = replace(state, w=state.w + np.concatenate([wrench, np.zeros(6)]))
    assert_near(found.innovation, plain.prepare(on_the_foot, None).innovation, 1e-9)
