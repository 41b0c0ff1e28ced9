"""Captures of made persons: gaps, sway, misplacement, and markers hidden in moving trials."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.foreign.making.capture import GAPS, MISPLACED_M, misplacements, seen, static_places, with_gaps
from benchmarks.foreign.making.persons import person_named


def test_gaps_are_runs_of_a_few_per_cent() -> None:
    places = np.zeros((400, 30, 3))
    found = with_gaps(places, np.random.default_rng(1))
    missing = np.isnan(found)
    share = missing[:, :, 0].mean()
    assert GAPS[0] <= share <= GAPS[1] + 30 / places[:, :, 0].size
    np.testing.assert_array_equal(missing.all(axis=2), missing.any(axis=2))
    starts = (np.diff(missing[:, :, 0].astype(int), axis=0) == 1).sum()
    assert missing[:, :, 0].sum() > 4 * starts
    assert not np.isnan(places).any()


def test_markers_are_misplaced_by_seven_millimetres() -> None:
    names = tuple(str(k) for k in range(500))
    away = np.array(list(misplacements(names, np.random.default_rng(0)).values()))
    assert np.sqrt((away**2).sum(axis=1).mean()) == pytest.approx(np.sqrt(3.0) * MISPLACED_M, rel=0.05)


def test_standing_sways_as_a_whole() -> None:
    exact = np.random.default_rng(0).normal(size=(7, 3))
    found = static_places(exact, np.random.default_rng(1))
    away = found - exact
    np.testing.assert_allclose(away, np.repeat(away[:, :1], 7, axis=1), atol=1e-12)
    assert 0.0 < np.abs(away).max() < 0.005


def test_medial_markers_are_seen_in_the_static_trial_alone() -> None:
    names = ("R.Knee", "R.MKnee", "S2", "L.MAnkle")
    assert [names[k] for k in seen(person_named("obese"), names)] == ["R.Knee", "S2"]
