"""Load passes to the foot ahead as the foot behind rolls: when that is read, what of, and what of other movements."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.sensors.block import Frame, Notes, OperatingPoint
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.load_transfer import LoadTransfer, Walk, pitch_of, pitching
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject

RATE_HZ = 100.0
MODEL = body_of(synthesise_subject(1))
FREE, AIR, READ = Contact.UNMEASURED, Contact.AIR, Contact.MEASURED


def block():
    made = LoadTransfer(MODEL, 1.0 / RATE_HZ)
    made.bind(SimpleNamespace(wrench=slice(3 * MODEL.nv, 3 * MODEL.nv + 12)), MODEL)
    return made


def at(q, v, w=None):
    return OperatingPoint(SimpleNamespace(q=q, v=v, w=np.zeros(12) if w is None else w), None)


def decided(made, q, v, contacts, memory):
    notes = Notes(contact=SimpleNamespace(contacts=contacts))
    frame = Frame(np.zeros((0, 3)), np.zeros((0, 6)))
    return made.decide(at(q, v), frame, memory, notes)


def followed(motion, stands=FREE):
    """Per frame the decision, on the true motion with true contacts."""
    made = block()
    memory, found = made.begin(), []
    for q, v, w in zip(motion.q, motion.v, motion.foot_wrench, strict=True):
        contacts = tuple(stands if force > 20.0 else AIR for force in w[:, 2])
        found.append(decided(made, q, v, contacts, memory))
        memory = found[-1].walk
    return found


@pytest.fixture(scope="module")
def walk():
    return synthesise_motion(MODEL, "walk", 5.0, RATE_HZ, 1)


@pytest.fixture(scope="module")
def walked(walk):
    return followed(walk)


def test_the_share_of_the_foot_behind_is_that_of_a_true_walk(walk, walked):
    told, true, behind = [], [], []
    x, feet = walk.q[:, 0], FeetOnBody(MODEL)
    for decision, w, q in zip(walked, walk.foot_wrench, walk.q, strict=True):
        if decision.share is not None:
            foot, share = decision.share
            told.append(share)
            true.append(w[foot, 2] / w[:, 2].sum())
            middles = feet.at(q, np.zeros(MODEL.nv)).middles_m
            behind.append((middles[1 - foot] - middles[foot])[0] * np.sign(x[-1] - x[0]) > 0.1)
    both = (walk.foot_wrench[:, :, 2] > 20.0).all(axis=1)
    assert len(told) > 0.7 * both[50:].sum() and all(behind)
    assert np.sqrt(np.mean(np.subtract(told, true) ** 2)) < 0.12


def test_the_pitch_at_which_a_foot_has_left_is_kept_for_the_next_time(walk, walked):
    feet = FeetOnBody(MODEL)
    leaving = walked[-1].walk.leaving_rad
    for foot in (0, 1):
        loads = walk.foot_wrench[:, foot, 2] > 20.0
        last = np.flatnonzero(loads[:-1] & ~loads[1:])[-1]
        pitch = pitch_of(feet.at(walk.q[last], walk.v[last]), foot)
        assert leaving[foot] == pytest.approx(pitch, abs=1e-9)


@pytest.mark.parametrize(("plan", "seconds"), [("stand", 2.0), ("squat", 2.5), ("jump", 3.0)])
def test_feet_side_by_side_are_not_told_apart(plan, seconds):
    motion = synthesise_motion(MODEL, plan, seconds, RATE_HZ, 1)
    assert all(one.share is None for one in followed(motion))


def test_nothing_is_read_where_plates_read(walk):
    assert all(one.share is None for one in followed(walk, READ))


def test_a_foot_that_does_not_roll_keeps_its_load_to_itself(walk, walked):
    made, q = block(), walk.q[0]
    memory = Walk((0.5, 0.0))
    still = decided(made, q, np.zeros(MODEL.nv), (FREE, FREE), memory)
    assert still.share is None
    assert still.walk.transfer is not None and still.walk.transfer.behind == 0
    late = memory._replace(transfer=still.walk.transfer._replace(lasted_s=1.0))
    rolling = next(k for k, one in enumerate(walked) if one.share is not None and one.share[0] == 0)
    assert decided(made, walk.q[rolling], walk.v[rolling], (FREE, FREE), late).share is None


def test_the_row_is_the_derivative_of_its_innovation_and_vanishes_at_the_share():
    made, rng = block(), np.random.default_rng(3)
    decision = SimpleNamespace(share=(1, 0.3))
    w = rng.normal(0.0, 300.0, 12)
    rows = made.linearise(at(None, None, w), decision)
    moved = np.array([made.linearise(at(None, None, w + step), decision).innovation for step in np.eye(12)])
    np.testing.assert_allclose((rows.innovation - moved).T, rows.jacobian, atol=1e-9)
    w[[2, 8]] = 700.0, 300.0
    assert made.linearise(at(None, None, w), decision).innovation == pytest.approx(0.0, abs=1e-12)
    assert rows.first == 3 * MODEL.nv and rows.readings == 0


def test_pitching_is_the_derivative_of_pitch(walk):
    feet, k, h = FeetOnBody(MODEL), 120, 1e-6
    ahead, back = (MODEL.integrate(walk.q[k], sign * h * walk.v[k]) for sign in (1.0, -1.0))
    for foot in (0, 1):
        slope = (pitch_of(feet.at(ahead, walk.v[k]), foot) - pitch_of(feet.at(back, walk.v[k]), foot)) / (
            2 * h
        )
        here = feet.at(walk.q[k], walk.v[k])
        assert pitching(here, foot) == pytest.approx(slope, rel=1e-5, abs=1e-6)
