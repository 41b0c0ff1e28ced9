"""Persons of our own: two halves, two marker sets in each, movements that begin and end at rest."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.foreign.making.drivers import OF_BODY
from benchmarks.foreign.making.paths import minimum_jerk
from benchmarks.foreign.making.persons import (
    CHOSEN_ON,
    OPENCAP,
    PERSONS,
    RAJAGOPAL,
    SHOWN_ON,
    person_named,
    tilted,
)
from benchmarks.foreign.making.skin import AMPLITUDE_MM


def test_halves_are_named_and_apart() -> None:
    assert sorted((*CHOSEN_ON, *SHOWN_ON)) == sorted(one.name for one in PERSONS)
    assert not set(CHOSEN_ON) & set(SHOWN_ON)
    assert len(CHOSEN_ON) == len(SHOWN_ON) == 4


@pytest.mark.parametrize("half", [CHOSEN_ON, SHOWN_ON])
def test_each_half_has_both_marker_sets(half: tuple[str, ...]) -> None:
    assert {person_named(name).marker_set for name in half} == {RAJAGOPAL, OPENCAP}


def test_every_body_with_skin_has_its_drivers() -> None:
    assert set(OF_BODY) == set(AMPLITUDE_MM)


def test_tilt_keeps_thighs_and_trunk_upright() -> None:
    names = ("pelvis_tilt", "hip_flexion_r", "hip_flexion_l", "lumbar_extension")
    values = {name: np.array([0.1 * k]) for k, name in enumerate(names)}
    found = tilted(person_named("tilted_pelvis"), values)
    assert found["pelvis_tilt"] == pytest.approx(-np.deg2rad(14.0))
    for name in names[1:]:
        assert found["pelvis_tilt"] + found[name] == pytest.approx(values["pelvis_tilt"] + values[name])


def test_minimum_jerk_rests_at_its_knots() -> None:
    t = np.linspace(0.0, 3.0, 301)
    found = minimum_jerk(t, [(0.5, 1.0), (1.5, 3.0), (2.5, 2.0)])
    np.testing.assert_allclose(found[[0, 50, 150, 250, 300]], [1.0, 1.0, 3.0, 2.0, 2.0])
    speed = np.gradient(found, t)
    np.testing.assert_allclose(speed[[50, 150, 250]], 0.0, atol=2e-3)
    assert speed.max() == pytest.approx(2.0 * 1.875, rel=1e-2)
