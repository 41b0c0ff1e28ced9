"""Loads given to feet: they add up to what the motion needs, and a motion in flight is corrected to fall freely."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.foreign.making.loads import (
    beyond_feet,
    feet_wrenches,
    motion_correction,
    pressure,
    projected_shares,
    shares,
)
from mbkf.conventions import Array

CONTACTS = np.array([[1, 0]] * 5 + [[1, 1]] * 9 + [[0, 1]] * 5 + [[0, 0]] * 3 + [[1, 0]] * 4, dtype=bool)


def standing(count: int) -> Array:
    """(T, 2, 3) feet at different heights."""
    return np.repeat(np.array([[[0.3, 0.1, 0.12], [0.0, 0.0, -0.1]]]), count, axis=0)


def loads(count: int) -> Array:
    """(T, 6) wrenches of a force that presses down."""
    rng = np.random.default_rng(3)
    force = np.column_stack(
        [rng.normal(0.0, 40.0, count), rng.uniform(300.0, 900.0, count), rng.normal(0.0, 20.0, count)]
    )
    return np.hstack([force, rng.normal(0.0, 60.0, (count, 3))])


def test_one_foot_bears_all_and_flight_bears_nothing() -> None:
    share = shares(CONTACTS)
    np.testing.assert_array_equal(share[:5], [[1.0, 0.0]] * 5)
    np.testing.assert_array_equal(share[14:19], [[0.0, 1.0]] * 5)
    np.testing.assert_array_equal(share[19:22], np.zeros((3, 2)))


def test_double_support_hands_over_smoothly() -> None:
    both = shares(CONTACTS)[5:14]
    np.testing.assert_allclose(both.sum(axis=1), 1.0)
    assert (np.diff(both[:, 0]) < 0.0).all()
    assert both[4, 0] == pytest.approx(0.5)
    assert 1.0 - both[0, 0] < 0.02


def test_feet_that_begin_together_share_alike_at_first() -> None:
    share = shares(np.array([[1, 1]] * 20 + [[1, 0]] * 3, dtype=bool))
    assert share[0, 0] == pytest.approx(0.5, abs=0.01)
    assert share[19, 0] > 0.98


def test_wrenches_of_feet_add_up() -> None:
    total, points = loads(len(CONTACTS)), standing(len(CONTACTS))
    share = shares(CONTACTS)
    found = feet_wrenches(total, share, points)
    loaded = CONTACTS.any(axis=1)
    np.testing.assert_allclose(found.sum(axis=1)[loaded], total[loaded], atol=1e-9)
    np.testing.assert_array_equal(found[~loaded], 0.0)


def test_hardly_loaded_feet_add_up_too() -> None:
    total, points = loads(4), standing(4)
    total[:, 1] = 5.0
    found = feet_wrenches(total, np.full((4, 2), 0.5), points)
    np.testing.assert_allclose(found.sum(axis=1), total, atol=1e-9)


def test_each_foot_presses_where_its_moment_says() -> None:
    total, points = loads(6), standing(6)
    found = feet_wrenches(total, np.full((6, 2), 0.5), points)
    shifts = []
    for foot in (0, 1):
        x, z = pressure(found[:, foot], points[:, foot, 1])
        shifts.append(np.column_stack([x, z]) - points[:, foot][:, [0, 2]])
    np.testing.assert_allclose(shifts[0], shifts[1], atol=1e-9)


def test_balanced_feet_share_by_pressure() -> None:
    points = np.repeat(np.array([[[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]]]), 3, axis=0)
    force = np.array([0.0, 800.0, 0.0])
    aims = np.array([[0.0, 0.0, 0.05], [0.0, 0.0, 0.0], [0.0, 0.0, -0.3]])
    total = np.hstack([np.repeat(force[None], 3, axis=0), np.cross(aims, force)])
    np.testing.assert_allclose(projected_shares(total, points)[:, 0], [0.75, 0.5, 0.02])


def test_pressure_below_the_feet_is_left_alone() -> None:
    points = np.zeros((2, 2, 3))
    force = np.array([0.0, 800.0, 0.0])
    aims = np.array([[0.05, 0.0, 0.02], [0.17, 0.0, 0.0]])
    total = np.hstack([np.repeat(force[None], 2, axis=0), np.cross(aims, force)])
    wrong = beyond_feet(total, np.full((2, 2), 0.5), points)
    np.testing.assert_allclose(wrong[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(wrong[1], np.cross([0.10, 0.0, 0.0], force), atol=1e-9)


def test_corrected_flight_falls_freely() -> None:
    dt, t = 0.01, np.arange(120) * 0.01
    wrong = np.column_stack([np.sin(9.0 * t), 2.0 * np.cos(5.0 * t), 0.5 + 0.0 * t])
    flight = (t > 0.3) & (t < 0.45) | (t > 0.8) & (t < 0.95)
    place = np.zeros((120, 3))
    for _ in range(12):
        left = wrong.copy()
        left[1:-1] += np.diff(place, n=2, axis=0) / dt**2
        place = place + 0.7 * motion_correction(left, flight.astype(float), dt)
    left = wrong[1:-1] + np.diff(place, n=2, axis=0) / dt**2
    assert np.abs(left[flight[1:-1]]).max() < 0.05
    assert np.abs(place).max() < 0.05
