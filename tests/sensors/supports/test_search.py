"""Which parts bear besides the feet, from exact motions: seats and loads are found, squats and wrong masses are not."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.numerics.runs import stretches
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.sensors.supports.search import ON_FLOOR_M, RESTS_M_S, RESTS_S, other_contacts
from mbkf.synthesis.person import body_of
from tests.dynamics import standing, trial
from tests.motions import reference_model
from tests.supported import SEAT, carried, foot_loads, middles, part, seat, seated

SLIGHT_SHARE, LATE_S = 0.05, 0.1
"""Part of body weight from which a contact counts here, and how late or early it may be found."""

HELD = slice(60, 150)
"""Frames of the squat in which something is held."""


def found(made, wrench, model=None, q=None, **changes):
    """What the search finds in a trial whose plates give wrenches (T, 2, 6) to the feet."""
    m, read = made.motion, np.broadcast_to(changes.pop("read", True), len(wrench))
    q, hidden = m.q if q is None else q, changes.pop("unobservable", None)
    loads = foot_loads(wrench, **changes)
    return other_contacts(model or made.model, q, m.v, m.rate_hz, loads, read, unobservable=hidden)


def bearing(flags):
    """Places of the parts that bear in some frame."""
    return np.flatnonzero(flags.any(axis=0)).tolist()


def weight_n(made):
    return made.model.mass_kg * GRAVITY_M_S2


@cache
def points(name):
    return middles(trial(name).model, trial(name).motion)


def pressed(share, at, direction=(0.0, 0.0, -1.0), name="squat", **changes):
    """A squat in which a force of this share of body weight acts at points (T, 3) while something is held."""
    made = trial(name)
    frames = len(made.motion.q)
    held = np.convolve(np.isin(np.arange(frames), np.arange(frames)[HELD]), np.ones(5) / 5, "same")
    force = share * weight_n(made) * held[:, None] * np.array(direction)
    return found(made, carried(made.motion, at, force), **changes)


def test_a_seat_is_found_when_it_bears():
    made = seated()
    result = found(made, made.motion.foot_wrench)
    assert bearing(result.flags) == [SEAT]
    assert result.remarks == ()
    true = np.linalg.norm(seat(made.motion)[:, :3], axis=1) > SLIGHT_SHARE * weight_n(made)
    (ours,), (theirs,) = stretches(result.flags[:, SEAT]), stretches(true)
    late = LATE_S * made.motion.rate_hz
    assert abs(ours[0] - theirs[0]) <= late
    assert abs(ours[-1] - theirs[-1]) <= late


@pytest.mark.parametrize("factor", [0.96, 1.04])
def test_a_seat_is_left_at_its_time_by_a_body_of_another_mass(factor):
    """Standing, the motion then requires 4 % more or less than the plates read: that is not the seat's."""
    made = seated()
    other = body_of(replace(made.subject, mass_kg=factor * made.subject.mass_kg))
    (right,), (found_by_other,) = (
        stretches(found(made, made.motion.foot_wrench, model).flags[:, SEAT]) for model in (None, other)
    )
    assert abs(right[0] - found_by_other[0]) <= 2 and abs(right[-1] - found_by_other[-1]) <= 2


def test_who_sits_throughout_sits():
    made = seated()
    sits = np.linalg.norm(seat(made.motion)[:, :3], axis=1) > 0.5 * weight_n(made)
    m, wrench = made.motion, made.motion.foot_wrench[sits]
    read = np.ones(len(wrench), dtype=bool)
    result = other_contacts(made.model, m.q[sits], m.v[sits], m.rate_hz, foot_loads(wrench), read)
    assert result.flags[:, SEAT].all() and bearing(result.flags) == [SEAT] and result.remarks == ()


def test_a_seat_on_a_plate_is_nothing_else():
    made = seated()
    whole = made.motion.foot_wrench.copy()
    whole[:, 0] += seat(made.motion)
    result = found(made, whole)
    assert not result.flags.any()
    assert result.remarks == ()


@pytest.mark.parametrize("name", ["squat", "walk"])
def test_who_stands_on_the_plates_alone_touches_nothing_else(name):
    result = found(trial(name), trial(name).motion.foot_wrench)
    assert not result.flags.any()
    assert result.remarks == ()


