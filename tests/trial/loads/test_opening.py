"""Contacts opened while a motion goes on: which part, how soon, from when on, and how they close."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.contact_opening import Noted
from mbkf.sensors.contact.records import Contact
from mbkf.trial.loads.opening import ContactOpener
from tests.dynamics import trial
from tests.supported import SEAT, carried, middles, part, seat, seated

LATEST_S = 1.0
"""A contact opens no later after it began to bear 8 % of body weight."""

ON_PLATES = (Contact.MEASURED, Contact.MEASURED)


def noted(motion, wrench, t, support=None, contact=ON_PLATES, started=0):
    """A frame of the true motion as a filter's estimate, with wrenches (T, 2, 6) of the feet."""
    estimate = SimpleNamespace(
        q=motion.q[t],
        v=motion.v[t],
        wrench=wrench[t],
        support=None if support is None else support[t],
        contact=contact,
        tracked=True,
        started=t == started,
    )
    return Noted(estimate, wrench[t])


def opened(model, motion, wrench, support=None, rate_hz=100.0, **given):
    """(T, B) parts that bear after each frame, and how long ago each contact that opened began, s.

    The filter has the wrench of parts (T, B, 6) once a contact is open.
    """
    opener, flags, began = ContactOpener(model, rate_hz, 0.0), [], {}
    for t in range(len(motion.q)):
        before = opener.flags.any()
        opener.note(noted(motion, wrench, t, support if before else None, **given))
        flags.append(opener.bearing().copy())
        if flags[-1].any() and not before:
            began[t] = opener.began / rate_hz
    return np.array(flags), began


@cache
def squat():
    made = trial("squat")
    return made.model, made.motion


def pulled(name, share, first_s, last_s, masses=1.0):
    """A squat in which a part is pushed up by a share of body weight for a while, and the feet bear the rest."""
    model, motion = squat()
    force = np.zeros((len(motion.q), 3))
    weight_n = GRAVITY_M_S2 * model.mass_kg
    force[round(100 * first_s) : round(100 * last_s), 2] = share * weight_n
    wrench = masses * carried(motion, middles(model, motion)[:, part(model, name)], force)
    support = np.zeros((len(motion.q), len(model.description.bearings), 6))
    support[:, part(model, name), :3] = force
    return model, motion, wrench, support


def test_a_seat_opens_soon_and_the_time_when_it_began_is_known():
    motion, model = seated().motion, seated().model
    flags, began = opened(model, motion, motion.foot_wrench)
    assert not np.delete(flags, SEAT, axis=1).any()
    bears = seat(motion)[:, 2] > 0.08 * GRAVITY_M_S2 * model.mass_kg
    first, at = int(np.argmax(bears)), int(np.argmax(flags[:, SEAT]))
    assert 0 < at - first <= 100 * LATEST_S
    assert (at + 1) / 100.0 - began[at] == pytest.approx(first / 100.0, abs=0.15)


def test_a_hand_on_a_rail_opens_and_closes():
    model, motion, wrench, support = pulled("right_hand", 0.2, 0.6, 1.6)
    flags, began = opened(model, motion, wrench, support)
    hand = flags[:, part(model, "right_hand")]
    assert not np.delete(flags, part(model, "right_hand"), axis=1).any()
    (at,) = began
    assert 0.6 < at / 100.0 <= 0.6 + LATEST_S and (at + 1) / 100.0 - began[at] == pytest.approx(0.6, abs=0.1)
    assert hand[at:160].all() and not hand[:at].any() and not hand[180:].any()


def test_who_stands_on_plates_alone_opens_nothing():
    model, motion = squat()
    assert not opened(model, motion, motion.foot_wrench)[0].any()


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_wrong_mass_opens_nothing(factor):
    model, motion = squat()
    assert not opened(model, motion, factor * motion.foot_wrench)[0].any()


@pytest.mark.parametrize("late", [-4, 4])
def test_a_clock_that_differs_opens_nothing(late):
    made = trial("jump")
    wrench = np.roll(made.motion.foot_wrench, late, axis=0)
    assert not opened(made.model, made.motion, wrench)[0].any()


def test_nothing_opens_while_a_foot_stands_beside_the_plates():
    model, motion, wrench, support = pulled("right_hand", 0.2, 0.6, 1.6)
    beside = (Contact.MEASURED, Contact.UNMEASURED)
    assert not opened(model, motion, wrench, support, contact=beside)[0].any()


def test_a_force_that_begins_with_a_step_opens_nothing():
    """The hand pulls while the right foot stands; the same pull opens where the foot stood before it."""
    model, motion, wrench, support = pulled("right_hand", 0.4, 0.6, 1.4)
    for landed_s, opens in ((0.6, False), (0.2, True)):
        stepped, step = wrench.copy(), slice(round(100 * landed_s), 140)
        stepped[:, 1] += stepped[:, 0]
        stepped[:, 0] = 0.0
        stepped[step] = wrench[step]
        assert opened(model, motion, stepped, support)[0].any() == opens


def test_a_start_begins_anew():
    """The contact closes, and opens again when it is seen again."""
    model, motion, wrench, support = pulled("right_hand", 0.2, 0.6, 2.0)
    flags, began = opened(model, motion, wrench, support, started=150)
    hand = flags[:, part(model, "right_hand")]
    assert hand[145:150].all() and not hand[150:160].any()
    assert len(began) == 1, "with no frame before it, a load is no different from a wrong mass"


def test_frames_taken_again_take_the_place_of_the_latest():
    """They explain the force at once, so that none is stated."""
    model, motion, wrench, support = pulled("right_hand", 0.2, 0.6, 2.0)
    opener, t = ContactOpener(model, 100.0, 0.0), 0
    while not opener.flags.any():
        opener.note(noted(motion, wrench, t))
        opener.bearing()
        t += 1
    opener.again([noted(motion, wrench, k, support) for k in range(t - opener.began, t)])
    assert len(opener._kept) == t
    for k in range(t, 195):
        opener.note(noted(motion, wrench, k, support))
        assert opener.bearing().any() and not opener._load.acts
