"""Errors of Madgwick's filter and of Kalman filters: gains chosen on one person, errors shown on two others.

*Plain EKF* uses what Madgwick's filter uses; *EKF* is mbkf's, which takes a limb's acceleration apart from gravity.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.madgwick.as_printed import madgwick_as_printed
from benchmarks.madgwick.plain_ekf import PlainSettings, plain_ekf
from benchmarks.madgwick.scenes import (
    CHOSEN_ON,
    FOOT,
    MOVEMENTS,
    SHOWN_ON,
    THIGH,
    Scene,
    eight,
    filtered,
    rms_deg,
    scenes,
    truth_of,
)
from mbkf.conventions import Array
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import OrientSettings
from mbkf.imu.orientation_ekf import OrientationSettings
from mbkf.io.imu.readings import ImuReadings

THEIRS = MadgwickSettings(0.35, 0.07)
"""Gains of the source."""

BETAS = (0.005, 0.01, 0.02, 0.03, 0.04, 0.06, 0.1, 0.15, 0.25, 0.35)
DIRECTION_SDS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0)
TUNED, SOURCE, PLAIN, EKF, SMOOTH = (
    "Madgwick, tuned",
    "Madgwick, β 0.35",
    "plain EKF, tuned",
    "EKF",
    "offline",
)
OFF_BY = 4.0
"""Factor by which a tuned setting is wrong where the dependence on it is asked for."""

Filter = Callable[[Sequence[ImuReadings]], list[Array]]


def madgwick(gains: MadgwickSettings) -> Filter:
    """Madgwick's filter with its gains."""
    return _by(OrientSettings("madgwick", madgwick=gains))


def printed(readings: Sequence[ImuReadings]) -> list[Array]:
    """The source's filter and gains by the letter, whose ζ does not integrate."""
    return [madgwick_as_printed(one, THEIRS.beta, THEIRS.zeta, truth_of(one)[0]) for one in readings]


def plain(direction_sd: float) -> Filter:
    """The textbook filter with the spread of its directions."""
    settings = PlainSettings(direction_sd)
    return lambda readings: [plain_ekf(one, settings, truth_of(one)[0]) for one in readings]


def _by(settings: OrientSettings) -> Filter:
    return lambda readings: [course.quaternion for course in filtered(readings, settings)]


OURS = OrientSettings("ekf", ekf=OrientationSettings(integrating=False))
"""mbkf's filter; virtual sensors read the value at their time."""


def pooled(trials: Sequence[Scene], estimate: Filter, sensors: Sequence[str] = (THIGH, FOOT)) -> float:
    """Root mean square error over trials and sensors, degrees.

    Args:
        trials: The trials.
        estimate: The filter.
        sensors: Names of the sensors that count.
    """
    errors = []
    for one in trials:
        readings = [one.sensor(name) for name in sensors]
        errors.append(rms_deg(estimate(readings), readings))
    return float(np.sqrt(np.mean(np.square(errors))))


@dataclass(frozen=True)
class Accuracy:
    """Errors of the filters.

    Attributes:
        beta, direction_sd: Settings of least error on the persons that they were chosen on.
        curve: (β, error deg) of the choice, and of each other movement.
    """

    beta: float
    direction_sd: float
    curve: dict[str, list[tuple[float, float]]]

    @cached_property
    def filters(self) -> dict[str, Filter]:
        """The filters that are compared, by name."""
        return {
            TUNED: madgwick(MadgwickSettings(self.beta)),
            SOURCE: printed,
            PLAIN: plain(self.direction_sd),
            EKF: _by(OURS),
            SMOOTH: _by(OrientSettings("smooth", ekf=OURS.ekf)),
        }

    @cached_property
    def by_movement(self) -> dict[tuple[str, str, str], float]:
        """Error by filter, movement and sensor over the persons shown, degrees."""
        return {
            (name, movement, sensor): pooled(scenes(SHOWN_ON, (movement,)), estimate, (sensor,))
            for name, estimate in self.filters.items()
            for movement in MOVEMENTS
            for sensor in (THIGH, FOOT)
        }

    @cached_property
    def overall(self) -> dict[str, float]:
        """Error by filter over all movements and sensors of the persons shown, degrees."""
        return {
            name: float(np.sqrt(np.mean([e**2 for (of, _, _), e in self.by_movement.items() if of == name])))
            for name in self.filters
        }

    @cached_property
    def with_worse_sensors(self) -> dict[str, float]:
        """Error by filter of the persons shown with all sensors' errors enlarged, degrees; without the smoother."""
        return {
            name: pooled(scenes(SHOWN_ON, worse=True), one)
            for name, one in self.filters.items()
            if name != SMOOTH
        }

    @cached_property
    def wrongly_set(self) -> dict[str, tuple[float, float]]:
        """Errors with the tuned setting too small and too large by :data:`OFF_BY`, degrees."""
        trials = scenes(SHOWN_ON)
        return {
            TUNED: _two(lambda k: pooled(trials, madgwick(MadgwickSettings(k * self.beta)))),
            PLAIN: _two(lambda k: pooled(trials, plain(k * self.direction_sd))),
        }

    @cached_property
    def by_segment(self) -> dict[str, float]:
        """Error of the source's filter by the segment that wears the sensor, walking, persons shown, degrees."""
        walks = [eight(person) for person in SHOWN_ON]
        names = [one.name for one in walks[0].readings]
        return {name: pooled(walks, printed, (name,)) for name in names}


def _two(error: Callable[[float], float]) -> tuple[float, float]:
    return error(1.0 / OFF_BY), error(OFF_BY)


def measure_accuracy() -> Accuracy:
    """Chooses β and the plain filter's spread on one person; all else is measured when it is asked for."""
    trials = scenes(CHOSEN_ON)
    curve = {
        movement: [
            (beta, pooled(scenes(CHOSEN_ON, (movement,)), madgwick(MadgwickSettings(beta)))) for beta in BETAS
        ]
        for movement in MOVEMENTS
    }
    total = [float(np.sqrt(np.mean([one[k][1] ** 2 for one in curve.values()]))) for k in range(len(BETAS))]
    sds = [pooled(trials, plain(sd)) for sd in DIRECTION_SDS]
    curve["all movements"] = list(zip(BETAS, total, strict=True))
    return Accuracy(BETAS[int(np.argmin(total))], DIRECTION_SDS[int(np.argmin(sds))], curve)
