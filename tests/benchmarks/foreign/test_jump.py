"""A made jump: free fall in flight, a pull towards the ground at no time, and times that grow with the legs."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.foreign.making.jump import FLIGHT_S, LEGS_M, jump
from benchmarks.foreign.making.legs import RATE_HZ
from benchmarks.foreign.making.paths import between
from mbkf.conventions import GRAVITY_M_S2

FEET_M = np.array([[0.0, 0.05, 0.1], [0.0, 0.05, -0.1]])


def accelerations(legs_m):
    """(T − 2,) upward acceleration of the pelvis between the first and the last frame, g, and whether a foot bears."""
    stance, _ = jump(legs_m, 1.0, FEET_M)
    height = np.diff(stance.height_m, n=2) * RATE_HZ**2 / GRAVITY_M_S2
    return height, stance.contacts.any(axis=1)[1:-1]


@pytest.mark.parametrize("legs_m", [0.5, LEGS_M])
def test_the_pelvis_falls_in_flight_and_is_pushed_upwards_before_and_after(legs_m):
    found, bears = accelerations(legs_m)
    flight = np.flatnonzero(~bears)
    assert len(flight) / RATE_HZ == pytest.approx(FLIGHT_S * np.sqrt(legs_m / LEGS_M), abs=1.5 / RATE_HZ)
    np.testing.assert_allclose(found[flight[2:-2]], -1.0, atol=1e-6)
    assert found[bears].min() > -1.0
    assert found[: flight[0]].max() == pytest.approx(1.4, abs=0.1)
    assert found[flight[-1] :].max() == pytest.approx(1.6, abs=0.1)


def test_feet_stay_where_they_stand_and_come_back_there():
    stance, _ = jump(LEGS_M, 1.0, FEET_M)
    bears = stance.contacts.any(axis=1)
    np.testing.assert_allclose(stance.paths_m[:, :, [0, 2]] - FEET_M[:, [0, 2]], 0.0, atol=1e-12)
    raised = stance.paths_m[:, :, 1] - FEET_M[:, 1] - 0.5 * stance.heels_m[:, None]
    np.testing.assert_allclose(raised[bears], 0.0, atol=1e-4)
    assert raised.max() > 0.15 and stance.heels_m[-1] == 0.0


def test_a_path_has_its_values_velocities_and_accelerations():
    knots = [(0.0, 1.0, 0.0, 0.0), (0.5, 2.0, 3.0, -4.0), (1.0, 0.0, 0.0, 0.0)]
    step = 1e-4
    before, at, after = between(np.array([0.5 - step, 0.5, 0.5 + step]), knots)
    assert at == pytest.approx(2.0)
    assert (after - before) / (2.0 * step) == pytest.approx(3.0, abs=1e-3)
    assert (after - 2.0 * at + before) / step**2 == pytest.approx(-4.0, abs=0.1)
    np.testing.assert_array_equal(between(np.array([-1.0, 2.0]), knots), [1.0, 0.0])
