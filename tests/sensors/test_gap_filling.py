"""Markers in gaps: on the body, and as far off it as a smooth process that a segment's markers share expects."""

import numpy as np
import pytest

from mbkf.sensors.gap_filling import SIGHT_VARIANCE, SIGHTS, STRANGE_M, correlation, filled, shared_covariance
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
RATE_HZ, FRAMES = 100.0, 60
Q, _, _ = smooth_motion(MODEL, np.random.default_rng(5)).frames(FRAMES, RATE_HZ)
ON_BODY = marker_positions(SENSOR, Q)
GAP = slice(20, 40)
JOINT = int(np.bincount(SENSOR.joint_ids).argmax())
MEMBERS = np.flatnonzero(SENSOR.joint_ids == JOINT)
LOST = MEMBERS[0]
ROTATIONS = np.array([MODEL.placements(q)[0] for q in Q])


def measured(local_m):
    """(T, M, 3) markers with offsets (T, M, 3) in their segments' axes."""
    return ON_BODY + np.einsum("tmij,tmj->tmi", ROTATIONS[:, SENSOR.joint_ids], local_m)


def without(positions_m, *lost):
    shown = positions_m.copy()
    for marker in lost or (LOST,):
        shown[GAP, marker] = np.nan
    return shown


def expected(shown_m, both_sides):
    """(T, M, 3) estimated offsets in the segments' axes."""
    on_body, with_skin = filled(SENSOR, Q, shown_m, 1 / RATE_HZ, both_sides)
    return np.einsum("tmji,tmj->tmi", ROTATIONS[:, SENSOR.joint_ids], with_skin - on_body)


def offsets(seed=2):
    return 0.01 * np.random.default_rng(seed).normal(size=ON_BODY.shape)


def test_seen_markers_are_those_of_the_body():
    on_body, with_skin = filled(SENSOR, Q, measured(offsets()), 1 / RATE_HZ, both_sides=True)
    np.testing.assert_allclose(on_body, ON_BODY, atol=1e-12)
    np.testing.assert_allclose(with_skin, ON_BODY, atol=1e-12)


def test_after_a_single_sight_an_offset_fades_as_its_correlation():
    alone = MarkerSensor(MODEL, [SENSOR.segments[LOST]], SENSOR.local_m[[LOST]])
    shown = np.full((FRAMES, 1, 3), np.nan)
    away = np.array([0.01, -0.02, 0.005])
    shown[3, 0] = ON_BODY[3, LOST] + ROTATIONS[3, JOINT] @ away
    on_body, with_skin = filled(alone, Q, shown, 1 / RATE_HZ, both_sides=False)
    found = np.einsum("tji,tj->ti", ROTATIONS[:, JOINT], (with_skin - on_body)[:, 0])
    fading = correlation(np.arange(1, FRAMES - 3) / RATE_HZ) / (1.0 + SIGHT_VARIANCE)
    np.testing.assert_allclose(found[4:], fading[:, None] * away, atol=1e-12)
    np.testing.assert_allclose(found[:3], 0.0, atol=1e-12)


@pytest.mark.parametrize("both_sides", [False, True])
def test_the_estimate_is_the_mean_of_the_shared_process(both_sides):
    """Against the whole Gaussian: sights of all markers, and the others at the frame itself."""
    local = offsets()
    sights = np.r_[GAP.start - SIGHTS : GAP.start, GAP.stop : GAP.stop + SIGHTS * both_sides]
    shared = shared_covariance(SENSOR.local_m[MEMBERS]).reshape(3 * len(MEMBERS), -1)
    found = expected(without(measured(local)), both_sides)
    for frame in (GAP.start, GAP.start + 7, GAP.stop - 1):
        at = np.r_[sights, frame]
        time = correlation((at[:, None] - at) / RATE_HZ) + SIGHT_VARIANCE * np.diag(at != frame)
        whole = np.kron(time, shared)
        values = local[np.ix_(at, MEMBERS)].ravel()
        unknown = np.zeros(len(values), dtype=bool)
        unknown[len(sights) * len(shared) :][:3] = True
        among = np.linalg.solve(whole[np.ix_(~unknown, ~unknown)], values[~unknown])
        np.testing.assert_allclose(found[frame, LOST], whole[np.ix_(unknown, ~unknown)] @ among, atol=1e-10)


def test_skin_that_slides_smoothly_is_followed_better_from_both_sides():
    local = np.zeros_like(ON_BODY)
    local[:, LOST, 1] = 0.02 * np.sin(2 * np.pi * 1.5 * np.arange(FRAMES) / RATE_HZ)
    shown = without(measured(local))
    causal, both = (np.abs(expected(shown, both) - local)[GAP, LOST].max() for both in (False, True))
    assert both < 0.003 < 0.25 * causal


def test_what_displaces_the_others_displaces_the_lost_one():
    """A wrong pose shifts every marker of a segment alike; n - 1 of them tell (n - 1) / n of the shift."""
    shift = np.array([0.0, 0.02, 0.0])
    square = MarkerSensor(
        MODEL, [SENSOR.segments[LOST]] * 4, 0.05 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    )
    on_body = marker_positions(square, Q)
    shown = on_body.copy()
    shown[GAP] += np.einsum("tij,j->ti", ROTATIONS[GAP, JOINT], shift)[:, None]
    shown[GAP, 0] = np.nan
    _, with_skin = filled(square, Q, shown, 1 / RATE_HZ, both_sides=True)
    found = np.einsum("tji,tj->ti", ROTATIONS[:, JOINT], with_skin[:, 0] - on_body[:, 0])[GAP]
    assert (found[:, 1] > 0.5 * 0.02).all() and (found[:, 1] < 0.02).all()
    np.testing.assert_allclose(found[:, 2], 0.0, atol=1e-12)


def test_a_marker_that_was_put_elsewhere_tells_nothing():
    local = np.zeros_like(ON_BODY)
    local[:, LOST, 0] = 0.01
    wanted = expected(without(measured(local), LOST, MEMBERS[1]), True)
    local[GAP, MEMBERS[1]] = 1.1 * STRANGE_M
    np.testing.assert_allclose(expected(without(measured(local)), True)[:, LOST], wanted[:, LOST], atol=1e-12)


def test_a_causal_estimate_uses_no_later_sight():
    local = offsets()
    later = local.copy()
    later[GAP.stop :] = offsets(9)[GAP.stop :]
    found, again = (expected(without(measured(one)), False)[GAP, LOST] for one in (local, later))
    np.testing.assert_allclose(found, again, atol=1e-12)


@pytest.mark.parametrize("both_sides", [False, True])
def test_a_marker_never_seen_stays_on_the_body(both_sides):
    shown = measured(offsets())
    shown[:, LOST] = np.nan
    _, with_skin = filled(SENSOR, Q, shown, 1 / RATE_HZ, both_sides)
    np.testing.assert_allclose(with_skin[:, LOST], ON_BODY[:, LOST], atol=1e-12)


def test_frames_not_followed_are_nan():
    lost = Q.copy()
    lost[5:8] = np.nan
    on_body, with_skin = filled(SENSOR, lost, ON_BODY, 1 / RATE_HZ, both_sides=True)
    assert np.isnan(on_body[5:8]).all() and np.isnan(with_skin[5:8]).all()
    assert np.isfinite(with_skin[8:]).all()
