"""Causal contact decisions against motions whose loads are known and against single situations."""

from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.numerics.windows import dilated
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactMemory
from mbkf.sensors.contact.rules import LEAVE_SLACK, PARTED_M_S, STAND_AFTER_S
from mbkf.sensors.contact.sharing import share_load
from mbkf.sensors.contact.soles import sole_points
from tests.dynamics import DT, half_weight, plate, plates_under, standing, trial
from tests.motions import assert_near, reference_model

MODEL = reference_model()
STILL = np.zeros(MODEL.nv)
RIGHT, LEFT = 0, 1
each_motion = pytest.mark.parametrize("name", ["squat", "walk", pytest.param("jump", marks=pytest.mark.slow)])


def decisions(made, loads, plates=None):
    """(T, 2) contacts over a true motion whose plates read ``loads`` (T, K, 6)."""
    feet, m = made.detector(plates), made.motion
    memory, found = feet.begin(), []
    for q, v, a, load in zip(m.q, m.v, m.a, loads, strict=True):
        decided = feet.decide(memory, q, v, a, load)
        memory = decided.memory
        found.append(decided.contacts)
    return np.array(found)


def vertical(made):
    return made.motion.foot_wrench[:, :, 2]


@each_motion
def test_loaded_feet_are_measured_and_hanging_ones_in_the_air(name):
    """A plate per foot that reads the truth; the plates' threshold is 20 N."""
    made = trial(name)
    found, load = decisions(made, made.motion.foot_wrench), vertical(made)
    assert (found[load >= 40.0] == Contact.MEASURED).all()
    assert (found[load == 0.0] == Contact.AIR).all()


@pytest.mark.slow
def test_all_flight_is_in_the_air():
    made = trial("jump")
    off, on = made.motion.flight_s
    flying = (made.motion.times_s > off) & (made.motion.times_s < on)
    assert flying.sum() > 20
    assert (decisions(made, made.motion.foot_wrench)[flying] == Contact.AIR).all()


@each_motion
def test_a_measured_foot_gets_its_own_plate(name):
    made = trial(name)
    feet, m = made.detector(), made.motion
    memory = feet.begin()
    for t in range(len(m.q)):
        decided = feet.decide(memory, m.q[t], m.v[t], m.a[t], m.foot_wrench[t])
        memory = decided.memory
        for foot in (RIGHT, LEFT):
            expected = m.foot_wrench[t, foot] if decided.contacts[foot] == Contact.MEASURED else np.zeros(6)
            np.testing.assert_array_equal(decided.wrench[foot], expected)
        assert not decided.stray


@each_motion
@pytest.mark.parametrize("recorded", [False, True], ids=["no plate", "plate not recorded"])
def test_a_foot_off_the_plates_is_unmeasured_while_it_carries(name, recorded):
    made = trial(name)
    loads = made.motion.foot_wrench.copy()
    if recorded:
        loads[:, LEFT] = np.nan
        found = decisions(made, loads)
    else:
        found = decisions(made, loads[:, :1], made.plates[:1])
    load = vertical(made)
    assert (found[load[:, LEFT] > 100.0, LEFT] == Contact.UNMEASURED).mean() >= 0.9
    assert (found[load[:, RIGHT] >= 40.0, RIGHT] == Contact.MEASURED).all()
    hanging = load[:, LEFT] == 0.0
    # A foot about to land beside which nothing else carries is taken to bear; its reaction may still be nothing.
    assert not hanging.any() or (found[hanging, LEFT] == Contact.AIR).mean() > 0.3


def stand_on(plates, loads, q=None, frames=1, v=STILL, a=STILL):
    """Decision of the last of some frames of one pose."""
    feet = ContactDetector(MODEL, plates, DT)
    memory, q = feet.begin(), standing(MODEL) if q is None else q
    for _ in range(frames):
        decided = feet.decide(memory, q, v, a, np.asarray(loads, dtype=float).reshape(len(plates), 6))
        memory = decided.memory
    return decided


def test_both_feet_on_one_plate_share_it():
    middles = sole_points(MODEL, standing(MODEL)[None])[0].mean(axis=1)
    both = half_weight(MODEL, middles).sum(axis=0)
    x, y = middles.mean(axis=0)[:2]
    decided = stand_on([plate(x, y)], [both])
    assert decided.contacts == (Contact.SHARED, Contact.SHARED)
    np.testing.assert_array_equal(decided.wrench, [both, both])
    assert not decided.stray


