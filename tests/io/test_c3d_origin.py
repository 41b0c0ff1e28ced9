"""ORIGIN of either sign gives the vector from the transducers to the surface; where nothing tells, it stays."""

import numpy as np
import pytest

from mbkf.io.c3d_origin import (
    DEEPEST_M,
    LEAST_LOADED,
    pressed_m,
    share_on_plate,
    turned_by_depth,
    turned_by_pressure,
)

HALF_M = np.array([0.25, 0.8])
BESIDE = np.array([0.24, -0.81, 0.0])


@pytest.mark.parametrize("stored", [[0.003, -0.002, -0.04], [0.3, 0.2, 0.0], [0.3, 0.2, -0.0]])
def test_transducers_below_the_surface_stay_where_they_are(stored):
    notes = []
    np.testing.assert_array_equal(turned_by_depth(np.array(stored), "plate", notes), stored)
    assert notes == []


def test_transducers_above_the_surface_are_taken_below():
    notes = []
    stored = np.array([0.003, -0.002, 0.0405])
    np.testing.assert_array_equal(turned_by_depth(stored, "force plate 2", notes), -stored)
    assert notes == [
        "force plate 2: ORIGIN puts its transducers 40.5 mm above the surface; it is taken with the opposite sign"
    ]


def test_a_wrong_sign_of_the_depth_moves_the_pressure_by_twice_depth_times_shear():
    force, vector = np.array([[80.0, -30.0, -700.0]]), np.array([0.0, 0.0, -0.04])
    right, wrong = (pressed_m(force, np.cross(force, sign * vector)) for sign in (1.0, -1.0))
    np.testing.assert_allclose(np.abs(wrong - right), 2.0 * 0.04 * np.abs(force[:, :2]) / 700.0, rtol=1e-12)


def test_a_plate_as_thick_as_a_table_is_told():
    notes = []
    turned_by_depth(np.array([0.0, 0.0, -1.01 * DEEPEST_M]), "plate", notes)
    assert ["check its unit" in note for note in notes] == [True]


def loads(samples=50):
    rng = np.random.default_rng(1)
    force = np.array([0.0, 0.0, -700.0]) + rng.normal(0.0, 40.0, (samples, 3))
    place = np.column_stack([rng.uniform(-1.0, 1.0, (samples, 2)) * 0.9 * HALF_M, np.zeros(samples)])
    return force, np.cross(place, force), place


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_treadmill_is_pressed_on_itself_whatever_sign_is_stored(sign):
    force, moment, place = loads()
    about_o, notes = moment - np.cross(force, BESIDE), []
    found = turned_by_pressure(sign * BESIDE, force, about_o, HALF_M, "plate", notes)
    np.testing.assert_array_equal(found, BESIDE)
    np.testing.assert_allclose(pressed_m(force, about_o + np.cross(force, found)), place[:, :2], atol=1e-12)
    assert len(notes) == (sign < 0.0)


def test_where_loads_do_not_tell_it_stays():
    force, moment, _ = loads(LEAST_LOADED - 1)
    few = moment - np.cross(force, BESIDE)
    np.testing.assert_array_equal(turned_by_pressure(-BESIDE, force, few, HALF_M, "plate", []), -BESIDE)
    force, moment, _ = loads()
    small, notes = np.array([0.03, 0.04, -0.05]), []
    assert turned_by_pressure(small, force, moment + 1e6, HALF_M, "plate", notes) is small
    neither = turned_by_pressure(BESIDE, force, moment + 1e6, HALF_M, "plate", notes)
    np.testing.assert_array_equal(neither, BESIDE)
    assert notes == []


def test_share_on_plate_counts_both_directions():
    force = np.tile([0.0, 0.0, -100.0], (4, 1))
    place = np.array([[0.0, 0.0, 0.0], [0.29, 0.84, 0.0], [0.31, 0.0, 0.0], [0.0, 0.86, 0.0]])
    assert share_on_plate(force, np.cross(place, force), HALF_M) == 0.5
