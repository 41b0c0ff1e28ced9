"""Errors on the stride-length study's simulated walk, by method, case, seed and phase of windows or samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.inertial.cubic_steps import CASES, RATE_HZ, CubicSteps, cubic_steps
from mbkf.conventions import Array
from mbkf.imu.foot_filter import FootFilterSettings, follow_foot
from mbkf.imu.foot_track import smoothed_track
from mbkf.imu.key_points import (
    NOISY_WEIGHTS,
    USUAL_WEIGHTS,
    KeyPointPath,
    KeyPointSettings,
    follow_key_points,
)
from mbkf.imu.zero_velocity import StillnessSettings, still_samples

KEY_POINTS, KEY_POINTS_WITH_BIAS, KALMAN = "key points", "key points, bias left in", "Kalman"

STUDY_FINAL_M = {"clean": 0.32, "noise": 0.49, "drift": 0.47, "noise and drift": 0.64}
STUDY_MEAN_M = {"clean": 0.06, "noise": 0.14, "drift": 0.12, "noise and drift": 0.32}
"""What the study found on its one signal per case."""

FINAL_M, MEAN_M = 0.15, 0.08
"""Bounds for windows aligned with the motion."""

PHASES = tuple(range(10))
"""Sample at which the first window begins."""

ALIGNED, AS_STUDIED = 0, 1
"""Windows that begin with the motion; and where the study's windows lie: its second differences of 250 positions leave
248 samples, the first of which belongs to the second position."""

DELAYS_S = tuple(0.021 * k for k in range(10))
"""Starts of the motion against the samples, for the Kalman filter, which has no windows."""


@dataclass(frozen=True)
class Study:
    """Absolute errors along x: per method and case (phases, seeds, 2), last the final and the mean one, m."""

    errors: dict[tuple[str, str], Array]

    @property
    def cases(self) -> tuple[str, ...]:
        """The study's cases."""
        return tuple(CASES)

    def largest(self, method: str, case: str, phase: int) -> tuple[float, float]:
        """Largest final and largest mean error over the seeds.

        Args:
            method: Name of the method.
            case: Name of the simulated case.
            phase: First sample of the windows.
        """
        final, mean = self.errors[method, case][phase].max(axis=0)
        return float(final), float(mean)

    def typical(self, method: str, case: str, phase: int) -> tuple[float, float]:
        """Median final and median mean error over the seeds.

        Args:
            method: Name of the method.
            case: Name of the simulated case.
            phase: First sample of the windows.
        """
        final, mean = np.median(self.errors[method, case][phase], axis=0)
        return float(final), float(mean)


def measure_study(seeds: Sequence[int]) -> Study:
    """Every method on every case."""
    errors: dict[tuple[str, str], Array] = {}
    for case, sensor in CASES.items():
        seen = seeds if sensor.noise_m_s2 > 0.0 else seeds[:1]
        for method in (KEY_POINTS, KEY_POINTS_WITH_BIAS):
            errors[method, case] = np.array(
                [
                    [
                        key_point_errors(cubic_steps(case, seed), settings_of(method, case, first))
                        for seed in seen
                    ]
                    for first in PHASES
                ]
            )
        errors[KALMAN, case] = np.array(
            [[kalman_errors(cubic_steps(case, seed, delay_s=delay)) for seed in seen] for delay in DELAYS_S]
        )
    return Study(errors)


def settings_of(method: str, case: str, first: int) -> KeyPointSettings:
    """The study's weights for a case.

    Args:
        method: Name of the method.
        case: Name of the simulated case.
        first: First sample of the windows.
    """
    weights = NOISY_WEIGHTS if case == "noise and drift" else USUAL_WEIGHTS
    settings = KeyPointSettings(first=first, weights=weights)
    return replace(settings, still_s=0.0) if method == KEY_POINTS_WITH_BIAS else settings


def key_points(walk: CubicSteps, settings: KeyPointSettings) -> KeyPointPath:
    """The study's algorithm on a walk."""
    return follow_key_points(walk.specific_force_mps2, walk.angular_velocity_rad_s, RATE_HZ, settings)


def window_truth(walk: CubicSteps, settings: KeyPointSettings) -> Array:
    """(K,) the true x, averaged over each window as the study does."""
    K = (len(walk.time_s) - settings.first) // settings.window
    used = slice(settings.first, settings.first + K * settings.window)
    truth: Array = walk.position_m[used, 0].reshape(K, settings.window).mean(axis=1)
    return truth


def key_point_errors(walk: CubicSteps, settings: KeyPointSettings) -> tuple[float, float]:
    """Final and mean absolute error along x, m."""
    off = np.abs(key_points(walk, settings).position_m[:, 0] - window_truth(walk, settings))
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
