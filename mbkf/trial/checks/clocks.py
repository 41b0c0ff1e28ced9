"""Clocks of markers and plates: the delay of the plates' forces behind what the motion asks for.

The plates are shifted against the markers. Each component of their force is fitted with a gain of its own, so that
mass, units and turned plates do not matter, and counts by how well it fits at best; the shift lies at the vertex of the
parabola through the least misfits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding, judgement, not_judged
from mbkf.io.records import PlateReadings
from mbkf.trial.checks.evidence import Evidence

NAME = "clocks of markers and plates"

BOUND_MS = 8.0
"""Plates later or earlier than this are told: half a frame at 60 Hz."""

BODY_MS = 2.0
"""What scaled bodies seem to be late or early by in long trials (public walks and runs: 0 to 2 ms)."""

SEARCH_S, STEP_S = 0.08, 0.01
"""How far plates are shifted, and by which steps."""

LEAST_SD_MS = 15.0
"""A delay that is known no better is not judged: quiet standing tells none."""

LEAST_S = 0.4
"""Duration that is needed."""

NOISE_S = 0.1
"""Time over which what motion and plates differ by stays alike."""


def clock_finding(evidence: Evidence) -> Finding:
    """How late the plates are, ms."""
    enough = LEAST_S * evidence.rate_hz
    shifts = np.arange(-SEARCH_S, SEARCH_S + 0.5 * STEP_S, STEP_S)
    plates = together(evidence.plates)
    given = [evidence.gives(delayed(plates, -shift))[:, :, :3].sum(axis=1) for shift in shifts]
    known = evidence.clear & ~np.isnan(given).any(axis=(0, 2))
    if known.sum() < enough:
        return _not_judged("needs half a second in which only feet on plates bear")
    asked = evidence.asked[known, :3]
    misfits = np.array([_misfits(asked, one[known]) for one in given])
    misfit = misfits.sum(axis=1)
    # Each component counts by what is left of it at best.
    misfit = (misfits / np.maximum(misfits[misfit.argmin()], 1e-12)).mean(axis=1)
    best = int(misfit.argmin())
    if best in (0, len(shifts) - 1):
        return _not_judged("no shift of the plates makes them fit the motion")
    below, at, above = misfit[best - 1 : best + 2]
    curve = below - 2.0 * at + above
    lag_s = float(shifts[best] + 0.5 * STEP_S * (below - above) / curve)
    independent = max(3.0 * known.sum() / (NOISE_S * evidence.rate_hz), 1.0)
    sd_ms = 1e3 * STEP_S * float(np.sqrt(2.0 * at / curve / independent))
    if sd_ms > LEAST_SD_MS:
        return _not_judged("needs movement, as in walking, squats or jumps")
    return _told(1e3 * lag_s, float(np.hypot(sd_ms, BODY_MS)))


def delayed(plates: tuple[PlateReadings, ...], seconds: float) -> tuple[PlateReadings, ...]:
    """Plates whose readings come so much later."""
    return tuple(replace(plate, start_time_s=plate.start_time_s + seconds) for plate in plates)


def together(plates: tuple[PlateReadings, ...]) -> tuple[PlateReadings, ...]:
    """For each clock, one plate with the force of all that share it, to be shifted once; its moment tells nothing."""
    sharing: dict[tuple[float, float, int], list[PlateReadings]] = {}
    for plate in plates:
        sharing.setdefault((plate.rate_hz, plate.start_time_s, len(plate.force_n)), []).append(plate)
    return tuple(
        replace(own[0], force_n=np.sum([plate.force_n for plate in own], axis=0)) for own in sharing.values()
    )


def _misfits(asked: Array, given: Array) -> Array:
    """(3,) mean squares of what is asked for (n, 3) less what is given (n, 3) times the gains that fit best."""
    centred, other = asked - asked.mean(axis=0), given - given.mean(axis=0)
    shared = (centred * other).sum(axis=0) ** 2 / np.maximum((other**2).sum(axis=0), 1e-12)
    return np.asarray(((centred**2).sum(axis=0) - shared) / len(asked))


def _not_judged(why: str) -> Finding:
    return not_judged(NAME, "ms", BOUND_MS, why)


def _told(lag_ms: float, sd_ms: float) -> Finding:
    verdict = judgement(lag_ms, sd_ms, BOUND_MS)
    hint = f"plates are {abs(lag_ms):.0f} ms {'late' if lag_ms > 0 else 'early'}"
    if verdict == "outside":
        hint += ": shift them, or look for a filter or a trigger that delays them"
    return Finding(NAME, lag_ms, sd_ms, "ms", BOUND_MS, verdict, hint)
