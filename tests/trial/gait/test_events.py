"""Strikes and toe-offs: from loads at the crossing of a threshold, from motion where loads are not known."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.capture import read_capture
from mbkf.io.session import EventKind, FootEvent
from mbkf.trial.gait.events import (
    LOADED_N,
    SAME_S,
    SHORTEST_S,
    FeetInMotion,
    events_by_hand,
    events_of_load,
    events_of_motion,
    feet_in_motion,
    foot_events,
    plain_found,
)
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from tests.motions import assert_near
from tests.recordings import LOST, broken_walk, walk

TIMES = np.arange(300) / 100.0


def test_a_load_is_crossed_between_frames():
    force = np.interp(TIMES, [0.0, 0.5, 0.7, 1.5, 1.7, 3.0], [0.0, 0.0, 700.0, 700.0, 0.0, 0.0])
    found = events_of_load(TIMES, force, threshold_n=35.0)
    assert_near(found.strikes_s, [0.51], 1e-9)
    assert_near(found.offs_s, [1.69], 1e-9)


def test_short_blinks_are_no_events():
    force = np.where((TIMES > 0.5) & (TIMES < 1.5), 600.0, 0.0)
    force[[20, 100]] = [300.0, 0.0]
    found = events_of_load(TIMES, force)
    assert (len(found.strikes_s), len(found.offs_s)) == (1, 1)


@pytest.mark.parametrize(("frames", "contacts"), [(7, 0), (8, 1)])
def test_a_contact_of_the_shortest_time_is_one_and_one_frame_less_is_noise(frames, contacts):
    assert SHORTEST_S == 0.08  # 8 frames
    force = np.zeros(300)
    force[100 : 100 + frames] = 600.0
    found = events_of_load(TIMES, force)
    assert (len(found.strikes_s), len(found.offs_s)) == (contacts, contacts)


def test_a_contact_that_the_trial_cuts_short_is_no_blink():
    force = np.zeros(300)
    force[:3] = force[-3:] = 600.0
    found = events_of_load(TIMES, force)
    assert_near(found.offs_s, [TIMES[2] + 0.01 * (600.0 - LOADED_N) / 600.0], 1e-9)
    assert_near(found.strikes_s, [TIMES[-4] + 0.01 * LOADED_N / 600.0], 1e-9)


def test_what_begins_or_ends_unseen_is_no_event():
    force = np.where(TIMES < 1.0, 600.0, 0.0)
    assert len(events_of_load(TIMES, force).strikes_s) == 0
    force[90:110] = np.nan
    assert len(events_of_load(TIMES, force).offs_s) == 0
    assert len(events_of_load(TIMES[:1], force[:1]).strikes_s) == 0


@pytest.mark.parametrize("heading", [0.0, 2.0])
@pytest.mark.parametrize("speed_m_s", [0.0, 1.3])
@pytest.mark.parametrize("after_frame_s", [0.0, 0.003, -0.004])
def test_motion_tells_strikes_on_floors_and_treadmills_in_any_direction(heading, speed_m_s, after_frame_s):
    forward = np.array([np.cos(heading), np.sin(heading)])
    pelvis = speed_m_s * TIMES[:, None] * forward
    swing = 0.3 * np.cos(2.0 * np.pi * (TIMES - 0.4 - after_frame_s))
    soles = np.zeros((300, 2, 3, 3))
    soles[:, 0, :, :2] = (pelvis + swing[:, None] * forward)[:, None]
    soles[:, 1, :, :2] = pelvis[:, None]
    feet = FeetInMotion(TIMES, soles, np.tile(forward, (300, 1)), pelvis)
    assert_near(events_of_motion(feet, 0).strikes_s, np.array([0.4, 1.4, 2.4]) + after_frame_s, 1e-5)
    assert_near(events_of_motion(feet, 0).offs_s, np.array([0.9, 1.9]) + after_frame_s, 1e-5)
    assert len(events_of_motion(feet, 1).strikes_s) == 0, "a foot that does not swing does not walk"


def test_true_loads_of_a_walk():
    r = walk()
    for side, events in enumerate(foot_events(r)):
        loaded = r.foot_wrench[:, side, 2] > LOADED_N
        begins = r.times_s[1:][~loaded[:-1] & loaded[1:]]
        ends = r.times_s[1:][loaded[:-1] & ~loaded[1:]]
        assert_near(events.strikes_s, begins, 1.0 / r.rate_hz)
        assert_near(events.offs_s, ends, 1.0 / r.rate_hz)


def test_motion_fills_in_where_the_kinematic_filter_has_no_plate():
    whole, r = foot_events(walk()), walk()
    force = r.foot_wrench.copy()
    force[:, 0] = 0.0
    without = foot_events(replace(r, filter="kinematic", foot_contact=None, foot_wrench=force))
    inside = [t for t in whole[0].strikes_s if 0.1 < t < r.times_s[-1] - 0.1]
    assert inside
    for t in inside:
        assert np.abs(without[0].strikes_s - t).min() < 0.08
    assert len(without[1].strikes_s) >= len(whole[1].strikes_s)
    for t in whole[1].strikes_s:
        assert (np.abs(without[1].strikes_s - t) < SAME_S).sum() == 1, "one event, told twice"


def test_where_the_body_is_lost_feet_are_nowhere():
    feet = feet_in_motion(broken_walk())
    assert np.isnan(feet.soles_m[LOST]).all()
    assert np.isfinite(feet.soles_m[: LOST.start]).all()
    assert_near(np.linalg.norm(feet.forward[: LOST.start], axis=1), 1.0, 1e-12)


@pytest.mark.slow
def test_events_are_those_the_laboratory_stored(real_data):
    folder = real_data / "gaitalytics_walk"
    capture = read_capture(folder / "overground_fullbody_4plates.c3d")
    subject = scale(None, trials=(capture,), mass_kg=63.6)
    settings = ReconstructSettings(filter="kinematic", smooth=False)
    found = foot_events(reconstruct(capture, subject, settings=settings))
    for side, context in enumerate(("Right", "Left")):
        for label, ours in (("Foot Strike", found[side].strikes_s), ("Foot Off", found[side].offs_s)):
            theirs = [e.time_s for e in capture.events if (e.context, e.label) == (context, label)]
            first, last = capture.markers.times_s[[10, -10]]
            for t in theirs:
                if first < t < last:
                    assert np.abs(ours - t).min() < 0.06, (context, label, t)


def test_events_by_hand_are_sorted_each_once_and_within_the_trial():
    times = np.linspace(1.0, 2.0, 101)
    said = [
        FootEvent("right", EventKind.STRIKE, 1.5), FootEvent("right", EventKind.STRIKE, 1.2),
        FootEvent("right", EventKind.STRIKE, 1.5), FootEvent("left", EventKind.OFF, 2.0),
        FootEvent("left", EventKind.OFF, 2.01), FootEvent("left", EventKind.STRIKE, 0.99),
    ]  # fmt: skip
    right, left = events_by_hand(said, times)
    assert right.strikes_s.tolist() == [1.2, 1.5] and right.offs_s.tolist() == []
    assert left.strikes_s.tolist() == [] and left.offs_s.tolist() == [2.0]
    told = plain_found((right, left))
    assert [event.time_s for event in told] == [1.2, 1.5, 2.0] and set(told) <= set(said)
