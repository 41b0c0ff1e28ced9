"""Skin of made persons: at rest in the standing posture, of the stated size, late, and driven by all joint angles."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.foreign.making.skin import (
    LAG_S,
    LARGEST_MM,
    MAKERS,
    MODELS,
    Driven,
    bent_back,
    lagged,
    of_size,
    slow_noise,
    wobble,
)
from mbkf.conventions import Array

DT, FRAMES = 0.01, 200
PLACES = np.random.default_rng(5).normal(0.0, 0.06, (5, 3))


def driven(flexion: Array) -> Driven:
    """A joint that flexes, and one that stays."""
    zero = np.zeros(len(flexion))
    return Driven(np.column_stack([flexion, zero]), zero[:, None], zero, np.zeros((len(flexion), 3)))


def there_and_back() -> Array:
    return np.asarray(0.8 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, FRAMES))))


@pytest.mark.parametrize("model", MODELS)
def test_standing_skin_is_at_rest(model: str) -> None:
    skin = MAKERS[model]("femur_r", PLACES, np.random.default_rng(1))
    moved = skin(driven(np.zeros(FRAMES)), DT)
    np.testing.assert_allclose(moved[0], 0.0, atol=1e-12)
    slow = 0.0 if model == "sliding" else 4e-3
    assert np.abs(moved).max() <= slow


@pytest.mark.parametrize("model", MODELS)
def test_skin_is_drawn_once_from_its_seed(model: str) -> None:
    first, again, other = (MAKERS[model]("femur_r", PLACES, np.random.default_rng(k)) for k in (1, 1, 2))
    flexion = driven(there_and_back())
    np.testing.assert_array_equal(first(flexion, DT), again(flexion, DT))
    assert np.abs(first(flexion, DT) - other(flexion, DT)).max() > 1e-3


def test_sliding_skin_lags_and_saturates() -> None:
    skin = MAKERS["sliding"]("tibia_r", PLACES, np.random.default_rng(1))
    flexion = there_and_back()
    moved = np.linalg.norm(skin(driven(flexion), DT), axis=2).mean(axis=1)
    up, down = 50, FRAMES - 1 - 50
    assert flexion[up] == pytest.approx(flexion[down])
    assert moved[down] > 1.01 * moved[up]
    assert moved[100] < 1.6 * moved[50]  # of twice the flexion


def test_turn_of_the_thigh_is_followed_in_part() -> None:
    skin = MAKERS["sliding"]("femur_r", PLACES, np.random.default_rng(1))
    zero = np.zeros(FRAMES)
    turn = np.linspace(0.0, 0.4, FRAMES)
    moved = skin(Driven(zero[:, None], zero[:, None], turn, np.zeros((FRAMES, 3))), DT)
    lever = PLACES - PLACES.mean(axis=0)
    np.testing.assert_allclose(moved[-1], -0.1 * np.cross([0.0, 1.0, 0.0], lever), atol=1e-12)


def test_fields_depend_on_more_than_flexion() -> None:
    skin = MAKERS["fields"]("femur_r", PLACES, np.random.default_rng(1))
    one, zero = there_and_back(), np.zeros(FRAMES)
    plain = skin(Driven(one[:, None], zero[:, None], zero, np.zeros((FRAMES, 3))), DT)
    turned = skin(Driven(one[:, None], 0.3 * one[:, None], zero, np.zeros((FRAMES, 3))), DT)
    assert np.abs(turned - plain).max() > 2e-3


def test_lag_follows_with_its_time_constant() -> None:
    found = lagged(np.append(0.0, np.ones(300)), DT)
    assert found[0] == 0.0
    assert found[round(LAG_S / DT)] == pytest.approx(1.0 - np.exp(-1.0), abs=0.02)
    assert found[-1] == pytest.approx(1.0, abs=1e-6)


def test_wobble_swings_after_an_impact_and_comes_to_rest() -> None:
    shock = np.zeros((400, 3))
    shock[10:13, 1] = 50.0
    found = wobble(shock, DT, 7.0)
    assert found[:10].max() == 0.0
    assert found[12:16, 1].min() < -1e-3
    assert found[16:30, 1].max() > 1e-3
    assert np.abs(found[-1]).max() < 1e-6


def test_steady_acceleration_bends_by_its_share() -> None:
    """At rest under a steady acceleration a, the spring holds a / ω²."""
    found = wobble(np.full((500, 3), 2.0), DT, 5.0)
    np.testing.assert_allclose(found[-1], -2.0 / (10.0 * np.pi) ** 2, rtol=1e-3)


def test_size_is_over_all_movements() -> None:
    rng = np.random.default_rng(2)
    movements = [rng.normal(0.0, scale, (50, 4, 3)) for scale in (1.0, 3.0)]
    found = of_size(movements, 0.010)
    squares = np.concatenate([(one**2).sum(axis=2).ravel() for one in found])
    assert np.sqrt(squares.mean()) == pytest.approx(0.010, rel=0.05)
    assert found[1].std() > 2.5 * found[0].std()
    first = of_size([movements[0]], 0.010)[0]
    np.testing.assert_allclose(of_size(movements, 0.010, sizing=1)[0], first)


def test_large_displacements_are_bent_back() -> None:
    found = bent_back(np.array([[0.001, 0.0, 0.0], [0.0, 0.5, 0.0]]))
    assert found[0, 0] == pytest.approx(0.001, rel=1e-3)
    assert np.linalg.norm(found[1]) <= 1e-3 * LARGEST_MM


def test_slow_noise_begins_at_zero_and_is_smooth() -> None:
    found = slow_noise(300, 3, DT, np.random.default_rng(0))
    assert found.shape == (300, 3, 3)
    np.testing.assert_array_equal(found[0], 0.0)
    assert np.abs(np.diff(found, axis=0)).max() < 0.3e-3