def test_what_a_shared_plate_reads_is_shared_where_the_feet_are_predicted():
    q = standing(MODEL)
    soles = sole_points(MODEL, q[None])[0]
    both = half_weight(MODEL, soles.mean(axis=1)).sum(axis=0)
    x, y = soles.mean(axis=(0, 1))[:2]
    found = stand_on([plate(x, y)], [both]).shared
    expected = share_load(both, soles.tolist(), q[:3], 0.0)
    assert_near(found.wrench, expected.wrench, 1e-9)
    assert_near(found.sd, expected.sd, 1e-9)
    assert stand_on([plate(3.0, 0.0)], np.zeros(6)).shared is None


@pytest.mark.parametrize("share", [0.02, 0.5, 0.98])
def test_feet_share_a_plate_wherever_they_press_it(share):
    """Also where the pressure lies under one sole."""
    middles = sole_points(MODEL, standing(MODEL)[None])[0].mean(axis=1)
    both = half_weight(MODEL, middles) * [[2 * share], [2 * (1 - share)]]
    x, y = middles.mean(axis=0)[:2]
    assert stand_on([plate(x, y)], [both.sum(axis=0)]).contacts == (Contact.SHARED, Contact.SHARED)


def test_a_plate_without_an_outline_is_not_shared():
    middles = sole_points(MODEL, standing(MODEL)[None])[0].mean(axis=1)
    x, y = middles.mean(axis=0)[:2]
    decided = stand_on([plate(x, y, outline=False)], half_weight(MODEL, middles).sum(axis=0))
    assert Contact.SHARED not in decided.contacts


def passing(speed_m_s):
    """Velocities at which the hips carry the soles against each other at a speed."""
    v = STILL.copy()
    jacobian = [
        MODEL.segment_jacobian(standing(MODEL), foot, np.zeros(3)) for foot in ("right_foot", "left_foot")
    ]
    hips = [MODEL.joint(f"{side}_thigh").v.start + 1 for side in ("right", "left")]
    v[hips[RIGHT]] = 0.5 * speed_m_s / jacobian[RIGHT][0, hips[RIGHT]]
    v[hips[LEFT]] = -0.5 * speed_m_s / jacobian[LEFT][0, hips[LEFT]]
    return v


def test_feet_that_pass_each_other_do_not_share_and_feet_on_a_belt_do():
    """Speed against each other counts, not that of the belt; what parts has to be clearly faster than what meets."""
    q = standing(MODEL)
    middles = sole_points(MODEL, q[None])[0].mean(axis=1)
    both, at = half_weight(MODEL, middles).sum(axis=0)[None], middles.mean(axis=0)
    feet = ContactDetector(MODEL, [plate(at[0], at[1], (3.0, 3.0))], DT)
    belt = STILL.copy()
    belt[0] = -2.0

    def owner(memory, v):
        return feet.decide(memory, q, v, STILL, both).memory

    parted = 0.5 * (1.0 + LEAVE_SLACK) * PARTED_M_S
    apart, together = feet.begin(), owner(feet.begin(), belt)
    assert together.foot_of_plate == (2,)
    assert owner(apart, belt + passing(0.8 * PARTED_M_S)).foot_of_plate == (2,)
    assert owner(apart, belt + passing(parted)).foot_of_plate != (2,)
    assert owner(together, belt + passing(parted)).foot_of_plate == (2,)
    assert owner(together, belt + passing(1.2 * LEAVE_SLACK * PARTED_M_S)).foot_of_plate != (2,)


@pytest.mark.parametrize("belt_m_s", [0.0, -1.5])
def test_a_plate_stays_with_its_foot_while_the_other_swings_over(belt_m_s):
    """The pressure lies under the other sole; a foot at rest takes the plate there, one that swings does not."""
    q = standing(MODEL)
    middles = sole_points(MODEL, q[None])[0].mean(axis=1)
    loads = half_weight(MODEL, middles)
    feet = ContactDetector(MODEL, [plate(0.0, 0.0, outline=False)], DT)
    belt, swings = STILL.copy(), STILL.copy()
    belt[0] = belt_m_s
    hip = MODEL.joint("left_thigh").v.start + 1
    swings[hip] = 4.0 / MODEL.segment_jacobian(q, "left_foot", np.zeros(3))[0, hip]
    memory = feet.begin()
    for _ in range(40):
        memory = feet.decide(memory, q, belt, STILL, loads[RIGHT : RIGHT + 1]).memory
    assert memory.foot_of_plate == (RIGHT,)
    beside = loads[LEFT : LEFT + 1]
    assert feet.decide(memory, q, belt + swings, STILL, beside).memory.foot_of_plate == (RIGHT,)
    assert feet.decide(memory, q, belt, STILL, beside).memory.foot_of_plate == (LEFT,)


