"""Feet without a plate: a low, slow foot carries after a delay, a flying one never, and one over an idle plate not."""

from dataclasses import replace

import numpy as np

from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.plates import PlateAreas
from mbkf.sensors.contact.records import Contact, ContactMemory
from mbkf.sensors.contact.rules import STAND_AFTER_S
from mbkf.sensors.contact.unmeasured import UnmeasuredFeet
from tests.dynamics import DT, plates_under, standing
from tests.motions import reference_model

MODEL = reference_model()
STILL = np.zeros(MODEL.nv)
FEET = FeetOnBody(MODEL)
AIR = (Contact.AIR, Contact.AIR)


def decided(q, memory, a=STILL, plates=(), unloaded=(), contacts=AIR, silent=()):
    detector = UnmeasuredFeet(PlateAreas(plates), 0.0 if plates else np.nan, DT)
    return detector.decide(memory, (q, STILL, a), FEET.at(q, STILL), contacts, unloaded, silent)


def memory(touching_s, plates=0):
    return ContactMemory((-1,) * plates, (None,) * plates, 0.0, touching_s)


def test_a_standing_foot_carries_after_its_delay():
    fresh = decided(standing(MODEL), memory((0.0, 0.0)))
    assert fresh.touching_s == (DT, DT)
    later = decided(standing(MODEL), memory((STAND_AFTER_S, STAND_AFTER_S)))
    assert list(later.carrying) == [0, 1]


def test_feet_high_above_the_floor_carry_where_the_body_does_not_fall():
    """Something unknown is under them, a box say; in free fall nothing is."""
    high = standing(MODEL, 0.5)
    assert list(decided(high, memory((0.0, 0.0))).carrying) == [0, 1]
    falling = STILL.copy()
    falling[2] = -9.8
    assert list(decided(high, memory((0.0, 0.0)), falling).carrying) == []


def test_over_an_unloaded_plate_a_foot_carries_nothing():
    q = standing(MODEL)
    plates = plates_under(MODEL, q)
    found = decided(q, memory((1.0, 1.0), 2), plates=plates, unloaded=(0, 1))
    assert list(found.carrying) == [] and found.touching_s == (0.0, 0.0)


def test_measured_feet_are_not_asked():
    both = (Contact.MEASURED, Contact.MEASURED)
    found = decided(standing(MODEL), memory((1.0, 1.0)), contacts=both)
    assert list(found.carrying) == [] and found.touching_s == (0.0, 0.0)
    assert abs(found.sole_height_m) < 0.02


def test_a_foot_whose_plate_falls_silent_stands_on_at_once():
    """Without the delay of a foot that has only just touched the floor, which waits for its plate."""
    q = standing(MODEL)
    plates = plates_under(MODEL, q)
    before = ContactMemory((0, 1), (None, None), 0.0, (0.0, 0.0))
    contacts = (Contact.AIR, Contact.MEASURED)
    found = decided(q, before, plates=plates, contacts=contacts, silent=(0,))
    assert list(found.carrying) == [0]
    waiting = decided(q, before, plates=plates, contacts=contacts)
    assert list(waiting.carrying) == []
    lifted = decided(standing(MODEL, 0.5), before, plates=plates, contacts=contacts, silent=(0,))
    assert list(lifted.carrying) == []


def falling_freely():
    a = STILL.copy()
    a[2] = -9.8
    return a


def test_a_foot_in_the_air_is_near_the_floor_where_it_is_low_and_slow():
    heights = [0.07, 0.09, 0.12, 0.30]
    feet = [decided(standing(MODEL, height), memory((0.0, 0.0)), falling_freely()) for height in heights]
    assert all(list(found.carrying) == [] for found in feet)
    near = [found.near[0] for found in feet]
    assert near == sorted(near, reverse=True)
    assert near[0] > 0.1 and near[-1] < 1e-4


def test_a_foot_on_the_floor_carries_at_once_where_nothing_else_does():
    """Else it would be denied its reaction, and the body would fall."""
    assert list(decided(standing(MODEL), memory((0.0, 0.0)), falling_freely()).carrying) == [0, 1]
    plates = plates_under(MODEL, standing(MODEL))
    watched = decided(
        standing(MODEL), memory((0.0, 0.0), 2), falling_freely(), plates=plates, unloaded=(0, 1)
    )
    assert list(watched.carrying) == []


def test_a_body_that_is_only_predicted_to_fall_is_held_by_its_lower_foot():
    """High above the floor; its pelvis stays where it is, so the predicted fall is the filter's own doing."""
    q, kept, carrying = standing(MODEL, 0.5), memory((0.0, 0.0)), []
    for _ in range(30):
        found = decided(q, kept, falling_freely())
        kept = replace(kept, movement=found.movement)
        carrying.append(list(found.carrying))
    assert carrying[0] == [] and [0, 1] in carrying


def test_a_body_that_does_fall_is_not_held():
    q, kept = standing(MODEL, 2.0), memory((0.0, 0.0))
    for t in range(30):
        q[2] = standing(MODEL, 2.0)[2] - 0.5 * 9.8 * (t * DT) ** 2
        found = decided(q, kept, falling_freely())
        kept = replace(kept, movement=found.movement)
        assert list(found.carrying) == []


def test_a_foot_over_an_idle_plate_is_not_near_to_bearing():
    q = standing(MODEL)
    plates = plates_under(MODEL, q)
    assert decided(q, memory((0.0, 0.0), 2), plates=plates, unloaded=(0, 1)).near == (
        0.0,
        0.0,
    )


def test_of_two_feet_above_the_floor_the_lower_one_carries_a_body_that_does_not_fall():
    q = standing(MODEL, 0.5)
    thigh = MODEL.joint("right_thigh")
    step = np.zeros(MODEL.nv)
    step[thigh.v.start + 1] = -0.6
    q = MODEL.integrate(q, step)
    right, left = (sole[0][2] for sole in FEET.at(q, STILL).soles)
    assert right > left + 0.05
    assert list(decided(q, memory((0.0, 0.0))).carrying) == [1]
