"""Clocks of markers and plates: the delay of the plates' forces behind those that the motion requires.

The plates are shifted against the markers. Each component of their force is fitted with a gain of its own, so that
mass, units and turned plates do not matter, and is weighted by its smallest misfit; the shift lies at the vertex of the
parabola through the least misfits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding, judged, not_judged
from mbkf.io.records import PlateReadings
from mbkf.numerics.printed import rounded
from mbkf.trial.checks.evidence import Evidence

NAME = "clocks of markers and plates"

BOUND_MS = 8.0
"""Largest delay without a warning: half a frame at 60 Hz."""

BODY_MS = 2.0
"""Apparent delay of scaled bodies in long trials (public walks and runs: 0 to 2 ms)."""

SEARCH_S, STEP_S = 0.08, 0.01
"""Largest shift that is tried, and its steps."""

LEAST_SD_MS = 15.0
"""A delay with a larger standard deviation is not judged, as in quiet standing."""

LEAST_S = 0.4
"""Least duration of clear frames."""

NOISE_S = 0.1
"""Correlation time of the difference between motion and plates."""


def clock_finding(evidence: Evidence) -> Finding:
    """Delay of the plates, ms."""
    enough = LEAST_S * evidence.rate_hz
    shifts = np.arange(-SEARCH_S, SEARCH_S + 0.5 * STEP_S, STEP_S)
    plates = together(evidence.plates)
    given = [evidence.gives(delayed(plates, -shift))[:, :, :3].sum(axis=1) for shift in shifts]
    known = evidence.clear & ~np.isnan(given).any(axis=(0, 2))
    if known.sum() < enough:
        return not_judged(NAME, "ms", BOUND_MS, "needs half a second in which only feet on plates carry load")
    asked = evidence.asked[known, :3]
    misfits = np.array([_misfits(asked, one[known]) for one in given])
    misfit = misfits.sum(axis=1)
    # Each component is weighted by its least residual.
    misfit = (misfits / np.maximum(misfits[misfit.argmin()], 1e-12)).mean(axis=1)
    best = int(misfit.argmin())
    if best in (0, len(shifts) - 1):
        return not_judged(NAME, "ms", BOUND_MS, "no shift of the plates makes them fit the motion")
    below, at, above = misfit[best - 1 : best + 2]
    curve = below - 2.0 * at + above
    lag_s = float(shifts[best] + 0.5 * STEP_S * (below - above) / curve)
    independent = max(3.0 * known.sum() / (NOISE_S * evidence.rate_hz), 1.0)
    sd_ms = 1e3 * STEP_S * float(np.sqrt(2.0 * at / curve / independent))
    if sd_ms > LEAST_SD_MS:
        return not_judged(NAME, "ms", BOUND_MS, "needs movement, as in walking, squats or jumps")
    hint = f"plates are {rounded(abs(1e3 * lag_s))} ms {'late' if lag_s > 0 else 'early'}"
    remedy = ": shift them, or look for a filter or a trigger that delays them"
    return judged(NAME, 1e3 * lag_s, float(np.hypot(sd_ms, BODY_MS)), "ms", BOUND_MS, hint, remedy)


def delayed(plates: tuple[PlateReadings, ...], seconds: float) -> tuple[PlateReadings, ...]:
    """The plates with their readings this much later."""
    return tuple(replace(plate, start_time_s=plate.start_time_s + seconds) for plate in plates)


def together(plates: tuple[PlateReadings, ...]) -> tuple[PlateReadings, ...]:
    """One plate per clock with the summed force of its plates, to be shifted once; its moment has no meaning."""
    sharing: dict[tuple[float, float, int], list[PlateReadings]] = {}
    for plate in plates:
        sharing.setdefault((plate.rate_hz, plate.start_time_s, len(plate.force_n)), []).append(plate)
    return tuple(
        replace(own[0], force_n=np.sum([plate.force_n for plate in own], axis=0)) for own in sharing.values()
    )


def _misfits(asked: Array, given: Array) -> Array:
    """(3,) mean squares of required forces (n, 3) less given ones (n, 3) times the gains that fit best."""
    centred, other = asked - asked.mean(axis=0), given - given.mean(axis=0)
    shared = (centred * other).sum(axis=0) ** 2 / np.maximum((other**2).sum(axis=0), 1e-12)
    return np.asarray(((centred**2).sum(axis=0) - shared) / len(asked))
