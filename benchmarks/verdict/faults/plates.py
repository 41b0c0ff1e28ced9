"""Faults of plates, clocks and mass, and loads that nothing reads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.loads.faults import STANCE_N, Clock, Fault, Load, Mass, scaled
from benchmarks.verdict.faults.markers import moved
from benchmarks.verdict.recorded import Recorded
from mbkf.io.records import PlateReadings
from mbkf.numerics.runs import runs
from mbkf.trial.checks.order import in_place_of
from mbkf.trial.checks.orientation import laid

GAINS, MASSES, LATE_S = (0.75, 0.8, 1.2, 1.25), (0.85, 1.15), (-0.04, 0.04)
AWAY_M = (0.08, 0.2)
"""Distance of plates from their places."""


def _put(fault: Fault, recorded: Recorded) -> tuple[Recorded, str]:
    capture, subject, _ = fault.put_into(recorded.capture, recorded.subject)
    return replace(recorded, capture=capture, subject=subject), fault.label


def _with_plates(recorded: Recorded, plates: list[PlateReadings]) -> Recorded:
    return replace(recorded, capture=replace(recorded.capture, plates=tuple(plates)))


def _loaded(recorded: Recorded) -> list[int]:
    """Plates by the load that they bear while the capture lasts, the most loaded first."""
    times = recorded.capture.markers.times_s
    borne = [
        float(np.interp(times, one.times_s, np.nan_to_num(one.force_n[:, 2]), 0.0, 0.0).sum())
        for one in recorded.capture.plates
    ]
    return sorted(range(len(borne)), key=lambda p: -borne[p])


def mass(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """The person is said to weigh 15 % more or less."""
    return _put(Mass(MASSES[int(rng.integers(2))]), recorded)


def clock(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Plates are 40 ms late or early."""
    return _put(Clock(LATE_S[int(rng.integers(2))]), recorded)


def turned(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """All plates are turned about the vertical, or mirrored."""
    quarters, mirrored = int(rng.integers(1, 4)), bool(rng.random() < 0.25)
    plates = [laid(one, quarters, mirrored) for one in recorded.capture.plates]
    label = f"by {90 * quarters}°" + (" and mirrored" if mirrored else "")
    return _with_plates(recorded, plates), label


def exchanged(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:  # noqa: ARG001
    """The two plates that bear most are taken for each other."""
    plates = list(recorded.capture.plates)
    a, b = _loaded(recorded)[:2]
    plates[a], plates[b] = in_place_of(plates[a], plates[b]), in_place_of(plates[b], plates[a])
    return _with_plates(recorded, plates), f"{plates[a].name} and {plates[b].name}"


def gain(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """One plate reads 20 or 25 % too much or too little."""
    plates, p = list(recorded.capture.plates), _loaded(recorded)[int(rng.integers(2))]
    factor = GAINS[int(rng.integers(len(GAINS)))]
    plates[p] = scaled(plates[p], np.full(len(plates[p].force_n), factor), np.ones(6))
    return _with_plates(recorded, plates), f"plate {plates[p].name} {100.0 * (factor - 1.0):+.0f} %"


def dead(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """One plate reads nothing."""
    plates, p = list(recorded.capture.plates), _loaded(recorded)[int(rng.integers(2))]
    plates[p] = replace(
        plates[p],
        force_n=np.zeros_like(plates[p].force_n),
        moment_nm=np.zeros_like(plates[p].moment_nm),
        centre_of_pressure_m=np.full_like(plates[p].centre_of_pressure_m, np.nan),
    )
    return _with_plates(recorded, plates), f"plate {plates[p].name}"


def displaced(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """All plates lie elsewhere than the file says."""
    angle, far = float(rng.uniform(0.0, 2.0 * np.pi)), float(rng.uniform(*AWAY_M))
    by = far * np.array([np.cos(angle), np.sin(angle), 0.0])
    return replace(recorded, capture=moved(recorded.capture, by)), f"by {1e3 * far:.0f} mm"


def beside(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """The longest step of the capture stands partly beside its plate."""
    times, plates = recorded.capture.markers.times_s, list(recorded.capture.plates)
    share = float(rng.choice([0.4, 0.6]))
    steps = [
        ((after - first) / one.rate_hz, p, first, after)
        for p, one in enumerate(plates)
        for first, after in runs(
            (one.force_n[:, 2] > STANCE_N) & (one.times_s >= times[0]) & (one.times_s <= times[-1])
        )
    ]
    _, p, first, after = max(steps)
    kept = np.ones(len(plates[p].force_n))
    kept[first:after] = share
    plates[p] = scaled(plates[p], kept, np.ones(6))
    return _with_plates(
        recorded, plates
    ), f"{100.0 * (1.0 - share):.0f} % of a step on plate {plates[p].name}"


def harness(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """A harness bears 15 to 35 % of body weight."""
    return _put(Load("harness", float(rng.uniform(0.15, 0.35)), (0.2, 1.0)), recorded)


def pull(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """A device pulls down with 20 to 60 % of body weight all along."""
    return _put(Load("pull", -float(rng.uniform(0.2, 0.6)), (-1.0, 2.0)), recorded)


def chair(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """A chair without a plate bears half to four fifths of body weight."""
    return _put(Load("chair", float(rng.uniform(0.5, 0.8)), (0.4, 0.8)), recorded)


def box(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """A box of 10 to 20 % of body weight is held for a part of the trial."""
    return _put(Load("box", -float(rng.uniform(0.1, 0.2)), (0.25, 0.85)), recorded)
