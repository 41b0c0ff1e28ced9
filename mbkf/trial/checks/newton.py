"""Newton's law before a filter imposes it: the wrench that the motion of markers requires less that of the plates."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.io.findings import Finding, judged, not_judged
from mbkf.trial.checks.evidence import Evidence

FORCE, MOMENT = "force that plates lack", "moment that plates lack"

FORCE_BOUND, MOMENT_BOUND = 10.0, 4.0
"""Largest missing force and moment without a warning, % of body weight and % of it times m."""

REST_PERCENT, MOVING_SHARE = 2.5, 0.1
"""Missing force of right captures: a share of body weight, and of the force that accelerates (soft tissue and segments'
masses). Public walks lack 3 to 5 % of body weight, a run 14 %."""

LEVER_CM = 1.5
"""Lever by which whole ground reactions of right captures miss the centre of mass."""

LEAST_S = 0.25
"""Least duration of clear frames."""


def newton_findings(evidence: Evidence) -> tuple[Finding, Finding]:
    """Root mean square of the missing force, % of body weight, and moment about the centre of mass, % of it times m."""
    clear, weight_n = evidence.clear, evidence.weight_n
    if not clear.any():
        clear = evidence.carried
    if clear.sum() < LEAST_S * evidence.rate_hz:
        why = "needs frames in which only feet on plates carry load"
        return (
            not_judged(FORCE, "% BW", FORCE_BOUND, why),
            not_judged(MOMENT, "% BW m", MOMENT_BOUND, why),
        )
    missing = 100.0 * (evidence.asked - evidence.total)[clear] / weight_n
    force, moment = (
        float(np.sqrt((part**2).sum(axis=1).mean())) for part in (missing[:, :3], missing[:, 3:])
    )
    force_sd = 100.0 * expected_force(evidence, clear) / weight_n
    moment_sd = LEVER_CM * float(np.sqrt((evidence.asked[clear, :3] ** 2).sum(axis=1).mean())) / weight_n
    hint = "of markers alone, before a filter imposes Newton's law"
    return (
        judged(FORCE, force, force_sd, "% BW", FORCE_BOUND, hint),
        judged(MOMENT, moment, moment_sd, "% BW m", MOMENT_BOUND, hint),
    )


def expected_force(evidence: Evidence, frames: BoolArray) -> float:
    """Root mean square of the force that a right capture lacks, N.

    Args:
        evidence: Motion and plates.
        frames: (T,) frames that count.
    """
    moves = evidence.asked[frames, :3] - [0.0, 0.0, evidence.weight_n]
    moving = float(np.sqrt((moves**2).sum(axis=1).mean()))
    return float(np.hypot(0.01 * REST_PERCENT * evidence.weight_n, MOVING_SHARE * moving))
