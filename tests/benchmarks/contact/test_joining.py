"""Joined plates and belts: what they read is what the plates read, seen from elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.contact.joining import MARGIN_M, joined, on_belt
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.sensors.contact.plates import PlateAreas, plate_wrenches
from tests.motions import assert_near

RATE_HZ, SECONDS, BELT_M_S = 100.0, 0.5, 1.2
ABOUT_PLATE = np.array([[1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]]) * 0.3


def plate(name, x, seed, outline=True):
    rng, samples = np.random.default_rng(seed), int(SECONDS * 1000)
    origin = np.array([x, 0.1 * seed, 0.0])
    force = rng.normal(0, 50, (samples, 3)) + np.array([0.0, 0.0, 400.0])
    pressed = np.tile(origin, (samples, 1))
    corners = origin + ABOUT_PLATE if outline else None
    return PlateReadings(
        name, 1000.0, 0.0, origin, force, rng.normal(0, 9, (samples, 3)), pressed, 20.0, corners
    )


def capture(outline=True):
    frames = int(SECONDS * RATE_HZ)
    positions = np.random.default_rng(3).normal(size=(frames, 2, 3))
    positions[3, 1] = np.nan
    markers = MarkerTrajectories(("a", "b"), positions, RATE_HZ)
    return Capture("", markers, (plate("1", 0.0, 1, outline), plate("2", 0.7, 2, outline)))


def wrenches(one):
    return plate_wrenches(one.plates, one.markers.times_s, RATE_HZ)


@pytest.mark.parametrize("outline", [True, False])
def test_one_plate_reads_the_sum_and_covers_all(outline):
    made = capture(outline)
    one = joined(made)
    assert len(one.plates) == 1 and one.markers is made.markers
    assert_near(wrenches(one)[:, 0], wrenches(made).sum(axis=1), 1e-9)
    reach = 0.29 if outline else 0.9 * MARGIN_M
    corners = np.concatenate([p.origin_m + ABOUT_PLATE / 0.3 * reach for p in made.plates])
    assert PlateAreas(one.plates).contain(corners[:, :2]).all()


def test_plates_recorded_apart_are_not_joined():
    made = capture()
    with pytest.raises(InvalidInput, match="recorded together"):
        joined(replace(made, plates=()))
    late = replace(made.plates[1], start_time_s=0.1)
    with pytest.raises(InvalidInput, match="recorded together"):
        joined(replace(made, plates=(made.plates[0], late)))


def test_a_belt_moves_points_of_application_and_markers_alike():
    """Forces stay; a force's line of action stays where it was against the markers."""
    one = joined(capture())
    belt = on_belt(one, BELT_M_S)
    back = np.outer(one.markers.times_s, [-BELT_M_S, 0.0, 0.0])
    np.testing.assert_allclose(
        belt.markers.positions_m, one.markers.positions_m + back[:, None], atol=1e-12, equal_nan=True
    )
    here, there = one.plates[0], belt.plates[0]
    np.testing.assert_array_equal(there.force_n, here.force_n)
    pressed = here.centre_of_pressure_m + np.outer(here.times_s, [-BELT_M_S, 0.0, 0.0])
    np.testing.assert_allclose(there.centre_of_pressure_m, pressed, atol=1e-9, equal_nan=True)
    seen = belt.markers.positions_m.reshape(-1, 3)
    assert PlateAreas(belt.plates).contain(seen[np.isfinite(seen).all(axis=1)][:, :2] * (1 - 1e-9)).all()


def test_a_belt_is_one_plate():
    with pytest.raises(InvalidInput, match="one plate"):
        on_belt(capture(), BELT_M_S)
