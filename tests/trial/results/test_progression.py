"""The frame of progression: along paths, with the body where there is none, and turned with the capture."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.model.clinical import ClinicalAngles
from mbkf.synthesis.motion import synthesise_motion
from mbkf.trial.results.progression import (
    HEADING,
    LABORATORY,
    PATH,
    frame_of,
    kind_of,
    laboratory,
    progression_of,
)
from tests.recordings import walker

TIMES = np.arange(400) / 100.0
HEIGHT_M = 0.9
LEFT = np.array([0.0, 1.0])


def along(angles):
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def walk_along(angles, speed_m_s=1.2, sway_m=0.03):
    """(T, 2) path with its tangent at these angles (T,), and the sway of a pelvis with each stride."""
    tangent = along(np.broadcast_to(angles, TIMES.shape))
    path = np.cumsum(speed_m_s * tangent, axis=0) * 0.01
    return path + sway_m * np.sin(2 * np.pi * 0.9 * TIMES)[:, None] * tangent[:, ::-1] * [-1.0, 1.0]


def facing_along(angles, swing_deg=8.0):
    """(T, 2) vectors of a body that faces these angles (T,) and rotates with each stride."""
    return 2.0 * along(angles + np.deg2rad(swing_deg) * np.sin(2 * np.pi * 0.9 * TIMES))


def turned(vectors, angle):
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def apart(one, other):
    """Largest angle between headings, rad."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(one) - other)))).max()


BEND = np.deg2rad(90.0) / (1.0 + np.exp(-4.0 * (TIMES - 2.0)))

