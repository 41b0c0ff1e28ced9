"""Two feet in one frame."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.imu.feet import placements


def turned(points, angle):
    return points @ Rotation.from_euler("z", angle).as_matrix().T


def test_one_foot_walks_along_x_from_the_origin():
    walk = foot_walk(heading_rad=2.0)
    path = walk.position_m + np.array([3.0, -1.0, 0.5])
    (place,) = placements([walk.readings.time_s], [path], [path[-1] - path[0]])
    found = place.of_points(path)
    assert found[0] == pytest.approx([0.0, 0.0, 0.0])
    assert found[-1] == pytest.approx([walk.lengths_m.sum(), 0.0, 0.0])


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.0])
def test_a_path_turned_and_shifted_is_brought_back_upon_itself(angle):
    """A path with a corner, so that its heading is determined."""
    t = np.linspace(0.0, 10.0, 500)
    path = np.stack([np.minimum(t, 5.0), np.maximum(t - 5.0, 0.0), 0.1 * np.sin(t)], axis=1)
    other = turned(path, angle) + np.array([2.0, 3.0, 4.0])
    way = np.array([1.0, 0.0, 0.0])
    places = placements([t, t], [path, other], [way, turned(way, angle)])
    one, two = (place.of_points(x) for place, x in zip(places, (path, other), strict=True))
    assert np.allclose(one, two, atol=1e-9)


def test_unequal_clocks_and_unknown_beginnings_are_allowed():
    t, s = np.linspace(0.0, 10.0, 500), np.linspace(1.0, 9.0, 300)
    path = np.stack([t, 0.2 * t**2, 0.0 * t], axis=1)
    other = turned(np.stack([s, 0.2 * s**2, 0.0 * s], axis=1), 1.2)
    other[:20] = np.nan
    way = np.array([1.0, 0.0, 0.0])
    places = placements([t, s], [path, other], [way, turned(way, 1.2)])
    found, same = places[1].of_points(other)[20:], places[0].of_points(path)
    x = np.interp(s[20:], t, same[:, 0])
    assert np.abs(found[:, 0] - x).max() < 1e-3


def test_points_vectors_and_orientations_turn_alike():
    walk = foot_walk(heading_rad=0.4)
    path = walk.position_m
    (place,) = placements([walk.readings.time_s], [path], [path[-1] - path[0]])
    assert np.allclose(np.diff(place.of_points(path), axis=0), place.of_vectors(np.diff(path, axis=0)))
    found = Rotation.from_quat(place.of_orientations(walk.orientation.as_quat()))
    rotated = Rotation.from_euler("z", place.heading_rad) * walk.orientation
    assert (found.inv() * rotated).magnitude().max() < 1e-9


def test_feet_that_never_walk_keep_their_headings():
    t = np.linspace(0.0, 1.0, 10)
    still = np.zeros((10, 3))
    places = placements([t, t + 5.0], [still, still + 1.0], [np.zeros(3)] * 2)
    assert [place.heading_rad for place in places] == [0.0, 0.0]
    assert np.allclose(places[1].of_points(still + 1.0), 0.0)
