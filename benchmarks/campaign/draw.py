"""A random trial by its seed: a short motion of a random person, and what spoils its capture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.errors import NotConverged
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject
from mbkf.synthesis.capture import CaptureSettings, SyntheticCapture
from mbkf.trial.synth import synthesise

SECONDS, RATE_HZ = {"walk": (2.0, 2.5), "jump": (2.4, 2.9), "squat": (2.0, 2.5)}, (60, 250)
"""Shortest and longest of each motion, s; and camera rates."""
CAMERAS_M, SKIN_M, OCCLUSION = (0.0005, 0.003), (0.0, 0.006), (0.0, 0.3)
PLATES = ("whole", "whole", "late", "missing")
"""Of every four trials two have whole plates, one has plates that start inside it, one has none."""

LATE_S = (0.2, 1.2)
SPOILT = 0.3
"""Share of the trials with exchanged labels, and of those with dropped frames."""

EXCHANGED_S, DROPPED_S, MOST_STREAKS = (0.05, 0.5), (0.01, 0.15), 3
OTHER_PERSON = 1_000_000
"""Added to the seed where that person cannot perform the motion."""


@dataclass(frozen=True)
class Drawn:
    """What a seed stands for.

    Attributes:
        seed: The seed.
        motion: Name of the motion.
        seconds, rate_hz: Duration and camera rate.
        errors: Errors of the instruments.
        plates: One of :data:`PLATES`.
        late_s: When late plates start, s.
        exchanges: (from_s, to_s) in which two markers bear each other's names.
        drops: (from_s, to_s) in which all markers are missing.
    """

    seed: int
    motion: str
    seconds: float
    rate_hz: float
    errors: CaptureSettings
    plates: str
    late_s: float
    exchanges: tuple[tuple[float, float], ...]
    drops: tuple[tuple[float, float], ...]

    def __str__(self) -> str:
        e = self.errors
        return (
            f"{self.motion} {self.seconds:.2f} s at {self.rate_hz:.0f} Hz, noise {1e3 * e.markers_sd_m:.1f} mm, "
            f"skin {1e3 * e.skin_sd_m:.1f} mm, hidden {e.occlusion:.0%}, plates {self.plates}, "
            f"{len(self.exchanges)} exchanged, {len(self.drops)} dropped"
        )


def drawn(seed: int) -> Drawn:
    """The trial of a seed; always the same."""
    rng = np.random.default_rng([seed, 7])
    motion = tuple(SECONDS)[rng.integers(len(SECONDS))]
    seconds = float(rng.uniform(*SECONDS[motion]))
    return Drawn(
        seed,
        motion,
        seconds,
        float(rng.integers(RATE_HZ[0], RATE_HZ[1] + 1)),
        CaptureSettings(
            markers_sd_m=float(rng.uniform(*CAMERAS_M)),
            skin_sd_m=float(rng.uniform(*SKIN_M)),
            occlusion=float(rng.uniform(*OCCLUSION)),
            ghosts=0,
        ),
        PLATES[rng.integers(len(PLATES))],
        float(rng.uniform(*LATE_S)),
        _windows(rng, seconds, EXCHANGED_S),
        _windows(rng, seconds, DROPPED_S),
    )


def _windows(
    rng: np.random.Generator, seconds: float, length_s: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    """Windows of a trial, s; none in most trials."""
    count = int(rng.integers(1, MOST_STREAKS + 1)) if rng.uniform() < SPOILT else 0
    begins = rng.uniform(0.0, seconds, count)
    return tuple((float(at), float(at + rng.uniform(*length_s))) for at in begins)


def made(one: Drawn) -> tuple[Subject, SyntheticCapture]:
    """The person, and the spoilt capture with its truth.

    Raises:
        NotConverged: Ten persons cannot perform the motion.
    """
    failure: NotConverged | None = None
    for other in range(10):
        try:
            person, capture = synthesise(
                one.motion,
                seconds=one.seconds,
                seed=one.seed + other * OTHER_PERSON,
                rate_hz=one.rate_hz,
                settings=one.errors,
                varied=True,
            )
            return person, replace(capture, trial=spoilt(capture.trial, one))
        except NotConverged as error:
            failure = error
    assert failure is not None
    raise failure


def spoilt(trial: Capture, one: Drawn) -> Capture:
    """A trial with exchanged labels, dropped frames, and plates late or missing."""
    rng = np.random.default_rng([one.seed, 8])
    markers, positions = trial.markers, trial.markers.positions_m.copy()

    def frames(window: tuple[float, float]) -> slice:
        return slice(*(round(at * markers.rate_hz) for at in window))

    for window in one.exchanges:
        first, second = rng.choice(len(markers.names), 2, replace=False)
        positions[frames(window), [first, second]] = positions[frames(window), [second, first]]
    for window in one.drops:
        positions[frames(window)] = np.nan
    plates: dict[str, Callable[[], tuple[PlateReadings, ...]]] = {
        "whole": lambda: trial.plates,
        "late": lambda: tuple(begun(plate, one.late_s) for plate in trial.plates),
        "missing": tuple,
    }
    moved = MarkerTrajectories(markers.names, positions, markers.rate_hz, markers.start_time_s)
    return replace(trial, markers=moved, plates=plates[one.plates]())


def begun(plate: PlateReadings, at_s: float) -> PlateReadings:
    """A plate whose recording starts at a time, s, or with its first sample after it."""
    late = plate.times_s >= at_s
    return replace(
        plate,
        start_time_s=float(plate.times_s[late][0]) if late.any() else at_s,
        force_n=plate.force_n[late],
        moment_nm=plate.moment_nm[late],
        centre_of_pressure_m=plate.centre_of_pressure_m[late],
    )
