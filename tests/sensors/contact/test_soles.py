"""Soles of the body in the world, and their distance from points of the floor."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from mbkf.sensors.contact.rules import NEITHER, nearer_foot
from mbkf.sensors.contact.soles import (
    distance_to_sole,
    distances_to_soles,
    share_along,
    sole_points,
)
from tests.dynamics import standing
from tests.motions import assert_near, moderate_pose, random_model, reference_model

MODEL = reference_model()
SOLES = sole_points(MODEL, standing(MODEL)[None])[0]
RIGHT, LEFT = 0, 1
metres = st.floats(-1.0, 1.0)


def test_soles_lie_under_the_feet_and_mirror():
    heel, ball_of_foot, toe = sole_points(MODEL, standing(MODEL)[None])[0].swapaxes(0, 1)
    assert_near(np.stack([heel, ball_of_foot, toe])[:, :, 2], 0.0, 1e-15)
    assert (heel[:, 0] < ball_of_foot[:, 0]).all()
    assert (ball_of_foot[:, 0] < toe[:, 0]).all()
    for points in (heel, ball_of_foot, toe):
        assert points[0, 1] < 0
        assert_near(points[1], points[0] * [1, -1, 1], 1e-15)


def test_soles_scale_and_move_with_the_foot():
    rng = np.random.default_rng(1)
    model = random_model(rng)
    q = moderate_pose(model, rng)
    points = sole_points(model, np.stack([q, np.full(model.nq, np.nan)]))
    assert np.isnan(points[1]).all()
    sole = model.description.sole
    for side, foot in enumerate(("right_foot", "left_foot")):
        along = model.axis_scale(model.description.segment(foot))[0] * (sole.toe_x_m - sole.heel_x_m)
        assert np.linalg.norm(points[0, side, 2] - points[0, side, 0]) == pytest.approx(along, rel=1e-12)


@given(metres, metres, st.sampled_from([RIGHT, LEFT]))
def test_the_distance_is_that_of_the_nearest_point_between_heel_and_toe_end(x, y, side):
    heel, _, end = SOLES[side, :, :2]
    found = minimize_scalar(
        lambda s: ((heel + s * (end - heel) - [x, y]) ** 2).sum(),
        bounds=(0.0, 1.0),
        method="bounded",
        options={"xatol": 1e-10},
    )
    assert distance_to_sole(x, y, SOLES[side].tolist()) == pytest.approx(found.fun**0.5, abs=1e-6, rel=0.0)


@given(st.floats(-1.0, 2.0), metres)
def test_the_share_along_a_sole_does_not_depend_on_the_distance_from_it(share, aside):
    heel, _, end = SOLES[RIGHT, :, :2]
    x, y = heel + share * (end - heel) + aside * np.array([heel[1] - end[1], end[0] - heel[0]])
    assert share_along(x, y, SOLES[RIGHT].tolist()) == pytest.approx(share, abs=1e-9)


def test_distances_are_known_where_point_and_soles_are():
    points, soles = np.zeros((3, 3)), np.repeat(SOLES[None], 3, axis=0)
    points[1], soles[2] = np.nan, np.nan
    found = distances_to_soles(points, soles)
    assert np.isnan(found[1:]).all()
    assert found[0].tolist() == [distance_to_sole(0.0, 0.0, sole) for sole in SOLES.tolist()]


def test_no_pressure_belongs_to_soles_so_far_away_that_they_have_no_length():
    lost = np.full((1, 2, 3, 3), 1e21)
    away = distances_to_soles(np.zeros((1, 3)), lost)[0]
    assert np.isnan(away).all()
    assert nearer_foot(away.tolist(), RIGHT) == NEITHER