@pytest.mark.parametrize("hand", ["right_hand", "left_hand"])
def test_a_load_on_a_hand_is_on_that_hand(hand):
    made = trial("squat")
    k = part(made.model, hand)
    result = pressed(0.15, points("squat")[:, k])
    assert bearing(result.flags) == [k]
    (run,) = stretches(result.flags[:, k])
    assert abs(run[0] - HELD.start) <= 10
    assert abs(run[-1] - HELD.stop) <= 10


def test_a_hand_that_no_marker_shows_holds_nothing():
    """Its place is that of a usual posture: the force stays unexplained."""
    made, hidden = trial("squat"), np.zeros(trial("squat").model.nv, dtype=bool)
    hidden[made.model.joint("right_forearm").v] = True
    at = points("squat")[:, part(made.model, "right_hand")]
    assert part(made.model, "right_hand") not in bearing(pressed(0.15, at, unobservable=hidden).flags)
    hidden[made.model.joint("right_forearm").v.start] = False
    assert bearing(pressed(0.15, at, unobservable=hidden).flags) == [part(made.model, "right_hand")]


def test_no_seat_moves_with_a_walking_pelvis():
    """Whoever walks or lands is not carried by a seat."""
    assert not pressed(0.2, points("walk")[:, SEAT], (0.0, 0.0, 1.0), "walk").flags.any()
    assert bearing(pressed(0.2, points("squat")[:, SEAT], (0.0, 0.0, 1.0)).flags) == [SEAT]


def test_a_load_between_the_hands_is_on_both():
    made = trial("squat")
    pair = [part(made.model, side) for side in ("right_hand", "left_hand")]
    result = pressed(0.25, points("squat")[:, pair].mean(axis=1))
    assert bearing(result.flags) == sorted(pair)


def test_nothing_but_a_hand_can_be_pulled():
    """What hangs on the back of a person hangs on no part that could be told."""
    result = pressed(0.2, points("squat")[:, SEAT] + np.array([-0.5, 0.0, 0.0]))
    assert not result.flags.any()
    assert len(result.remarks) == 1


def test_a_force_that_leads_through_no_part_is_told():
    """A push from below, a metre to the side of the body."""
    made = trial("squat")
    result = pressed(0.2, points("squat")[:, SEAT] + np.array([0.0, 1.5, 0.0]), (0.0, 0.0, 1.0))
    assert not result.flags.any()
    (remark,) = result.remarks
    force_n = 0.2 * weight_n(made)
    stated = float(remark.split("requires ")[1].split(" N")[0])
    assert 0.8 * force_n < stated < 1.05 * force_n, "the mean over begin and end, too"


def test_what_pushes_a_sole_is_a_foots():
    """A foot that presses beside its plate, say: neither another part bears nor is there anything to tell."""
    made = trial("squat")
    sole = sole_points(made.model, made.motion.q).mean(axis=2)[:, 1]
    result = pressed(0.2, sole, (0.0, 0.0, 1.0))
    assert not result.flags.any()
    assert result.remarks == ()


def test_a_slight_or_a_short_force_is_none():
    made = trial("squat")
    hand = points("squat")[:, part(made.model, "right_hand")]
    assert not pressed(0.05, hand).flags.any()
    short = np.zeros((len(hand), 3))
    short[80:90, 2] = -0.2 * weight_n(made)
    assert not found(made, carried(made.motion, hand, short)).flags.any()


@pytest.mark.parametrize(("factor", "sign"), [(1.25, "+"), (0.8, "-")])
def test_a_wrong_mass_is_told_and_is_no_contact(factor, sign):
    made = trial("squat")
    other = body_of(replace(made.subject, mass_kg=factor * made.subject.mass_kg))
    result = found(made, made.motion.foot_wrench, other)
    assert not result.flags.any()
    (remark,) = result.remarks
    percent = 100.0 * (1.0 - 1.0 / factor)
    assert f"{sign}{abs(percent):.0f} %" in remark
    assert "throughout" in remark


def test_plates_that_do_not_read_every_foot_tell_nothing():
    """The seat is high above the floor, so that nothing else can be seen of it either."""
    result = found(seated(), seated().motion.foot_wrench, unread=True)
    assert not result.flags.any()
    assert result.remarks == ()