MOTIONS = {
    "straight": (walk_along(0.3), facing_along(0.3)),
    "bend": (walk_along(BEND), facing_along(BEND)),
    "stands": (0.01 * along(3.0 * TIMES), facing_along(0.6)),
    "spins": (0.01 * along(3.0 * TIMES), facing_along(1.5 * TIMES)),
    "backwards": (walk_along(0.3), facing_along(0.3 + np.pi)),
    "sideways": (walk_along(0.3), facing_along(0.3 - np.pi / 2)),
}
KINDS = {
    "straight": (PATH, "straight path"),
    "bend": (PATH, "turning path"),
    "stands": (HEADING, "mean heading"),
    "spins": (HEADING, "turning heading"),
    "backwards": (HEADING, "mean heading"),
    "sideways": (HEADING, "mean heading"),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_what_the_frame_follows(name):
    found = frame_of(*MOTIONS[name], TIMES, HEIGHT_M)
    assert (found.direction, kind_of(found.direction, found.heading_rad)) == KINDS[name]
    assert found.heading_rad.shape == found.turning_rad_s.shape == TIMES.shape


@pytest.mark.parametrize(
    "name, heading",
    [("straight", 0.3), ("stands", 0.6), ("backwards", 0.3 + np.pi), ("sideways", 0.3 - np.pi / 2)],
)
def test_a_steady_heading_is_that_of_the_path_or_the_body(name, heading):
    found = frame_of(*MOTIONS[name], TIMES, HEIGHT_M)
    assert apart(found.heading_rad, heading) < np.deg2rad(1.5)
    assert not found.turning_rad_s.any()


def test_round_a_bend_the_heading_is_the_tangent_and_its_rate_the_slope():
    found = frame_of(*MOTIONS["bend"], TIMES, HEIGHT_M)
    inside = slice(100, 300)
    assert apart(found.heading_rad[inside], BEND[inside]) < np.deg2rad(8.0), (
        "smoothed over a quarter of a stride"
    )
    assert apart(found.heading_rad, BEND) < np.deg2rad(8.0), "at the ends, too"
    slope = np.diff(found.heading_rad) / 0.01
    np.testing.assert_allclose(0.5 * (slope[1:] + slope[:-1]), found.turning_rad_s[1:-1], atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(sorted(MOTIONS)), st.floats(-7.0, 7.0), st.floats(-5.0, 5.0))
def test_a_turned_path_has_its_heading_turned_along(name, angle, away_m):
    path, facing = MOTIONS[name]
    one = frame_of(path, facing, TIMES, HEIGHT_M)
    other = frame_of(turned(path, angle) + away_m * LEFT, turned(facing, angle), TIMES, HEIGHT_M)
    assert other.direction == one.direction
    assert apart(other.heading_rad, one.heading_rad + angle) < 1e-9
    np.testing.assert_allclose(other.turning_rad_s, one.turning_rad_s, rtol=0, atol=1e-7)


@pytest.mark.parametrize(
    "speed_m_s, stride_hz, sway_m",
    [(0.25, 0.35, 0.04), (0.35, 0.35, 0.06), (0.5, 0.5, 0.06), (1.2, 0.9, 0.04)],
)
@pytest.mark.parametrize("phase", [0.0, 1.6, 3.1])
def test_the_sway_of_slow_gait_is_no_turn(speed_m_s, stride_hz, sway_m, phase):
    times = np.arange(700) / 100.0
    path = np.stack([speed_m_s * times, sway_m * np.sin(2 * np.pi * stride_hz * times + phase)], axis=1)
    found = frame_of(path, np.tile([2.0, 0.0], (700, 1)), times, HEIGHT_M)
    assert kind_of(found.direction, found.heading_rad) == "straight path"
    assert apart(found.heading_rad, 0.0) < np.deg2rad(4.0)


def test_on_a_treadmill_the_body_tells():
    path = walk_along(0.3) - 1.2 * TIMES[:, None] * along(np.array(0.3))
    found = frame_of(path, facing_along(0.3), TIMES, HEIGHT_M)
    assert found.direction == HEADING
    assert apart(found.heading_rad, 0.3) < np.deg2rad(1.5)


@pytest.mark.parametrize("motion, kind", [("turn", "turning heading"), ("reach", "mean heading")])
def test_small_steps_round_turn_and_reaching_does_not(motion, kind):
    """A turn on the spot is the frame's, not the pelvis's rotation."""
    model = walker()[1]
    made = synthesise_motion(model, motion, 4.5, seed=3)
    found = progression_of(model, made.q, made.times_s)
    assert kind_of(found.direction, found.heading_rad) == kind
    clinical = ClinicalAngles(model)
    ranges = np.ptp(clinical.angles(clinical.against(found.heading_rad, made.q)), axis=0)
    assert np.rad2deg(ranges[clinical.names.index("pelvis_rotation")]) < 20.0


def test_a_lunge_is_no_walk():
    reach = 0.25 * (1.0 - np.cos(2 * np.pi * TIMES / 2.0))
    path = reach[:, None] * along(np.array(1.0))
    assert frame_of(path, facing_along(1.0), TIMES, HEIGHT_M).direction == HEADING


def test_who_stops_keeps_a_heading():
    """The path of somebody who stands still has no direction; the body's takes its place."""
    walks = np.where(TIMES < 2.0, 1.2, 0.0)
    path = np.cumsum(walks[:, None] * along(BEND), axis=0) * 0.01
    found = frame_of(path, facing_along(2.0 * BEND), TIMES, HEIGHT_M)
    assert np.isfinite(found.heading_rad).all()
    assert np.abs(np.diff(found.heading_rad)).max() < np.deg2rad(3.0)


def test_frames_without_the_body_are_bridged():
    path, facing = (np.array(values) for values in MOTIONS["bend"])
    path[150:170], facing[390:] = np.nan, np.nan
    found = frame_of(path, facing, TIMES, HEIGHT_M)
    whole = frame_of(*MOTIONS["bend"], TIMES, HEIGHT_M)
    assert apart(found.heading_rad, whole.heading_rad) < np.deg2rad(6.0), "the sway where less is known"


@pytest.mark.parametrize("frames", [0, 1, 2])
def test_short_and_empty_trials(frames):
    path, facing = (values[:frames] for values in MOTIONS["straight"])
    found = frame_of(path, facing, TIMES[:frames], HEIGHT_M)
    assert found.direction == HEADING
    assert len(found.heading_rad) == frames and np.isfinite(found.heading_rad).all()
    nothing = frame_of(np.full((5, 2), np.nan), np.full((5, 2), np.nan), TIMES[:5], HEIGHT_M)
    assert (nothing.direction, nothing.heading_rad.tolist()) == (HEADING, [0.0] * 5)


def test_a_body_that_walks_along_x_heads_there():
    _, model, motion = walker()
    found = progression_of(model, motion.q, motion.times_s)
    assert found.direction == PATH
    assert apart(found.heading_rad, 0.0) < np.deg2rad(1.0)
    still = motion.q.copy()
    still[:, :2] = 0.0
    assert progression_of(model, still, motion.times_s).direction == HEADING


def test_the_laboratory_is_a_frame_too():
    found = laboratory(4)
    assert kind_of(found.direction, found.heading_rad) == LABORATORY
    assert not found.heading_rad.any() and len(found.heading_rad) == 4
