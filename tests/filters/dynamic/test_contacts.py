"""The dynamic filter and the ground: Newton's law, plates, feet in the air and feet that stand elsewhere."""

from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.sharing import share_load
from mbkf.sensors.contact.soles import sole_points
from tests.dynamics import (
    about,
    at_rest,
    dynamic_filter,
    follow,
    half_weight,
    plate,
    plates_under,
    standing,
    trial,
)
from tests.motions import assert_near, reference_model, worst

pytestmark = pytest.mark.slow

MODEL = reference_model()
NV = MODEL.nv
STANDING = standing(MODEL)
SOLES = sole_points(MODEL, STANDING[None])[0]
HALF = half_weight(MODEL, SOLES.mean(axis=1))
PLATES = plates_under(MODEL, STANDING)


@cache
def walked(plates=2, name="walk", frames=(20, 90)):
    made = trial(name)
    return follow(made, range(*frames), made.plates[:plates])


def contacts(run):
    return np.array([step.decisions.notes.contact.contacts for step in run.steps])


def wrenches(run):
    return np.array([state.w.reshape(2, 6) for state in run.states])


def residuals(run, which):
    states = [which(step) for step in run.steps]
    return np.array([run.kalman.balance.root(s.q, s.v, s.a, s.w).residual for s in states])


@pytest.mark.parametrize("name", ["walk", "jump"])
def test_feet_in_the_air_carry_nothing(name):
    """Exactly so high above the floor or over an idle plate; about to land elsewhere, to how near they are to it."""
    run = walked(2, name, {"walk": (20, 90), "jump": (85, 125)}[name])
    air = contacts(run) == Contact.AIR
    assert air.sum() > 20
    near = np.array([step.decisions.notes.contact.near for step in run.steps])
    far = air & (near < 1e-3)
    assert far.sum() > 10
    assert worst(wrenches(run)[far]) < 1.0
    weight = GRAVITY_M_S2 * run.trial.model.mass_kg
    landing = air & ~far
    assert (np.abs(wrenches(run)[landing][:, 2]) < 1.0 + 0.4 * weight * near[landing]).all()


@pytest.mark.parametrize("plates", [1, 2])
def test_newtons_law_holds_after_every_step(plates):
    """Up to what the second order leaves in quick feet; the prior breaks it by far more."""
    run = walked(plates)
    before, after = residuals(run, lambda s: s.prior.state)[20:], residuals(run, lambda s: s.state)[20:]
    weight = GRAVITY_M_S2 * run.trial.model.mass_kg
    rms_before, rms_after = (np.sqrt((r[:, :3] ** 2).mean()) for r in (before, after))
    assert rms_after < 0.03 * weight
    assert rms_after < 0.5 * rms_before


def test_the_plates_are_believed():
    run = walked()
    measured = contacts(run) == Contact.MEASURED
    true = run.trial.motion.foot_wrench[run.frames.start : run.frames.stop]
    moved = (wrenches(run) - true)[measured][:, :3]
    assert np.sqrt((moved**2).mean()) < 1.5


def test_a_withheld_plate_is_estimated():
    """The left foot's vertical force, from its landing on, by markers and the other plate."""
    run = walked(1, frames=(60, 150))
    free = contacts(run)[:, 1] == Contact.UNMEASURED
    true = run.trial.motion.foot_wrench[run.frames.start : run.frames.stop, 1, 2]
    found = wrenches(run)[:, 1, 2]
    assert free.sum() > 30
    assert np.sqrt(((found - true) ** 2).mean()) < 0.35 * true.max()
    assert np.corrcoef(found, true)[0, 1] > 0.75


def test_a_free_foot_pulls_at_the_floor_only_softly():
    assert wrenches(walked(1))[contacts(walked(1)) == Contact.UNMEASURED][:, 2].min() > -30.0


def test_a_free_foot_does_not_take_what_a_plate_reads_too_much():
    """The right plate reads 150 N more than the body's weight: the left foot would have to pull by that."""
    kalman = dynamic_filter(MODEL, PLATES[:1])
    markers, load = (
        kalman.sensor.positions(STANDING),
        HALF[0] * (2.0 + 300.0 / (GRAVITY_M_S2 * MODEL.mass_kg)),
    )
    state, memory = at_rest(MODEL, STANDING, np.concatenate([load, np.zeros(6)])), kalman.begin()
    pulls = []
    for _ in range(40):
        step = kalman.step(state, memory, Frame(markers, load[None]))
        state, memory = step.state, step.memory
        pulls.append(state.w[8])
    assert step.decisions.notes.contact.contacts[1] == Contact.UNMEASURED
    assert np.mean(pulls[10:]) > -30.0


def test_two_feet_on_one_plate_carry_what_it_reads():
    middle = SOLES.mean(axis=(0, 1))
    kalman = dynamic_filter(MODEL, [plate(middle[0], middle[1])])
    both = HALF.sum(axis=0)
    state, memory, markers = (
        at_rest(MODEL, STANDING, np.zeros(12)),
        kalman.begin(),
        kalman.sensor.positions(STANDING),
    )
    for _ in range(10):
        step = kalman.step(state, memory, Frame(markers, both[None]))
        state, memory = step.state, step.memory
    assert step.decisions.notes.contact.contacts == (Contact.SHARED, Contact.SHARED)
    assert_near(about(middle) @ (state.w[:6] + state.w[6:] - both), 0.0, 5.0)
    shared = share_load(both, SOLES.tolist(), STANDING[:3], 0.0)
    assert_near(state.w[[2, 8]], shared.wrench[:, 2], shared.sd[2])
    sd = np.sqrt(np.diag(state.P)[3 * NV :])
    assert (sd[[2, 8]] > 0.8 * shared.sd[2]).all() and (sd[[2, 8]] < 1.2 * shared.sd[2]).all()
