"""Bodies among points by the distances that they keep."""

import numpy as np
import pytest

from mbkf.io.bodies import bodies_of, nearest_body
from tests.io.test_persons import figure


def test_points_that_keep_together_are_a_body_whatever_their_order():
    places = np.concatenate([figure(seed, [0, y, 0]) for seed, y in ((1, 0.0), (2, 0.9), (3, -1.1))], axis=1)
    order = np.random.default_rng(0).permutation(36)
    found = bodies_of(places[:, order])
    owners = sorted(tuple(sorted(order[body] // 12)) for body in found)
    assert owners == [(k,) * 12 for k in range(3)]
    assert [int(body[0]) for body in found] == sorted(int(body[0]) for body in found)


def test_a_point_that_is_rarely_seen_belongs_to_the_nearest_body():
    places = np.concatenate([figure(1, [0, 0, 0]), figure(2, [0, 1.2, 0])], axis=1)
    places[5:, 3] = np.nan
    assert [list(body) for body in bodies_of(places)] == [list(range(12)), list(range(12, 24))]
    assert nearest_body(places, 3, [np.arange(4, 12), np.arange(12, 24)]) == 0


@pytest.mark.parametrize("apart_m", [0.0, 0.3])
def test_parts_of_one_body_are_not_cut(apart_m):
    places = np.concatenate([figure(1, [0, 0, 0]), figure(1, [0, apart_m, 0.01])], axis=1)
    assert [len(body) for body in bodies_of(places)] == [24]


def test_upper_and_lower_half_are_one_person():
    """Their middles lie far apart, and neither extends across that line."""
    places = np.concatenate(
        [figure(1, [0, 0, 0]) * [1, 1, 0.1], figure(2, [0, 0, 1.0]) * [1, 1, 0.1]], axis=1
    )
    places[:, 12:, 2] += 0.9
    assert [len(body) for body in bodies_of(places * [1, 0.5, 1])] == [24]


@pytest.mark.parametrize(("gone", "bodies"), [(40, [12, 12]), (34, [12, 12]), (28, [24])])
def test_a_person_who_comes_later_is_a_body(gone, bodies):
    """Points that replace those before, as tracks of one person do, are not: both are seen in a fifth of the frames."""
    places = np.concatenate([figure(1, [0, 0, 0]), figure(2, [0, 1.0, 0])], axis=1)
    places[:20, 12:] = np.nan
    places[gone:, :12] = np.nan
    assert [len(body) for body in bodies_of(places)] == bodies


def test_without_a_frame_all_columns_are_one_body():
    assert [len(body) for body in bodies_of(np.full((5, 24, 3), np.nan))] == [24]
