"""Feet that swing from spot to spot: smooth, still while they carry, without load while they are lifted."""

import numpy as np
import pytest

from mbkf.conventions import SIDES
from mbkf.synthesis.contact import sole_outline
from mbkf.synthesis.curves import path, sinusoid
from mbkf.synthesis.footwork import HEEL_OFF_S, Footwork, Spot, Swing

SECONDS = 6.0
STEP = Spot(np.array([0.4, -0.15]), 0.5, 0.18)


@pytest.fixture(scope="module")
def feet(body):
    spots = (Spot(np.array([0.0, -0.11]), -0.1), Spot(np.array([0.0, 0.11]), 0.1))
    footwork = Footwork(body, spots, np.random.default_rng(3))
    held = (1.2, 1.8, 0.05, 12.0)
    footwork.swings += [
        Swing(1, 0.8, 2.2, spots[1], 0.15, held=held, reload_s=0.1),
        Swing(0, 3.0, 3.6, STEP, 0.06),
        Swing(1, 3.9, 4.5, Spot(np.array([0.3, 0.1]), 0.6, 0.18), 0.06, unload_s=0.3),
    ]
    return footwork


def lifted(feet, side, times):
    """(T,) whether a foot is off the ground."""
    return np.any([(times >= s.lift_s) & (times <= s.land_s) for s in feet.swings if s.side == side], axis=0)


def test_a_lifted_foot_carries_exactly_nothing(feet):
    times = np.linspace(0, SECONDS, 6001)
    shares = feet.load(times).shares
    for side in range(2):
        air = lifted(feet, side, times)
        assert (shares[air, side] == 0.0).all()
        assert (shares[air, 1 - side] == 1.0).all()
    assert shares.min() >= 0
    assert np.abs(np.diff(shares[:, 0])).max() < 0.03
    assert abs(shares[-1, 0] - 0.5) < 0.05


def test_a_foot_does_not_linger_with_almost_no_load(feet):
    times = np.linspace(0, SECONDS, 6001)
    shares = feet.load(times).shares
    assert ((shares > 0) & (shares < 0.02)).any(axis=1).mean() * SECONDS < 6 * 0.06


def test_poses_are_smooth_and_carry_their_exact_rates(feet):
    times, h = np.linspace(0.001, SECONDS - 0.001, 2999), 1e-5
    late, early, now = (feet.poses(times + d) for d in (h, -h, 0.0))
    for side in SIDES:
        for name in ("ankle", "yaw", "pitch", "toes"):
            after, before, at = (getattr(pose[side], name) for pose in (late, early, now))
            assert np.abs((after.value - before.value) / (2 * h) - at.first).max() < 1e-5
            assert np.abs(after.first - before.first).max() < 3e-3
            assert np.abs(after.second - before.second).max() < 0.1


def test_a_loaded_foot_turns_about_its_ball_at_most(feet, body):
    times = np.linspace(0, SECONDS, 1201)
    for side, (name, pose) in enumerate(feet.poses(times).items()):
        outline = sole_outline(body, name)
        on = ~lifted(feet, side, times)
        flat = on & (pose.pitch.value == 0.0)
        assert flat.mean() > 0.3
        assert np.abs(pose.ankle.first[flat]).max() == 0.0
        height = feet.load(times).surfaces[:, side]
        assert np.abs(pose.ankle.value[flat, 2] + outline.height - height[flat]).max() < 1e-12
        assert pose.pitch.value[on].min() == 0.0
        assert (pose.ankle.value[on, 2] + outline.height - height[on]).min() > -1e-12


def test_a_held_foot_rests_in_the_air(feet):
    pose = feet.poses(np.linspace(1.2, 1.8, 61))["l"]
    assert np.ptp(pose.ankle.value, axis=0).max() < 1e-12
    ground = feet.poses(np.array([0.0]))["l"].ankle.value[0]
    assert pose.ankle.value[0, 2] - ground[2] == pytest.approx(0.15, abs=0.05)
    assert pose.ankle.value[0, 0] > ground[0]


def test_surfaces_change_only_in_the_air_and_the_foot_clears_the_higher_one(feet):
    times = np.linspace(0, SECONDS, 6001)
    surfaces = feet.load(times).surfaces
    for side in range(2):
        changes = times[1:][np.diff(surfaces[:, side]) != 0]
        assert len(changes) == 1
        assert lifted(feet, side, changes).all()
    assert feet.poses(np.linspace(3.0, 3.6, 61))["r"].ankle.value[:, 2].max() > STEP.surface_m + 0.1
    assert feet.spot(0) is STEP


def test_pressure_is_under_the_ball_when_the_heel_leaves(feet, body):
    swing = feet.swings[1]
    at = np.array([swing.lift_s - HEEL_OFF_S, swing.lift_s])
    ball = body.description.segment("right_toes").origin_m[0] * feet.size
    ahead = feet.load(at).pressure[:, 0] - feet.first[0].ankle_m
    forward = ahead @ [np.cos(feet.first[0].yaw), np.sin(feet.first[0].yaw)]
    assert forward[0] > 0.8 * ball
    assert forward[1] > 0.9 * ball


def test_nudges_move_load_and_pressure(body):
    spots = (Spot(np.array([0.0, -0.11]), 0.0), Spot(np.array([0.0, 0.11]), 0.0))
    at = np.array([1.0])
    plain, nudged = (Footwork(body, spots, np.random.default_rng(1)) for _ in range(2))
    none = sinusoid(0.0, 1.0, 0.0)
    nudged.nudges.append((path([(0.0, 0.0), (1.0, 0.2), (2.0, 0.0)]), sinusoid(0.0, 1.0, 0.0, 0.03), none))
    assert nudged.load(at).share - plain.load(at).share == pytest.approx(0.2)
    moved = nudged.load(at).pressure - plain.load(at).pressure
    assert moved[0] == pytest.approx(np.array([[0.03, 0.0], [0.03, 0.0]]))


def test_turns_are_told_with_their_times(feet):
    turns = feet.turned()
    assert [turn[:2] for turn in turns] == [(s.lift_s, s.land_s) for s in feet.swings]
    assert [turn[2] for turn in turns] == pytest.approx([0.0, 0.6, 0.5])