def test_a_foot_lifted_or_beside_the_plate_does_not_share_it():
    q = standing(MODEL)
    middles = sole_points(MODEL, q[None])[0].mean(axis=1)
    on_right = half_weight(MODEL, middles)[RIGHT] * 2
    lifted = q.copy()
    lifted[MODEL.joint("left_thigh").q] = Rotation.from_euler("y", -40, degrees=True).as_quat()
    lifted[MODEL.joint("left_shank").q] = Rotation.from_euler("y", 80, degrees=True).as_quat()
    large = plate(middles[RIGHT, 0], middles[RIGHT, 1], (3.0, 3.0))
    assert stand_on([large], on_right, lifted).contacts == (Contact.MEASURED, Contact.AIR)
    small = plate(middles[RIGHT, 0], middles[RIGHT, 1], (0.2, 0.05))
    assert stand_on([small], on_right, q).contacts[RIGHT] == Contact.MEASURED


@pytest.mark.parametrize("belt_m_s", [0.0, 1.2])
def test_a_walk_over_one_plate_is_shared_while_both_feet_bear(belt_m_s):
    """Over the floor, and on a belt that carries the feet back; just before and after, one has nearly all."""
    made = trial("walk")
    m, load = made.motion, vertical(made)
    feet = ContactDetector(made.model, [plate(0.0, 0.0, (5.0, 5.0))], DT)
    memory, found, off = feet.begin(), [], []
    for t, a in enumerate(m.a):
        q, v, both = m.q[t].copy(), m.v[t].copy(), m.foot_wrench[t].sum(axis=0)
        back = np.array([-belt_m_s * m.times_s[t], 0.0, 0.0])
        q[:3] += back
        v[:3] += made.model.placements(q)[0][made.model.root.joint_id].T @ [-belt_m_s, 0.0, 0.0]
        both[3:] += np.cross(back, both[:3])
        decided = feet.decide(memory, q, v, a, both[None])
        memory = decided.memory
        found.append(decided.shared is not None)
        if decided.shared is not None:
            off.append(decided.shared.wrench[:, 2] - load[t])
    found, both_bear = np.array(found), (load > 20.0).all(axis=1)
    assert found[both_bear].all()
    assert not found[~dilated(both_bear, 7)].any()
    assert np.sqrt(np.mean(np.square(off))) < 0.04 * made.model.mass_kg * GRAVITY_M_S2


def test_two_plates_are_not_shared():
    q = standing(MODEL)
    middles = sole_points(MODEL, q[None])[0].mean(axis=1)
    decided = stand_on(plates_under(MODEL, q), half_weight(MODEL, middles))
    assert decided.contacts == (Contact.MEASURED, Contact.MEASURED)
    np.testing.assert_array_equal(decided.wrench, half_weight(MODEL, middles))


def test_a_body_on_a_box_is_carried_and_one_that_falls_off_it_is_not():
    """The plates read nothing, the feet are half a metre above them and the pelvis does not fall."""
    q = standing(MODEL, 0.5)
    beside = [plate(3.0, 0.0)]
    assert stand_on(beside, np.zeros(6), q).contacts == (Contact.UNMEASURED, Contact.UNMEASURED)
    falls = STILL.copy()
    falls[2] = -GRAVITY_M_S2
    assert stand_on(beside, np.zeros(6), q, a=falls).contacts == (Contact.AIR, Contact.AIR)


def test_falling_is_judged_in_the_world_whatever_the_pelvis_points_at():
    q = standing(MODEL, 0.5)
    q[3:7] = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]  # on the side: world's up is the pelvis's y
    a = STILL.copy()
    a[1] = -GRAVITY_M_S2
    beside = [plate(3.0, 0.0)]
    assert stand_on(beside, np.zeros(6), q, a=a).contacts == (Contact.AIR, Contact.AIR)
    v, a = STILL.copy(), STILL.copy()
    v[:6] = [0.0, 0.0, 2.0, 5.0, 0.0, 0.0]  # ω × v is −10 along y
    assert stand_on(beside, np.zeros(6), q, v=v, a=a).contacts == (Contact.AIR, Contact.AIR)
    assert Contact.UNMEASURED in stand_on(beside, np.zeros(6), q).contacts


def test_a_foot_above_an_unloaded_plate_carries_nothing():
    q = standing(MODEL)
    over = plates_under(MODEL, q)
    half = half_weight(MODEL, sole_points(MODEL, q[None])[0].mean(axis=1))
    decided = stand_on(over, [half[RIGHT] * 2, np.zeros(6)], frames=20)
    assert decided.contacts == (Contact.MEASURED, Contact.AIR)
    decided = stand_on(over, [half[RIGHT], np.full(6, np.nan)], frames=20)
    assert decided.contacts == (Contact.MEASURED, Contact.UNMEASURED)


