"""Joints hold headings: a drifting sensor is brought back, a common turn is left alone."""

import numpy as np
import pytest

from mbkf.imu.frames import conjugate, exponential, multiply
from mbkf.imu.heading import HeadingSettings, held_headings, turned
from mbkf.model.body_file import load_body

SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot")
DT = 0.05
JOINTS = load_body().clinical_joints


def walking(count=1200):
    """Legs that swing about the side axis while the person turns about slowly."""
    t = np.arange(count) * DT
    course = np.empty((count, 4, 4))
    for k, size in enumerate((0.05, 0.4, 0.6, 0.7)):
        swing = np.zeros((count, 3))
        swing[:, 1] = size * np.sin(2 * np.pi * 0.9 * t - k)
        course[:, k] = exponential(swing)
    return turned(course, np.tile((0.1 * t)[:, None], (1, 4)))


def test_a_drifting_shank_is_brought_back():
    true = walking()
    drift = np.zeros((len(true), 4))
    drift[:, 2] = 0.002 * np.arange(len(true)) * DT + 0.1
    found = held_headings(SEGMENTS, turned(true, drift), DT, JOINTS)
    np.testing.assert_allclose(found[100:, 2], -drift[100:, 2], atol=0.04)
    np.testing.assert_allclose(found[:, [1, 3]], 0.0, atol=0.06)
    np.testing.assert_array_equal(found[:, 0], 0.0)


@pytest.mark.parametrize("k", range(4))
@pytest.mark.parametrize("off", [-2.5, 1.0])
def test_an_arbitrary_heading_is_found_by_the_joints(k, off):
    """Also the first segment's, against which the others are then told."""
    true = walking()
    away = np.zeros((len(true), 4))
    away[:, k] = off
    found = turned(
        turned(true, away), held_headings(SEGMENTS, turned(true, away), DT, JOINTS, arbitrary=(k,))
    )
    apart = multiply(found[200:], conjugate(true[200:]))
    headings = 2.0 * np.arctan2(apart[..., 2], apart[..., 3])
    relative = np.angle(np.exp(1j * (headings - headings[:, [0]])))
    np.testing.assert_allclose(relative, 0.0, atol=0.06)


def test_sound_headings_and_turning_round_are_left_alone():
    true = walking()
    np.testing.assert_allclose(held_headings(SEGMENTS, true, DT, JOINTS), 0.0, atol=1e-3)
    whole = turned(true, np.full((len(true), 4), 2.0))
    np.testing.assert_allclose(held_headings(SEGMENTS, whole, DT, JOINTS), 0.0, atol=1e-3)


def test_a_toe_out_that_lasts_is_not_wholly_taken_away_when_joints_are_loose():
    true = walking()
    out = np.zeros((len(true), 4))
    out[:, 3] = 0.1
    tight = held_headings(SEGMENTS, turned(true, out), DT, JOINTS)
    loose = held_headings(SEGMENTS, turned(true, out), DT, JOINTS, HeadingSettings(spread_scale=30.0))
    assert abs(loose[600, 3]) < 0.5 * abs(tight[600, 3])


def test_turning_is_about_the_vertical():
    q = walking(3)
    heading = np.full((3, 4), 0.3)
    expected = multiply(exponential(np.array([0.0, 0.0, 0.3])), q)
    np.testing.assert_allclose(turned(q, heading), expected, atol=1e-12)
