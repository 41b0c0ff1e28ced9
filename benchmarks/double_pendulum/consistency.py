"""Consistency of the filter: NEES and NIS on motions drawn from its own plant (thesis 2.3.1).

A trial starts as `sin` does, from an error that P_0 expects, under efforts that really wander by σ_P; its markers and
plate have exactly the noise of the filter's settings. Efforts that nothing steers let the bars tumble, so a trial
lasts a second.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.double_pendulum.laboratory import Laboratory
from benchmarks.double_pendulum.motions import (
    MARKER_BARS,
    MARKER_SHARES,
    RATE_HZ,
    PendulumReadings,
    pendulum_motion,
)
from benchmarks.double_pendulum.pendulum import DoublePendulum
from benchmarks.double_pendulum.thesis import STUDY
from benchmarks.double_pendulum.torque import START_VARIANCE, PendulumFilter, PendulumSettings
from benchmarks.thesis_report.contents import Band, Findings, Sheet
from mbkf.conventions import Array
from mbkf.filters.torque.integrators import INTEGRATORS, Motion
from mbkf.filters.torque.plant import Scheme
from mbkf.filters.torque.settings import SCHEMES
from mbkf.numerics.threads import single_threaded

SEEDS, QUICK_SEEDS = 200, 10
FRAMES, SUBSTEPS = 100, 5
LOW_NOISE = PendulumSettings(effort_noise=0.4, residual_noise=None, force_n=0.05, moment_nm=0.05)
"""Table A.1's noise, here of filter and truth alike."""

STATE_DOF, READING_DOF = 12, 11

SCHEMES_COMPARED = {
    "RK4, mean F, Van Loan": Scheme("RK4", mean_slope=True),
    "FD": SCHEMES["FD"],
    "FDMC": SCHEMES["FDMC"],
}


@dataclass(frozen=True)
class Consistency:
    """Normalised errors of one trial: ``nees`` and ``nis`` (FRAMES,)."""

    nees: Array
    nis: Array


@dataclass(frozen=True)
class _Truth:
    """A motion by frames: ``q``, ``v`` and ``u`` (…, 4)."""

    q: Array
    v: Array
    u: Array


def measure_consistency(lab: Laboratory) -> dict[str, list[Consistency]]:
    """Every scheme on the same trials."""
    trials = lab.spread("Consistency", consistency_of, range(QUICK_SEEDS if lab.quick else SEEDS))
    return {name: [trial[name] for trial in trials] for name in SCHEMES_COMPARED}


def consistency_findings(found: dict[str, list[Consistency]]) -> Findings:
    """Means over trials and frames, beside the 95 % bands of 200 trials."""
    nees, nis = (
        {name: float(np.mean([getattr(one, key) for one in trials])) for name, trials in found.items()}
        for key in ("nees", "nis")
    )
    exact = next(iter(SCHEMES_COMPARED))
    row = f"consistency, {exact}"
    bands = [
        Band(row, "NEES (12 dof)", nees[exact], 11.33, 12.69),
        Band(row, "NIS (11 dof)", nis[exact], 10.36, 11.66),
    ]
    cells = tuple((name, nees[name], nis[name]) for name in found)
    title = f"Consistency at matched low noise, means over {len(found[exact])} trials of a second"
    note = (
        "12 and 11 are due. With noise this low the error of a step counts: FD keeps to the band for some 0.3 s, "
        "until the bars tumble quickly, FDMC not at all."
    )
    return Findings(bands, [Sheet("consistency", title, ("scheme", "NEES", "NIS"), cells, note)])


def consistency_of(seed: int) -> dict[str, Consistency]:
    """Every scheme on one trial."""
    rng = np.random.default_rng(seed)
    start = pendulum_motion("sin", STUDY, seconds=1.0 / RATE_HZ)
    begin = _Truth(start.q, start.v, start.efforts)
    with single_threaded():
        truth = _drawn(begin, rng)
        body, noise = DoublePendulum(STUDY, residual=False), LOW_NOISE
        where = [body.on_bars(q, MARKER_SHARES, MARKER_BARS).positions_m for q in truth.q]
        markers = np.stack(where) + noise.marker_m * rng.normal(size=(FRAMES + 1, 8))
        sd = np.array([noise.moment_nm, noise.force_n, noise.force_n, noise.moment_nm])
        read = PendulumReadings(markers, truth.u + sd * rng.normal(size=(FRAMES + 1, 4)))
        return {name: _followed(begin, truth, read, scheme) for name, scheme in SCHEMES_COMPARED.items()}


def _followed(begin: _Truth, truth: _Truth, read: PendulumReadings, scheme: Scheme) -> Consistency:
    """One scheme on a drawn motion; frames after a breakdown are infinite."""
    kalman = PendulumFilter(STUDY, 1.0 / RATE_HZ, replace(LOW_NOISE, scheme=scheme))
    nees, nis = np.full(FRAMES, np.inf), np.full(FRAMES, np.inf)
    state = kalman.start(begin.q[0], begin.v[0], begin.u[0])
    for t in range(1, FRAMES + 1):
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                step = kalman.step(state, read.markers_m[t], read.efforts[t])
        except (np.linalg.LinAlgError, ValueError):
            break
        state = step.state
        error = np.concatenate([state.q - truth.q[t], state.v - truth.v[t], state.u - truth.u[t]])
        nees[t - 1], nis[t - 1] = error @ np.linalg.solve(state.P, error), step.nis
    return Consistency(nees, nis)


def _drawn(begin: _Truth, rng: np.random.Generator) -> _Truth:
    """Motion under efforts that are a Wiener process, linear within a sub-step."""
    body, h = DoublePendulum(STUDY, residual=False), 1.0 / (RATE_HZ * SUBSTEPS)
    sd = np.sqrt(START_VARIANCE[:3])
    now = Motion(begin.q[0] + sd[0] * rng.normal(size=4), begin.v[0] + sd[1] * rng.normal(size=4))
    u = begin.u[0] + sd[2] * rng.normal(size=4)
    path = [(now.q, now.v, u)]
    for _ in range(FRAMES):
        for _ in range(SUBSTEPS):
            later = u + LOW_NOISE.effort_noise * np.sqrt(h) * rng.normal(size=4)
            now, u = INTEGRATORS["RK4"](body, now, 0.5 * (u + later), h), later
        path.append((now.q, now.v, u))
    return _Truth(*(np.stack(part) for part in zip(*path, strict=True)))
