"""Cycles, their curves and spatiotemporal parameters, against what a made walk does."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.gait import cycles
from mbkf.trial.gait.cycles import (
    STRAIGHT_DEG,
    Cycle,
    belt_velocity,
    cycles_of,
    find_gait,
    over_cycle,
    turned_deg,
)
from mbkf.trial.gait.events import FeetInMotion, FootEvents, feet_in_motion, plain_found
from tests.dynamics import trial
from tests.motions import assert_near
from tests.recordings import walk, walker


def named(gait):
    return {parameter.name: parameter.values for parameter in gait.parameters}


def events(strikes, offs):
    return FootEvents(np.array(strikes, dtype=float), np.array(offs, dtype=float))


RIGHT = events([0.0, 1.0, 2.0], [0.6, 1.6])
LEFT = events([0.5, 1.5], [0.1, 1.1, 2.1])


def test_cycles_go_from_strike_to_strike():
    first, second = cycles_of((RIGHT, LEFT), 0)
    assert (first.start_s, first.off_s, first.end_s, first.opposite_s) == (0.0, 0.6, 1.0, 0.5)
    assert (second.start_s, second.end_s) == (1.0, 2.0)
    assert first.off_percent == pytest.approx(60.0)
    assert first.support_s == pytest.approx(0.2), "0.1 s after the strike and 0.1 s before the toe-off"
    assert len(cycles_of((RIGHT, LEFT), 1)) == 1


@pytest.mark.parametrize(
    "other",
    [events([], []), events([0.02, 1.02], []), events([0.4, 0.6, 1.5], [])],
    ids=["stands", "hops with it", "strikes twice"],
)
def test_what_the_other_foot_does_makes_it_gait(other):
    kept = [cycle.start_s for cycle in cycles_of((RIGHT, other), 0)]
    assert 0.0 not in kept


def test_no_toe_off_no_cycle_and_no_slow_ones():
    assert cycles_of((events([0.0, 1.0], []), LEFT), 0) == []
    assert cycles_of((events([0.0, 3.0], [2.0]), events([1.5], [])), 0) == []


def test_a_curve_over_the_cycle():
    times = np.linspace(0.0, 3.0, 301)
    (cycle, _) = cycles_of((RIGHT, LEFT), 0)
    assert_near(over_cycle(times, 2.0 * times, cycle), np.linspace(0.0, 2.0, 101), 1e-12)
    assert np.isnan(over_cycle(times, np.where(times > 0.5, np.nan, times), cycle)[60:]).all()


def test_parameters_of_the_made_walk():
    gait, motion = find_gait(walk()), walker()[2]
    assert gait is not None and gait.belt_m_s == 0.0
    table = named(gait)
    travelled = motion.q[-1, 0] - motion.q[0, 0]
    speed = travelled / (motion.times_s[-1] - motion.times_s[0])
    every = {name: np.concatenate(values) for name, values in table.items()}
    assert_near(every["Speed"], speed, 0.03 * speed)
    assert_near(every["Cadence"] * every["Stride time"], 120.0, 1e-9)
    assert_near(every["Stance"] + every["Swing"], 100.0, 1e-9)
    assert_near(every["Stride length"], every["Speed"] * every["Stride time"], 1e-9)
    assert_near(every["Step length"], 0.5 * np.mean(every["Stride length"]), 0.03)
    assert (every["Step width"] > 0.03).all() and (every["Step width"] < 0.25).all()
    assert_near(every["Single support"] + every["Double support"], every["Stance"], 1e-9)
    stance, support = every["Stance"].mean(), every["Double support"].mean()
    assert support == pytest.approx(2.0 * stance - 100.0, abs=2.0), "both feet stand while neither swings"


def test_a_treadmill_is_noticed_and_changes_no_length():
    r = walk()
    moved = r.q.copy()
    moved[:, 0] -= 1.1 * r.times_s
    on_belt, on_floor = find_gait(replace(r, q=moved)), find_gait(r)
    assert on_belt.belt_m_s == pytest.approx(1.1, abs=0.05)
    for name in ("Stride length", "Step length", "Step width", "Speed"):
        for a, b in zip(named(on_belt)[name], named(on_floor)[name], strict=True):
            assert_near(a, b, 0.05)


def belt_of(pelvis_m_s, foot_m_s, heading=0.4):
    """Speed of the belt found under a person whose pelvis and standing feet move forward at these speeds."""
    times = np.arange(300) / 100.0
    forward = np.array([np.cos(heading), np.sin(heading)])
    pelvis = pelvis_m_s * times[:, None] * forward
    soles = np.zeros((300, 2, 3, 3))
    soles[..., :2] = (foot_m_s * times[:, None] * forward)[:, None, None]
    feet = FeetInMotion(times, soles, np.tile(forward, (300, 1)), pelvis)
    cycles = tuple(Cycle(side, 0.5, 1.1, 1.5, 1.0, 0.2) for side in range(2))
    return np.linalg.norm(belt_velocity(feet, cycles))


def test_a_belt_needs_a_pelvis_that_stays_and_feet_that_travel_back():
    assert belt_of(0.0, -1.2) == pytest.approx(1.2)
    assert belt_of(0.2, -3.0) == pytest.approx(3.0), "drifting on a treadmill"
    assert belt_of(8.0, 0.6) == 0.0, "a sprint, whose short stances are cut at their ends"
    assert belt_of(3.0, -0.5) == 0.0, "a run across the room with feet that slip"
    assert belt_of(0.25, -0.4) == 0.0, "a slow walk with feet that slip"
    assert belt_of(0.0, 0.5) == 0.0, "feet that travel forward"
    assert belt_of(0.0, -0.1) == 0.0, "standing still"


def test_an_unseen_body_moves_on_no_belt():
    r = walk()
    lost = replace(r, tracked=np.zeros(r.frames, bool))
    assert find_gait(lost) is None or find_gait(lost).belt_m_s == 0.0


def test_a_squat_is_no_gait():
    squat = trial("squat").motion
    T = len(squat.times_s)
    cut = {
        name: value[:T]
        for name in walk().__dataclass_fields__
        if isinstance(value := getattr(walk(), name), np.ndarray) and name != "plate_corners_m"
    }
    r = replace(walk(), **{**cut, "q": squat.q, "foot_wrench": squat.foot_wrench})
    assert find_gait(r) is None


def test_events_by_hand_stand_instead_of_the_found_ones():
    found = find_gait(walk())
    told = plain_found(found.events)
    again = find_gait(walk(), reversed(told))
    assert again.cycles == found.cycles
    first = found.of(0)[0]
    later = [
        replace(event, time_s=event.time_s + 0.03)
        if (event.side, event.kind) == ("right", "strike")
        else event
        for event in told
    ]
    moved = find_gait(walk(), later).of(0)[0]
    assert moved.start_s == pytest.approx(first.start_s + 0.03, abs=1e-12) and moved.off_s == first.off_s
    assert moved.off_percent < first.off_percent, "stance begins later and ends as before"
    assert find_gait(walk(), ()) is None, "all were deleted"


def test_support_that_nobody_knows_is_told_as_such():
    told = [
        event
        for event in plain_found(find_gait(walk()).events)
        if (event.side, event.kind) != ("left", "off")
    ]
    gait = find_gait(walk(), told)
    assert gait.of(0) and not gait.of(1), "without toe-offs the left foot has no cycle"
    assert np.isnan(named(gait)["Double support"][0]).all()


def test_a_pelvis_turns_by_the_angle_between_both_strikes():
    times = np.linspace(0.0, 3.0, 301)
    yaw = np.deg2rad(170.0 + 40.0 * times)
    forward = np.column_stack([np.cos(yaw), np.sin(yaw)])
    forward[95:130] = np.nan
    feet = replace(feet_in_motion(walk()), times_s=times, forward=forward)
    (first, second) = cycles_of((RIGHT, LEFT), 0)
    assert turned_deg(feet, first) == pytest.approx(40.0) == turned_deg(feet, second)
    assert turned_deg(replace(feet, forward=np.full_like(forward, np.nan)), first) == 0.0


def test_straight_cycles_stay_and_those_of_a_turn_are_left_out(monkeypatch):
    feet, whole = feet_in_motion(walk()), find_gait(walk())
    assert find_gait(walk(), straight=True).cycles == whole.cycles
    last = max(cycle.start_s for cycle in whole.cycles)
    for beyond, stays in ((1.0, False), (-1.0, True)):
        yaw = np.deg2rad(STRAIGHT_DEG + beyond) * (feet.times_s > last + 0.1)
        turning = replace(feet, forward=np.column_stack([np.cos(yaw), np.sin(yaw)]))
        monkeypatch.setattr(cycles, "feet_in_motion", lambda _, made=turning: made)
        found = {cycle.start_s for cycle in find_gait(walk(), straight=True).cycles}
        assert (last in found) is stays and min(one.start_s for one in whole.cycles) in found