def test_a_foot_on_the_floor_is_held_back_until_its_plate_could_read():
    q = standing(MODEL)
    half = half_weight(MODEL, sole_points(MODEL, q[None])[0].mean(axis=1))
    one = plates_under(MODEL, q)[:1]
    wait = int(STAND_AFTER_S / DT)
    feet, v = ContactDetector(MODEL, one, DT), np.zeros(MODEL.nv)
    lifted = q.copy()
    lifted[2] += 0.3
    memory = feet.decide(feet.begin(), lifted, v, v, np.zeros((1, 6))).memory
    found = []
    for _ in range(wait + 2):
        decided = feet.decide(memory, q, v, v, half[RIGHT][None])
        memory = decided.memory
        found.append(decided.contacts[LEFT])
    assert found[wait - 1] == Contact.AIR
    assert found[-1] == Contact.UNMEASURED


def test_a_trial_may_begin_on_unread_feet():
    q = standing(MODEL)
    half = half_weight(MODEL, sole_points(MODEL, q[None])[0].mean(axis=1))
    assert stand_on(plates_under(MODEL, q)[:1], half[RIGHT], frames=1).contacts[LEFT] == Contact.UNMEASURED


def test_a_loaded_plate_without_a_foot_is_stray():
    wrench = np.array([0.0, 0.0, 500.0, 0.0, -500.0 * 3.0, 0.0])
    assert stand_on([plate(3.0, 0.0)], wrench).stray
    assert not stand_on([plate(3.0, 0.0)], np.zeros(6)).stray


def test_no_plates_at_all():
    decided = stand_on([], np.zeros((0, 6)))
    assert decided.contacts == (Contact.UNMEASURED, Contact.UNMEASURED)
    assert decided.wrench.shape == (2, 6)


@each_motion
def test_decisions_repeat_and_leave_their_inputs_alone(name):
    made = trial(name)
    m, feet = made.motion, made.detector()
    memory = feet.begin()
    for t in range(0, len(m.q), 7):
        inputs = m.q[t].copy(), m.v[t].copy(), m.a[t].copy(), m.foot_wrench[t].copy()
        first = feet.decide(memory, *inputs)
        before = first.memory
        feet.decide(first.memory, *(inputs[:3]), 0.5 * inputs[3])
        again = feet.decide(memory, *inputs)
        assert again.contacts == first.contacts
        assert repr(again.memory) == repr(first.memory) == repr(before)
        for given, kept in zip(inputs, (m.q[t], m.v[t], m.a[t], m.foot_wrench[t]), strict=True):
            np.testing.assert_array_equal(given, kept)
        memory = first.memory


def test_memory_cannot_be_changed():
    kept = stand_on([plate(0.0, 0.0)], np.zeros(6)).memory
    memory = ContactDetector(MODEL, [plate(0.0, 0.0)], DT).begin()
    assert not memory.packed(100).numbers.flags.writeable
    assert isinstance(kept, ContactMemory) or not kept.numbers.flags.writeable
    for field in fields(memory):
        with pytest.raises(FrozenInstanceError):
            setattr(memory, field.name, None)
        assert isinstance(getattr(memory, field.name), tuple | float)


@pytest.mark.parametrize("name", ["squat", "walk"])
def test_a_planted_foot_is_at_rest(name):
    """Over a true motion the point and, where it lies flat, the segment are nearly at rest."""
    made = trial(name)
    feet, m = made.detector(), made.motion
    memory, speeds, turns = feet.begin(), [], []
    for q, v, a, load in zip(m.q, m.v, m.a, m.foot_wrench, strict=True):
        decided = feet.decide(memory, q, v, a, load)
        memory = decided.memory
        for foot in np.flatnonzero(load[:, 2] > 100.0):
            planted = feet.planted(decided, q, foot)
            twist = made.model.segment_jacobian(q, planted.segment, planted.point_m) @ v
            speeds.append(np.linalg.norm(twist[:3]))
            turns += [np.linalg.norm(twist[3:])] if planted.flat else []
    assert max(speeds) < 0.1
    assert np.percentile(turns, 90) < 0.1  # toes that are about to leave turn faster


def test_a_foot_loaded_before_its_ball_stands_on_the_toes():
    q = standing(MODEL)
    soles = sole_points(MODEL, q[None])[0]
    for share, segment, flat in (
        (0.05, "right_foot", False),
        (0.4, "right_foot", True),
        (0.9, "right_toes", True),
    ):
        at = soles[RIGHT, 0] + share * (soles[RIGHT, 2] - soles[RIGHT, 0])
        loads = half_weight(MODEL, np.array([at, soles[LEFT].mean(axis=0)]))
        feet = ContactDetector(MODEL, plates_under(MODEL, q), DT)
        planted = feet.planted(feet.decide(feet.begin(), q, STILL, STILL, loads), q, RIGHT)
        assert (planted.segment, planted.flat) == (segment, flat)
        np.testing.assert_allclose(planted.point_m[:2], at[:2], atol=1e-9)
