"""Scores: cover and calibration of known normal errors, offsets of known means, pooling over motions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from benchmarks.foreign.errors import Judged, Series
from benchmarks.foreign.score import (
    LEVELS,
    angle_score,
    calibration_error,
    cover,
    offset_score,
    reliability,
    score,
)
from mbkf.conventions import Array

SAMPLES = 20_000


def series(
    error: Array, *, person: str = "p", motion: str = "m", name: str = "hip_flexion_r", sd: float = 1.0
) -> Series:
    return Series(person, motion, "legs", name, error, np.full(len(error), sd), np.full(len(error), sd))


def normal(sd: float = 1.0, mean: float = 0.0) -> Array:
    return np.asarray(np.random.default_rng(4).normal(mean, sd, SAMPLES))


def test_cover_of_normal_errors_is_the_level() -> None:
    assert cover(normal(2.0), np.full(SAMPLES, 2.0)) == pytest.approx(0.95, abs=0.01)
    assert cover(normal(2.0), np.full(SAMPLES, 2.0), 0.5) == pytest.approx(0.5, abs=0.015)


def test_cover_counts_known_samples_only() -> None:
    error, sd = np.array([0.0, np.nan, 5.0, 0.0]), np.array([1.0, 1.0, 1.0, np.nan])
    assert cover(error, sd) == 0.5
    assert np.isnan(cover(np.array([np.nan]), np.ones(1)))


def test_calibrated_errors_have_no_calibration_error() -> None:
    sd = np.full(SAMPLES, 3.0)
    np.testing.assert_allclose(reliability(normal(3.0), sd), LEVELS, atol=0.015)
    assert calibration_error(normal(3.0), sd) < 0.01


def held(factor: float) -> Array:
    """(L,) shares of unit normal errors within intervals of this standard deviation."""
    return np.asarray(2.0 * norm.cdf(factor * norm.ppf(0.5 + 0.5 * LEVELS)) - 1.0)


def test_calibration_error_counts_both_ways() -> None:
    """Deviations half as large, or twice as large as the errors: the mean distance of both curves from the diagonal."""
    small, large = (calibration_error(normal(), np.full(SAMPLES, factor)) for factor in (0.5, 2.0))
    assert small == pytest.approx(np.mean(LEVELS - held(0.5)), abs=0.01)
    assert large == pytest.approx(np.mean(held(2.0) - LEVELS), abs=0.01)
    assert min(small, large) > 0.15


def test_offsets_and_their_shift() -> None:
    zero = np.zeros(10)
    found = offset_score(
        [
            series(zero + 4.0, motion="walk"),
            series(zero - 2.0, motion="squat"),
            series(zero + 1.0, person="other", motion="walk"),
            series(zero + 1.0, person="other", motion="squat"),
        ]
    )
    assert found.widest == 6.0
    assert found.shift == pytest.approx(np.sqrt((3.0**2 + 0.0) / 2))
    assert found.size == pytest.approx(np.sqrt((16 + 4 + 1 + 1) / 4))


def test_mean_of_each_motion_is_no_part_of_its_varying_error() -> None:
    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False))
    found = angle_score([series(wave + 5.0), series(wave - 5.0, motion="other")])
    assert found.varying == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert found.raw == pytest.approx(np.sqrt(25.5), rel=1e-3)
    assert (found.cover, found.varying_cover) == (0.0, 1.0)


def test_motions_are_pooled_by_samples() -> None:
    short, long = series(np.full(10, 3.0)), series(np.zeros(80), motion="long")
    moments = (series(np.full(10, 0.3), sd=0.1),)
    centres = {("hip", "r"): np.full(10, 0.01), ("knee", "r"): np.zeros(10), ("ankle", "r"): np.zeros(10)}
    found = score(
        [
            Judged("p", "m", (short,), moments, centres),
            Judged("p", "long", (long,), (), {("hip", "r"): np.zeros(30)}),
        ]
    )
    assert found.legs.raw == pytest.approx(1.0)
    assert found.legs.cover == pytest.approx(80 / 90)
    assert found.centres_mm["hip"] == pytest.approx(5.0)
    assert (found.moment, found.moment_cover) == (pytest.approx(0.3), 0.0)