def test_without_plates_the_whole_reaction_tells_of_a_seat():
    flags = found(seated(), seated().motion.foot_wrench, read=False).flags
    pelvis = part(seated().model, "pelvis")
    assert flags[:, pelvis].any() and not np.delete(flags, pelvis, axis=1).any()


def test_untracked_frames_have_no_contacts():
    made = seated()
    q = made.motion.q.copy()
    q[40:70] = np.nan
    result = found(made, made.motion.foot_wrench, q=q)
    assert bearing(result.flags) == [SEAT]
    assert not result.flags[40:70].any()
    assert result.flags[10:35, SEAT].all() and result.flags[75:95, SEAT].all()


@pytest.mark.parametrize(
    ("gap", "bears"), [((60, 63), True), ((0, 10), True), ((60, 90), False), ((112, 125), False)]
)
def test_a_contact_goes_on_where_plates_fall_silent_for_a_moment(gap, bears):
    """A seat does not vanish for some frames; whether it is there after a longer time, or at its end, is not known."""
    made, silent = seated(), np.arange(*gap)
    read = np.ones(len(made.motion.q), dtype=bool)
    read[silent] = False
    wrench = made.motion.foot_wrench.copy()
    wrench[silent] = 0.0
    result = found(made, wrench, read=read)
    assert bearing(result.flags) == [SEAT]
    assert (result.flags[silent, SEAT] == bears).all()
    np.testing.assert_array_equal(result.flags[20:50, SEAT], True)


# On the floor, without plates.

REFERENCE, STILL_FRAMES, RATE_HZ = reference_model(), 60, 100.0


def lying(name, above_m, v=None, frames=slice(None), read=False):
    """(T, B) parts that bear of a body at rest; a part's skin this high over the floor in some of the frames.

    In the others the whole body is a metre higher.
    """
    q = np.repeat(standing(REFERENCE)[None], STILL_FRAMES, axis=0)
    v = np.zeros((STILL_FRAMES, REFERENCE.nv)) if v is None else v
    bearings, k = BearingParts(REFERENCE), part(REFERENCE, name)
    skin = bearings.at(q[0], v[0]).points_m[k, 2] - bearings.radii_m[k]
    high = np.ones(STILL_FRAMES)
    high[frames] = 0.0
    q[:, 2] += high
    loads = foot_loads(np.zeros((STILL_FRAMES, 2, 6)), floor_m=skin - above_m)
    return other_contacts(REFERENCE, q, v, RATE_HZ, loads, np.full(STILL_FRAMES, read)).flags


def low_beside(name):
    """Places of the parts whose skin is low enough when a part's skin touches the floor."""
    bearings = BearingParts(REFERENCE)
    skin = bearings.at(standing(REFERENCE), np.zeros(REFERENCE.nv)).points_m[:, 2] - bearings.radii_m
    return np.flatnonzero(skin < skin[part(REFERENCE, name)] + ON_FLOOR_M).tolist()


@pytest.mark.parametrize("name", ["right_knee", "left_hand", "pelvis"])
def test_parts_near_the_floor_lie_on_it_where_no_plates_read(name):
    assert bearing(lying(name, 0.0)) == low_beside(name)
    assert lying(name, 0.0)[:, part(REFERENCE, name)].all()
    assert part(REFERENCE, name) not in bearing(lying(name, ON_FLOOR_M + 0.001))


def test_parts_that_move_do_not_lie():
    v = np.zeros((STILL_FRAMES, REFERENCE.nv))
    v[:, 0] = 0.9 * RESTS_M_S
    assert lying("right_knee", 0.0, v).any()
    v[:, 0] = 1.1 * RESTS_M_S
    assert not lying("right_knee", 0.0, v).any()


def test_parts_lie_for_a_while():
    least = round(RESTS_S * RATE_HZ)
    assert not lying("right_knee", 0.0, frames=slice(20, 20 + least - 1)).any()
    flags = lying("right_knee", 0.0, frames=slice(20, 20 + least))
    assert stretches(flags.any(axis=1))[0].tolist() == list(range(20, 20 + least))


def test_where_plates_read_every_foot_the_floor_is_not_asked():
    """A body in the air, whose weight nothing gives, is a wrong mass; its knees are not on a floor."""
    assert not lying("right_knee", 0.0, read=True).any()
