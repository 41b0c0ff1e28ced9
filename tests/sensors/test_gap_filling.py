"""Markers in gaps: on the body, and as far off it as the skin was around the gap."""

import numpy as np
import pytest

from mbkf.sensors.gap_filling import SKIN_MEMORY_S, filled
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
RATE_HZ, FRAMES = 100.0, 60
Q, _, _ = smooth_motion(MODEL, np.random.default_rng(5)).frames(FRAMES, RATE_HZ)
ON_BODY = marker_positions(SENSOR, Q)
MARKER, GAP = 7, slice(20, 40)


def offset_in_world(local):
    """(T, 3) a constant offset in the axes of the marker's segment."""
    joint = SENSOR.joint_ids[MARKER]
    return np.array([MODEL.placements(q)[0][joint] @ local for q in Q])


def shown(local, gap=GAP):
    measured = ON_BODY.copy()
    measured[:, MARKER] += offset_in_world(local)
    hidden = measured.copy()
    hidden[gap, MARKER] = np.nan
    return measured, hidden


def test_seen_markers_are_those_of_the_body():
    on_body, with_skin = filled(SENSOR, Q, ON_BODY, 1 / RATE_HZ, both_sides=True)
    np.testing.assert_allclose(on_body, ON_BODY, atol=1e-12)
    np.testing.assert_allclose(with_skin, ON_BODY, atol=1e-12)


def test_an_offset_fades_after_the_last_sight():
    local = np.array([0.01, -0.02, 0.005])
    measured, hidden = shown(local)
    _, with_skin = filled(SENSOR, Q, hidden, 1 / RATE_HZ, both_sides=False)
    fading = np.exp(-np.arange(1, 21) / RATE_HZ / SKIN_MEMORY_S)
    wanted = ON_BODY[GAP, MARKER] + fading[:, None] * (measured - ON_BODY)[GAP, MARKER]
    np.testing.assert_allclose(with_skin[GAP, MARKER], wanted, atol=1e-12)


def test_a_bridge_meets_both_ends_and_sags_between():
    """Mean of an Ornstein–Uhlenbeck process between two equal ends: cosh about the middle."""
    local = np.array([0.0, 0.03, 0.0])
    _, hidden = shown(local)
    _, with_skin = filled(SENSOR, Q, hidden, 1 / RATE_HZ, both_sides=True)
    size = np.linalg.norm((with_skin - ON_BODY)[GAP, MARKER], axis=1)
    from_middle = (np.arange(20) - 9.5) / RATE_HZ / SKIN_MEMORY_S
    half = 10.5 / RATE_HZ / SKIN_MEMORY_S
    np.testing.assert_allclose(size, 0.03 * np.cosh(from_middle) / np.cosh(half), rtol=1e-9)


@pytest.mark.parametrize("both_sides", [False, True])
def test_a_marker_never_seen_stays_on_the_body(both_sides):
    _, hidden = shown(np.zeros(3), gap=slice(None))
    _, with_skin = filled(SENSOR, Q, hidden, 1 / RATE_HZ, both_sides)
    np.testing.assert_allclose(with_skin, ON_BODY, atol=1e-12)


def test_frames_not_followed_are_nan():
    lost = Q.copy()
    lost[5:8] = np.nan
    on_body, with_skin = filled(SENSOR, lost, ON_BODY, 1 / RATE_HZ, both_sides=True)
    assert np.isnan(on_body[5:8]).all() and np.isnan(with_skin[5:8]).all()
    assert np.isfinite(with_skin[8:]).all()
