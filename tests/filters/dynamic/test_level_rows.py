"""Rows of the trunk's moments in the dynamic filter's state, with loads on hands, seat and knee."""

import numpy as np
import pytest

from mbkf.filters.dynamic.level_rows import LevelRows
from mbkf.model.trunk_sections import TrunkSections
from tests.filters.dynamic.test_support_loads import LEFT, MODEL, RIGHT, SEAT, SOME, made, scene

PARTS = [(), *SOME]


def rows(parts):
    """Rows by way and level, and variances by the sharing."""
    torque, loads, by_state, _ = made(parts)
    found, variance = LevelRows(MODEL, scene()[0]).at(scene()[2], loads, torque.tau, by_state)
    return found.reshape(2, 3, 3, -1), variance.reshape(2, 3, 3)


@pytest.mark.parametrize("parts", PARTS)
def test_at_the_bodys_own_joint_they_are_those_of_its_torque(parts):
    _, _, by_state, shared = made(parts)
    torso = MODEL.joint("torso").v
    found, variance = rows(parts)
    np.testing.assert_allclose(found[0, 0], by_state[torso], atol=1e-8 * np.abs(by_state).max())
    expected = np.zeros(3) if shared is None else shared[torso]
    np.testing.assert_allclose(variance[0, 0], expected, atol=1e-8 * max(1.0, expected.max()))


@pytest.mark.parametrize("parts", PARTS)
def test_the_ways_differ_by_the_residual(parts):
    """The residual knows the whole load of all parts, however they share it."""
    _, _, by_state, _ = made(parts)
    found, variance = rows(parts)
    by_root = TrunkSections(MODEL).by_root(scene()[2].q)
    torso, size = MODEL.joint("torso").v, np.abs(by_state).max()
    columns = np.ones(by_state.shape[1], dtype=bool)
    columns[torso] = False  # the axes turn with each moment
    for k in range(3):
        expected = by_root[k] @ by_state[:6]
        np.testing.assert_allclose(
            (found[0, k] - found[1, k])[:, columns], expected[:, columns], atol=1e-8 * size
        )
    np.testing.assert_allclose(variance[0], variance[1], atol=1e-6 * max(1.0, variance.max()))


def test_hands_alone_change_nothing_bottom_up_and_a_seat_alone_nothing_top_down():
    own = scene()[0].slice
    hands, seat = rows((RIGHT, LEFT))[0], rows((SEAT,))[0]
    assert np.abs(hands[0][..., own]).max() > 0.1 and np.abs(seat[1][..., own]).max() > 0.1
    np.testing.assert_allclose(hands[1][..., own], 0.0, atol=1e-12)
    np.testing.assert_allclose(seat[0][..., own], 0.0, atol=1e-12)
