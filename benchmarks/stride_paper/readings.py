"""Every combination of readings of the paper's text that is open, beside its clean and its drift result.

The text leaves open: the cubic course of a step, where windows lie, how a spread and a mean over three axes become one
number, whether velocities are set to zero at key points, the low pass (named for real signals only), the constant c of
stride eq. 4, the loss α of stride eq. 2, the unit and the axes of the gyroscope's constant 0.1, and whether
differences are averaged with or without their sign.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from benchmarks.inertial.cubic_steps import SHAPES, cubic_steps
from benchmarks.stride_paper import printed
from benchmarks.stride_paper.errors import signed_errors
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.key_points import KeyPointSettings, StabilityMeasure, stability

CONSTANTS = {
    "rad/s, all axes": (1.0, 1.0, 1.0),
    "rad/s, all axes, negative": (-1.0, -1.0, -1.0),
    "rad/s, x": (1.0, 0.0, 0.0),
    "rad/s, y": (0.0, 1.0, 0.0),
    "deg/s, all axes": (np.pi / 180.0,) * 3,
}
"""Unit and axes of the gyroscope's constant, as factors on 0.1 rad/s."""

AVERAGES = ("absolute", "signed")
NUMBERS = ("clean, final", "clean, mean", "drift, final", "drift, mean")
NEAR_M = 0.01


def by_magnitude(force: Array, rates: Array, weights: tuple[float, float, float]) -> Array:
    """(K,) stability of the specific force's magnitude.

    Args:
        force: (K, N, 3) specific force of the windows.
        rates: (K, N, 3) angular velocity.
        weights: α_σ, α_μ, α_ω.
    """
    size = np.linalg.norm(force, axis=2)
    change = np.abs(np.diff(size.mean(axis=1), prepend=size[0].mean()))
    turning = np.linalg.norm(rates, axis=2).mean(axis=1)
    total: Array = weights[0] * size.std(axis=1) + weights[1] * change + weights[2] * turning
    return total


def by_sum(force: Array, rates: Array, weights: tuple[float, float, float]) -> Array:
    """(K,) stability summed over the axes.

    Args:
        force: (K, N, 3) specific force of the windows.
        rates: (K, N, 3) angular velocity.
        weights: α_σ, α_μ, α_ω.
    """
    mean = force.mean(axis=1)
    change = np.abs(np.diff(mean, axis=0, prepend=mean[:1])).sum(axis=1)
    turning = np.abs(rates.mean(axis=1)).sum(axis=1)
    total: Array = weights[0] * force.std(axis=1).sum(axis=1) + weights[1] * change + weights[2] * turning
    return total


MEASURES: dict[str, StabilityMeasure] = {"length": stability, "magnitude": by_magnitude, "sum": by_sum}


@dataclass(frozen=True)
class Readings:
    """All readings: their words (n), and their four numbers (n, 4) in the order of :data:`NUMBERS`, m."""

    words: tuple[tuple[str, ...], ...]
    values_m: Array

    @property
    def distances_m(self) -> Array:
        """(n,) largest distance of a reading's four numbers from the printed ones."""
        off: Array = np.abs(self.values_m - PRINTED_M).max(axis=1)
        return off

    @property
    def nearest(self) -> int:
        """The reading whose four numbers are nearest to the printed ones."""
        return int(self.distances_m.argmin())

    def near(self, *numbers: int) -> int:
        """Number of readings that give these printed numbers to within :data:`NEAR_M`.

        Args:
            numbers: Indices into :data:`NUMBERS`.
        """
        chosen = list(numbers)
        return int((np.abs(self.values_m - PRINTED_M)[:, chosen].max(axis=1) <= NEAR_M).sum())


PRINTED_M = np.array(
    [printed.FINAL_M["clean"], printed.MEAN_M["clean"], printed.FINAL_M["drift"], printed.MEAN_M["drift"]]
)

HEADS = (
    "step", "first sample", "stability of", "velocity at key points", "low pass", "c", "α", "constant 0.1 in",
    "mean of differences",
)  # fmt: skip


def search() -> Readings:
    """Runs every reading on the clean and the drift case; one without key points is left out."""
    words: list[tuple[str, ...]] = []
    values: list[list[float]] = []
    for shape, name, settings in _settings():
        measure = MEASURES[name]
        try:
            clean = signed_errors(cubic_steps(shape=shape), settings, measure)
        except InvalidInput:
            continue
        for constant, direction in CONSTANTS.items():
            try:
                drift = signed_errors(
                    cubic_steps("drift", shape=shape, direction=direction), settings, measure
                )
            except InvalidInput:
                continue
            for average in AVERAGES:
                words.append((*_words(shape, name, settings), constant, average))
                values.append([*_final_and_mean(clean, average), *_final_and_mean(drift, average)])
    return Readings(tuple(words), np.array(values))


def _settings() -> Iterator[tuple[str, str, KeyPointSettings]]:
    """Every combination of settings, with the shape of a step and the measure of stability."""
    for shape, measure, first, zero, low_pass, middle, loss in product(
        SHAPES, MEASURES, (printed.ALIGNED, printed.AS_STUDIED), (False, True), (None, 15.0), (0.25, 0.5, 0.75),
        (0.0, 0.05, 0.1),
    ):  # fmt: skip
        settings = KeyPointSettings(
            first=first, zero_velocity=zero, low_pass_hz=low_pass, middle=middle, loss=loss, still_s=0.0
        )
        yield shape, measure, settings


def _words(shape: str, measure: str, settings: KeyPointSettings) -> tuple[str, ...]:
    zero = "zero" if settings.zero_velocity else "integrated"
    low_pass = "–" if settings.low_pass_hz is None else f"{settings.low_pass_hz:g} Hz"
    return (
        shape, str(settings.first), measure, zero, low_pass, f"{settings.middle:g}", f"{settings.loss:g}"
    )  # fmt: skip


def _final_and_mean(off: Array, average: str) -> tuple[float, float]:
    mean = np.abs(off).mean() if average == "absolute" else abs(off.mean())
    return abs(float(off[-1])), float(mean)
