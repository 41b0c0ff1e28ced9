"""Plates against each other: the gain of each one's vertical force, from the force that the motion requires.

a_z = Σ_p c_p f_z,p over the frames in which only feet on plates carry load; a plate's gain is 1 / c_p. Its ratio to the
others', which this check judges, does not depend on the mass.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding, judged, not_judged
from mbkf.numerics.printed import percent
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.checks.newton import expected_force

NAME = "plates against plates"

BOUND_PERCENT = 5.0
"""Largest difference of gains without a warning."""

BODY_PERCENT = 1.5
"""Apparent difference due to the scaled masses of the legs."""

LEAST_S = 0.3
"""A plate is compared if it carries most of the load for this long."""

MOST_SD_PERCENT = 4.0
"""A difference with a larger standard deviation is not judged."""

LEAST_SHARE = 0.5
"""Share of the load from which a plate carries most of it."""

NOISE_S = 0.1
"""Correlation time of the difference between motion and plates."""

RCOND = 1e-3
"""Relative singular value below which a hardly loaded plate gets no gain of its own."""

EXPLAINED = 2.0
"""Gains explain the motion if they leave less than this many times the force that right captures lack."""


def gain_finding(evidence: Evidence) -> Finding:
    """Gain of the plate that differs most over that of the others, %."""
    clear = evidence.clear
    vertical = np.where(clear[:, None], evidence.given[:, :, 2], 0.0)
    most = vertical > LEAST_SHARE * np.maximum(vertical.sum(axis=1), 1.0)[:, None]
    enough = (most & clear[:, None]).sum(axis=0) >= LEAST_S * evidence.rate_hz
    if enough.sum() < 2:
        return not_judged(NAME, "%", BOUND_PERCENT, "needs two plates that carry most of the load in turn")
    inverse, covariance = _fitted(vertical[clear], evidence)
    inverse, covariance = inverse[enough], covariance[np.ix_(enough, enough)]
    names = [plate.name for plate, known in zip(evidence.plates, enough, strict=True) if known]
    found = []
    for p in range(len(names)):
        others = np.arange(len(names)) != p
        mean = float(np.median(inverse[others]))
        contrast = np.where(others, -1.0 / others.sum(), 1.0)
        sd = 100.0 * float(np.sqrt(contrast @ covariance @ contrast)) / mean
        found.append((100.0 * float(mean / inverse[p] - 1.0), float(np.hypot(sd, BODY_PERCENT)), names[p]))
    off, sd, name = max(found, key=lambda one: abs(one[0]) / one[1])
    if sd > MOST_SD_PERCENT:
        return not_judged(NAME, "%", BOUND_PERCENT, f"the motion determines gains to {sd:.0f} % only")
    hint = f"plate '{name}' reads {percent(abs(off) / 100.0)} {'more' if off > 0 else 'less'} than the others"
    remedy = ": check the gains and units of both" if len(names) == 2 else ": check its gain and unit"
    return judged(NAME, off, sd, "%", BOUND_PERCENT, hint, remedy)


def _fitted(vertical: Array, evidence: Evidence) -> tuple[Array, Array]:
    """(P,) inverse gains and their covariance, from the plates' vertical forces in clear frames (n, P)."""
    asked = evidence.asked[evidence.clear, 2]
    inverse = np.linalg.lstsq(vertical, asked, rcond=RCOND)[0]
    left = asked - vertical @ inverse
    variance = float(left @ left) / len(left) * NOISE_S * evidence.rate_hz
    return np.asarray(inverse), np.asarray(variance * np.linalg.pinv(vertical.T @ vertical, rcond=RCOND**2))


def explained(evidence: Evidence) -> bool:
    """True if plates with a gain each give the whole vertical force that the motion requires.

    The apparent load on a seat or a hand is then that of a plate that reads too little.
    """
    clear = evidence.clear
    if clear.sum() < LEAST_S * evidence.rate_hz:
        return False
    vertical, asked = evidence.given[clear, :, 2], evidence.asked[clear, 2]
    inverse = np.linalg.lstsq(vertical, asked, rcond=RCOND)[0]
    left = float(np.sqrt(np.mean((asked - vertical @ inverse) ** 2)))
    return left < EXPLAINED * expected_force(evidence, clear)
