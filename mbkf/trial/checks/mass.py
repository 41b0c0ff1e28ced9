"""The body's mass against its plates: their impulse is that of the weight plus the change of momentum.

Over a stretch from t₀ to t₁ in which plates carry the whole load, ∫ f_z dt = m (g (t₁ − t₀) + ż(t₁) − ż(t₀)). The
height z of the centre of mass does not depend on the mass m, since segments' masses are shares of it. In standing, and
over whole cycles, the velocities cancel.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.findings import Finding, judgement, not_judged
from mbkf.numerics.runs import stretches
from mbkf.trial.checks.evidence import Evidence

NAME = "mass against plates"

BOUND_PERCENT = 5.0
"""Largest difference of masses without a warning."""

SPEED_SD_M_S = 0.03
"""Standard deviation of the vertical speed of the centre of mass from markers. Plates' impulses of steps of 0.6 s in
public walks differ by 0.5 %."""

SCALE_PERCENT = 1.0
"""Difference between plates and a person's scales due to clothes, shoes and calibration (standard deviation)."""

LEAST_S, LEAST_RUN_S = 0.5, 0.25
"""Least duration in all, and of one stretch."""

PART_S, PARTS_PERCENT = 0.5, 4.0
"""Parts of a trial, of about this duration, agree on the mass to this; else something besides the feet carries load."""


def mass_finding(evidence: Evidence, others: BoolArray, plates_agree: bool = True) -> Finding:
    """The mass given over that of the plates, % more.

    Args:
        evidence: Motion and plates.
        others: (T,) frames in or near which parts besides the feet carry load.
        plates_agree: False for plates that contradict each other; the mass is then doubtful at most.
    """
    for frames in (evidence.accounted, evidence.accounted & ~others):
        parts = _parts(frames, evidence.rate_hz)
        if sum(len(part) - 1 for part in parts) < LEAST_S * evidence.rate_hz:
            return undetermined("needs half a second in which only feet on plates carry load")
        impulse, per_kg = np.array([_impulses(evidence, part) for part in parts]).T
        ratio = impulse / per_kg / evidence.mass_kg
        mass_kg = float(impulse.sum() / per_kg.sum())
        spread = float(np.sqrt(np.average((ratio - ratio.mean()) ** 2, weights=per_kg)))
        if spread * evidence.mass_kg <= 0.01 * PARTS_PERCENT * mass_kg:
            return _judged(evidence.mass_kg, mass_kg, per_kg, parts, plates_agree)
    return undetermined(
        f"parts of the trial differ by {100 * spread:.0f} %: "
        "something besides the feet may carry load, or plates differ"
    )


def undetermined(why: str) -> Finding:
    """The check of a capture that does not determine the mass."""
    return not_judged(NAME, "%", BOUND_PERCENT, why)


def _parts(frames: BoolArray, rate_hz: float) -> list[Array]:
    """Stretches cut into parts of one duration, each with the frame at which the next one begins."""
    found = []
    for run in stretches(frames):
        seconds = (len(run) - 1) / rate_hz
        if seconds >= LEAST_RUN_S:
            cuts = np.linspace(0, len(run) - 1, max(1, round(seconds / PART_S)) + 1).round().astype(int)
            found += [run[first : last + 1] for first, last in pairwise(cuts)]
    return found


def _impulses(evidence: Evidence, part: Array) -> tuple[float, float]:
    """Vertical impulse of the plates over a part, N s, and of a body of 1 kg."""
    force = evidence.raw[part, :, 2].sum(axis=1)
    given = (force.sum() - 0.5 * (force[0] + force[-1])) / evidence.rate_hz
    lasting_s = (len(part) - 1) / evidence.rate_hz
    speeds = evidence.momentum[part[[0, -1]], 2] / evidence.mass_kg
    return float(given), float(GRAVITY_M_S2 * lasting_s + speeds[1] - speeds[0])


def _judged(
    stated_kg: float, mass_kg: float, per_kg: Array, parts: list[Array], plates_agree: bool
) -> Finding:
    """The verdict on a mass.

    Args:
        stated_kg: The mass that the body was given.
        mass_kg: That of the plates.
        per_kg: (n,) impulses of a body of 1 kg by part.
        parts: The parts; the velocity at a frame that ends one and begins another cancels.
        plates_agree: False for plates that contradict each other.
    """
    breaks = 1 + sum(a[-1] != b[0] for a, b in pairwise(parts))
    speeds = 100.0 * SPEED_SD_M_S * np.sqrt(2.0 * breaks) / per_kg.sum()
    sd = float(np.hypot(speeds, SCALE_PERCENT))
    percent = 100.0 * (stated_kg / mass_kg - 1.0)
    verdict = judgement(percent, sd, BOUND_PERCENT)
    if verdict == "outside" and not plates_agree:
        hint = f"the plates give {mass_kg:.1f} kg instead of {stated_kg:.1f}, but contradict each other"
        return Finding(NAME, percent, sd, "%", BOUND_PERCENT, "doubtful", hint)
    hint = f"the plates give {mass_kg:.1f} kg, the subject has {stated_kg:.1f} kg"
    if verdict == "outside":
        hint += f"; scale with --mass {mass_kg:.1f} or --mass auto, or check the plates' units and gains"
    return Finding(NAME, percent, sd, "%", BOUND_PERCENT, verdict, hint, mass_kg)
