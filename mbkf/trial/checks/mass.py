"""The body's mass against its plates: their impulse is that of the weight plus the change of momentum.

Over a stretch from t₀ to t₁ in which plates carry the whole load, ∫ f_z dt = m (g (t₁ − t₀) + ż(t₁) − ż(t₀)). The
height z of the centre of mass does not depend on the mass m, since segments' masses are shares of it. In standing, and
over whole cycles, the velocities cancel.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.findings import Finding, judgement, not_judged
from mbkf.numerics.printed import percent
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

UNLOADED_SHARE = 0.02
"""Share of the body's weight below which plates read no load."""

SUPPORTED_SHARE = 0.5
"""Share of the weight that something else has to carry, on average over a stretch in which plates read no load, for
the person to stand beside them (on a box, say): in flight it is 0, on a support 1. Speeds may err by two sd each.
Set on a landing from a box (landings)."""


@dataclass(frozen=True)
class VerticalLoads:
    """Vertical force and motion of a trial.

    Attributes:
        rate_hz: Frame rate.
        mass_kg: The mass that is judged.
        force_n: (T,) vertical force of all plates.
        speed_m_s: (T,) vertical speed of the centre of mass.
        accounted: (T,) frames in which plates carry the whole load.
        speed_sd_m_s: Standard deviation of that speed.
        part_s: Duration of parts that have to agree.
    """

    rate_hz: float
    mass_kg: float
    force_n: Array
    speed_m_s: Array
    accounted: BoolArray
    speed_sd_m_s: float = SPEED_SD_M_S
    part_s: float = PART_S


def mass_finding(evidence: Evidence, others: BoolArray, plates_agree: bool = True) -> Finding:
    """The mass given over that of the plates, % more.

    Args:
        evidence: Motion and plates.
        others: (T,) frames in or near which parts besides the feet carry load.
        plates_agree: False for plates that contradict each other; the mass is then doubtful at most.
    """
    loads = VerticalLoads(
        evidence.rate_hz,
        evidence.mass_kg,
        evidence.raw[:, :, 2].sum(axis=1),
        evidence.momentum[:, 2] / evidence.mass_kg,
        evidence.accounted,
    )
    return impulse_finding(loads, others, plates_agree)


def impulse_finding(loads: VerticalLoads, others: BoolArray, plates_agree: bool = True) -> Finding:
    """The mass given over that of the impulse, % more.

    Args:
        loads: Force and motion.
        others: (T,) frames in or near which parts besides the feet carry load.
        plates_agree: False for plates that contradict each other; the mass is then doubtful at most.
    """
    accounted = loads.accounted & ~_supported_elsewhere(loads)
    for frames in (accounted, accounted & ~others):
        parts = _parts(frames, loads)
        if sum(len(part) - 1 for part in parts) < LEAST_S * loads.rate_hz:
            return undetermined("needs half a second in which only feet on plates carry load")
        impulse, per_kg = np.array([_impulses(loads, part) for part in parts]).T
        ratio = impulse / per_kg / loads.mass_kg
        mass_kg = float(impulse.sum() / per_kg.sum())
        spread = float(np.sqrt(np.average((ratio - ratio.mean()) ** 2, weights=per_kg)))
        if spread * loads.mass_kg <= 0.01 * PARTS_PERCENT * mass_kg:
            return _judged(loads, mass_kg, per_kg, parts, plates_agree)
    low, high = loads.mass_kg * ratio.min(), loads.mass_kg * ratio.max()
    return undetermined(
        f"parts of the trial give {low:.1f} to {high:.1f} kg, {mass_kg:.1f} kg in all (spread "
        f"{percent(spread * loads.mass_kg / mass_kg, 1)}, at most {PARTS_PERCENT:g} %): "
        "something besides the feet may carry load, or plates differ"
    )


def undetermined(why: str) -> Finding:
    """The check of a capture that does not determine the mass."""
    return not_judged(NAME, "%", BOUND_PERCENT, why)


def _supported_elsewhere(loads: VerticalLoads) -> BoolArray:
    """(T,) frames of stretches in which plates read no load, but the person does not fall either."""
    found = np.zeros(len(loads.force_n), dtype=bool)
    weight_n = GRAVITY_M_S2 * loads.mass_kg
    for run in stretches(loads.accounted & (np.abs(loads.force_n) < UNLOADED_SHARE * weight_n)):
        fallen_m_s = GRAVITY_M_S2 * (len(run) - 1) / loads.rate_hz
        _, per_kg = _impulses(loads, run)
        found[run] = per_kg - 2.0 * np.sqrt(2.0) * loads.speed_sd_m_s > SUPPORTED_SHARE * fallen_m_s
    return found


def _parts(frames: BoolArray, loads: VerticalLoads) -> list[Array]:
    """Stretches cut into parts of one duration, each with the frame at which the next one begins."""
    found = []
    for run in stretches(frames):
        seconds = (len(run) - 1) / loads.rate_hz
        if seconds >= LEAST_RUN_S:
            cuts = np.linspace(0, len(run) - 1, max(1, round(seconds / loads.part_s)) + 1).round().astype(int)
            found += [run[first : last + 1] for first, last in pairwise(cuts) if last > first]
    return found


def _impulses(loads: VerticalLoads, part: Array) -> tuple[float, float]:
    """Vertical impulse of the plates over a part, N s, and of a body of 1 kg."""
    force = loads.force_n[part]
    given = (force.sum() - 0.5 * (force[0] + force[-1])) / loads.rate_hz
    lasting_s = (len(part) - 1) / loads.rate_hz
    speeds = loads.speed_m_s[part[[0, -1]]]
    return float(given), float(GRAVITY_M_S2 * lasting_s + speeds[1] - speeds[0])


def _judged(
    loads: VerticalLoads, mass_kg: float, per_kg: Array, parts: list[Array], plates_agree: bool
) -> Finding:
    """The verdict on a mass.

    Args:
        loads: Force and motion, with the mass that is judged.
        mass_kg: That of the plates.
        per_kg: (n,) impulses of a body of 1 kg by part.
        parts: The parts; the velocity at a frame that ends one and begins another cancels.
        plates_agree: False for plates that contradict each other.
    """
    stated_kg = loads.mass_kg
    breaks = 1 + sum(a[-1] != b[0] for a, b in pairwise(parts))
    speeds = 100.0 * loads.speed_sd_m_s * np.sqrt(2.0 * breaks) / per_kg.sum()
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
