"""Frames of a source: points that cannot be true are missing, and plates may have read nothing yet."""

import numpy as np
import pytest

from mbkf.stream.source import (
    FARTHEST_M,
    PlateSamples,
    StreamDescription,
    empty_plate,
    plausible,
    without_readings,
)


@pytest.mark.usefixtures("either_kernel")
def test_a_point_too_far_away_is_missing_and_counted():
    far, lost = -2.0 * FARTHEST_M, np.nan
    beyond = [[np.inf, 0.0, 0.0], [0.0, far, 0.0], [0.0, 0.0, far]]
    absent = [[lost] * 3, [0.0, lost, 1.0], [lost, far, 1.0]]
    points = np.array([[0.0, 1.0, FARTHEST_M], *beyond, *absent])
    cleaned, wrong = plausible(points)
    assert wrong == 3
    np.testing.assert_array_equal(cleaned, [points[0], *[[lost] * 3] * 6])


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("count", [0, 3])
def test_points_that_are_all_there_are_not_copied(count):
    points = np.ones((count, 3))
    assert plausible(points)[0] is points


def test_a_plate_before_its_first_sample():
    plate = empty_plate("one", 1000.0, 0.5, np.zeros(3), 20.0, None)
    assert len(plate.force_n) == len(plate.moment_nm) == len(plate.centre_of_pressure_m) == 0
    emptied = without_readings(plate)
    assert (emptied.name, emptied.rate_hz, emptied.threshold_n) == ("one", 1000.0, 20.0)
    assert PlateSamples.none(2).wrench.shape == (0, 2, 6)
    assert StreamDescription("trial", (), 100.0, plates=(plate,)).plate_rate_hz == 1000.0
    assert StreamDescription("trial", (), 100.0).plate_rate_hz == 100.0
