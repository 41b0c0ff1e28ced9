"""Errors on the paper's simulated walk, by method, case, seed and phase of windows or samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from benchmarks.inertial.cubic_steps import CASES, RATE_HZ, CubicSteps, cubic_steps
from benchmarks.stride_paper import printed
from mbkf.conventions import Array
from mbkf.imu.foot_filter import FootFilterSettings, follow_foot
from mbkf.imu.foot_track import smoothed_track
from mbkf.imu.key_points import KeyPointPath, KeyPointSettings, StabilityMeasure, follow_key_points
from mbkf.imu.zero_velocity import StillnessSettings, still_samples

PRINTED, KEY_POINTS, KALMAN = "as printed", "key points", "Kalman"

PHASES = tuple(range(10))
"""Sample at which the first window begins."""

DIRECTIONS = tuple((x, y, z) for x, y, z in product((1.0, -1.0), repeat=3))
"""Signs of the gyroscope's constant on its axes; the paper does not state them."""

DELAYS_S = tuple(0.021 * k for k in range(10))
"""Starts of the motion against the samples, for the Kalman filter, which has no windows."""


@dataclass(frozen=True)
class Study:
    """Absolute errors along x: per method and case (phases, draws, 2), last the final and the mean one, m.

    Draws are seeds of the noise and, for the method as printed, directions of the gyroscope's constant.
    """

    errors: dict[tuple[str, str], Array]

    @property
    def cases(self) -> tuple[str, ...]:
        """The paper's cases."""
        return tuple(CASES)

    def largest(self, method: str, case: str, phase: int) -> tuple[float, float]:
        """Largest final and largest mean error over the draws.

        Args:
            method: Name of the method.
            case: Name of the simulated case.
            phase: First sample of the windows.
        """
        final, mean = self.errors[method, case][phase].max(axis=0)
        return float(final), float(mean)

    def typical(self, method: str, case: str, phase: int) -> tuple[float, float]:
        """Median final and median mean error over the draws.

        Args:
            method: Name of the method.
            case: Name of the simulated case.
            phase: First sample of the windows.
        """
        final, mean = np.median(self.errors[method, case][phase], axis=0)
        return float(final), float(mean)

    def worst_phase(self, method: str, case: str) -> tuple[float, float]:
        """Largest final and largest mean error over phases and draws.

        Args:
            method: Name of the method.
            case: Name of the simulated case.
        """
        final, mean = self.errors[method, case].max(axis=(0, 1))
        return float(final), float(mean)


def measure(seeds: Sequence[int]) -> Study:
    """Every method on every case.

    Args:
        seeds: Of the noise.
    """
    errors: dict[tuple[str, str], Array] = {}
    for case, sensor in CASES.items():
        seen = seeds if sensor.noise_m_s2 > 0.0 else seeds[:1]
        turned = DIRECTIONS if sensor.bias_rad_s > 0.0 else DIRECTIONS[:1]
        for method, directions in ((PRINTED, turned), (KEY_POINTS, DIRECTIONS[:1])):
            walks = [cubic_steps(case, seed, direction=one) for seed in seen for one in directions]
            errors[method, case] = np.array(
                [
                    [key_point_errors(walk, settings_of(method, case, first)) for walk in walks]
                    for first in PHASES
                ]
            )
        errors[KALMAN, case] = np.array(
            [[kalman_errors(cubic_steps(case, seed, delay_s=delay)) for seed in seen] for delay in DELAYS_S]
        )
    return Study(errors)


def settings_of(method: str, case: str, first: int) -> KeyPointSettings:
    """Settings of a method that works on windows, with the paper's weights for a case.

    Args:
        method: Name of the method.
        case: Name of the simulated case.
        first: First sample of the windows.
    """
    if method == PRINTED:
        return printed.simulated(case, first)
    return KeyPointSettings(first=first, weights=printed.weights(case))


def key_points(
    walk: CubicSteps, settings: KeyPointSettings, measure: StabilityMeasure | None = None
) -> KeyPointPath:
    """The paper's algorithm on a walk.

    Args:
        walk: The walk.
        settings: Windows, weights and equations.
        measure: Stability of windows, where it is another one than stride eq. 1 with lengths of vectors.
    """
    f, w = walk.specific_force_mps2, walk.angular_velocity_rad_s
    return follow_key_points(f, w, 1.0 / float(walk.time_s[1] - walk.time_s[0]), settings, measure=measure)


def window_truth(walk: CubicSteps, settings: KeyPointSettings) -> Array:
    """(K,) the true x, averaged over each window as the paper does."""
    K = (len(walk.time_s) - settings.first) // settings.window
    used = slice(settings.first, settings.first + K * settings.window)
    truth: Array = walk.position_m[used, 0].reshape(K, settings.window).mean(axis=1)
    return truth


def signed_errors(
    walk: CubicSteps, settings: KeyPointSettings, measure: StabilityMeasure | None = None
) -> Array:
    """(K,) estimated minus true x of each window, m.

    Args:
        walk: The walk.
        settings: Windows, weights and equations.
        measure: Stability of windows; stride eq. 1 when None.
    """
    off: Array = key_points(walk, settings, measure).position_m[:, 0] - window_truth(walk, settings)
    return off


def key_point_errors(walk: CubicSteps, settings: KeyPointSettings) -> tuple[float, float]:
    """Final and mean absolute error along x, m."""
    off = np.abs(signed_errors(walk, settings))
    return float(off[-1]), float(off.mean())


def kalman_path(walk: CubicSteps) -> Array:
    """(T,) x of the Kalman filter with smoother, from the walk's true start."""
    f, w = walk.specific_force_mps2, walk.angular_velocity_rad_s
    still = still_samples(f, w, RATE_HZ, StillnessSettings())
    run = follow_foot(f, w, RATE_HZ, still, FootFilterSettings())
    x: Array = smoothed_track(run).position_m[:, 0]
    return np.asarray(x - x[run.first] + walk.position_m[run.first, 0])


def kalman_errors(walk: CubicSteps) -> tuple[float, float]:
    """Final and mean absolute error along x, m."""
    off = np.abs(kalman_path(walk) - walk.position_m[:, 0])
    return float(off[-1]), float(np.nanmean(off))
