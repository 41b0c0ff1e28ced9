"""Midpoints and centroids among markers: found to the last digit, and no marker taken for one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.records import MarkerTrajectories
from mbkf.marker_sets.combined_points import EXACT_M, combined_points

RATE_HZ = 100.0


def moving(count=12, frames=60, noise_m=3e-4, seed=1):
    """Markers of a body that turns and moves, each with noise of its own."""
    rng = np.random.default_rng(seed)
    own = rng.uniform(-0.3, 0.3, (count, 3))
    axis = np.array([0.2, 0.3, 1.0])
    turns = Rotation.from_rotvec(np.linspace(0.0, 1.0, frames)[:, None] * axis).as_matrix()
    points = np.einsum("tij,kj->tki", turns, own) + np.linspace(0.0, 1.0, frames)[:, None, None]
    points = points + rng.normal(0.0, noise_m, points.shape)
    return MarkerTrajectories(tuple(f"M{k}" for k in range(count)), points, RATE_HZ)


def with_point(markers, weights, off_m=0.0):
    """One more point: so much of each marker by its name, and a constant distance."""
    columns = [markers.names.index(name) for name in weights]
    point = np.einsum("k,tki->ti", [*weights.values()], markers.positions_m[:, columns]) + off_m
    positions = np.concatenate([markers.positions_m, point[:, None]], axis=1)
    return replace(markers, names=(*markers.names, "V"), positions_m=positions)


def near(markers, count):
    """Names of the first marker and of its nearest."""
    away = np.linalg.norm(markers.positions_m[0] - markers.positions_m[0, 0], axis=1)
    return [markers.names[k] for k in np.argsort(away)[:count]]


@pytest.mark.parametrize("share", [0.5, 0.2, 0.9])
def test_a_point_on_the_line_between_two_is_found_wherever_they_are(share):
    found = combined_points([with_point(moving(), {"M3": share, "M8": 1.0 - share})])
    assert found == {"V": ("M3", "M8")}


@pytest.mark.parametrize("count", [3, 4])
def test_centroids_of_neighbours_are_found(count):
    markers = moving()
    names = near(markers, count)
    found = combined_points([with_point(markers, dict.fromkeys(names, 1.0 / count))])
    assert {name: set(others) for name, others in found.items()} == {"V": set(names)}


def test_markers_are_no_combinations():
    assert combined_points([moving()]) == {}
    assert combined_points([moving(noise_m=2e-5)]) == {}, "of a still cluster"


def test_a_point_beside_the_line_or_beyond_its_ends_is_none():
    markers = moving()
    assert combined_points([with_point(markers, {"M3": 0.5, "M8": 0.5}, off_m=4.0 * EXACT_M)]) == {}
    beyond = combined_points([with_point(markers, {"M3": 1.5, "M8": -0.5})])
    assert "V" not in beyond
    assert set(beyond.get("M3", ("M8", "V"))) == {"M8", "V"}, "M3 is between the other two"


def test_a_capture_without_noise_shows_nothing():
    """All markers of a rigid body are combinations of four others, exactly; which was made of which is unknown."""
    assert combined_points([with_point(moving(noise_m=0.0), {"M3": 0.5, "M8": 0.5})]) == {}


def test_digits_that_a_file_rounds_away_do_not_hide_a_midpoint():
    made = with_point(moving(), {"M3": 0.5, "M8": 0.5})
    rounded = replace(made, positions_m=np.round(made.positions_m, 5))
    assert combined_points([rounded]) == {"V": ("M3", "M8")}


def test_frames_without_a_point_do_not_count_and_one_capture_suffices():
    made = with_point(moving(), {"M3": 0.5, "M8": 0.5})
    gappy = made.positions_m.copy()
    gappy[10:40, 3] = np.nan
    assert combined_points([moving(), replace(made, positions_m=gappy)]) == {"V": ("M3", "M8")}
    gappy[2:, 3] = np.nan
    assert combined_points([replace(made, positions_m=gappy)]) == {}, "two frames show no relation"
    assert combined_points([replace(made, positions_m=made.positions_m[:1])]) == {}


@pytest.mark.filterwarnings("error")
def test_points_that_no_frame_shows_together():
    made = with_point(moving(), {"M3": 0.5, "M8": 0.5})
    gappy = made.positions_m.copy()
    gappy[::2, 0] = gappy[1::2, 1] = np.nan
    assert combined_points([replace(made, positions_m=gappy)]) == {"V": ("M3", "M8")}
