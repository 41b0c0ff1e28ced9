"""Force plates: surfaces, areas, and the centre of pressure with its free moment as one force and one couple."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mbkf.sensors.contact.plates import (
    PlateAreas,
    centres_of_pressure,
    pressure_and_free_moment,
    surface_height,
)
from tests.dynamics import plate

PLATE = plate(0.0, 0.0)


def test_a_surface_lies_where_its_corners_are_and_without_them_at_the_origin():
    raised = replace(PLATE, corners_m=PLATE.corners_m + np.array([0.0, 0.0, 0.3]))
    assert surface_height(raised) == PLATE.corners_m[0, 2] + 0.3
    bare = replace(PLATE, corners_m=None, origin_m=np.array([0.0, 0.0, -0.04]))
    assert surface_height(bare) == -0.04


@given(st.integers(0, 10_000), st.floats(-0.2, 0.6))
def test_a_wrench_is_its_force_at_the_centre_of_pressure_and_its_free_moment(seed, surface_m):
    wrench = np.random.default_rng(seed).normal(scale=100.0, size=(4, 2, 6))
    wrench[..., 2] = np.abs(wrench[..., 2]) + 30.0
    point, free = pressure_and_free_moment(wrench, surface_m, 20.0)
    np.testing.assert_allclose(point[..., 2], surface_m)
    moment = np.cross(point, wrench[..., :3]) + free[..., None] * [0.0, 0.0, 1.0]
    np.testing.assert_allclose(moment, wrench[..., 3:], atol=1e-8)


def test_an_unloaded_foot_has_neither():
    point, free = pressure_and_free_moment(np.full((1, 2, 6), 19.0), 0.0, 20.0)
    assert np.isnan(point).all() and np.isnan(free).all()


def test_a_plate_is_loaded_from_its_threshold_and_never_without_a_force():
    wrench = np.array([[0.0, 0.0, fz, 0.0, 0.0, 0.0] for fz in (-30.0, 0.0, 19.9, 20.0)])
    loaded = ~np.isnan(centres_of_pressure(wrench, 0.0, 20.0)).any(axis=1)
    assert loaded.tolist() == [False, False, False, True]
    assert not np.isfinite(centres_of_pressure(wrench[:2], 0.0, 0.0)).any()


def test_points_are_over_the_plates_whose_outline_holds_them():
    corners = PLATE.corners_m
    middle = corners[:, :2].mean(axis=0)
    beside = middle + np.array([np.ptp(corners[:, 0]), 0.0])
    other_way = replace(PLATE, corners_m=corners[::-1])
    areas = PlateAreas([PLATE, other_way, replace(PLATE, corners_m=None)])
    assert areas.known.tolist() == [True, True, False]
    points = np.array([middle, beside, [np.nan] * 2, *(0.5 * (corners[:, :2] + middle))])
    over = areas.contain(points)
    assert over.tolist() == [[True, True, False], *([[False] * 3] * 2), *([[True, True, False]] * 4)]
    assert [[areas.over(k, x, y) for k in range(3)] for x, y in points.tolist()] == over.tolist()
