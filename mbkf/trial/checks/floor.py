"""The height of the soles against the surfaces of the plates that they stand on."""

from __future__ import annotations

import numpy as np

from mbkf.io.findings import Finding, judged, not_judged
from mbkf.model.body import Body
from mbkf.sensors.contact.plates import centres_of_pressure, surface_height
from mbkf.sensors.contact.rules import REACH_M, SOLE_ENDS
from mbkf.sensors.contact.soles import distances_to_soles, sole_points
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.preparation.markers_alone import Motion

NAME = "soles against plates' surfaces"

BOUND_MM, SOLE_MM = 30.0, 12.0
"""Largest height of soles over a plate without a warning, and standard deviation due to shoes and scaled feet."""

LOADED_SHARE = 0.3
"""A foot stands on a plate that carries more than this share of body weight."""

LEAST_S = 0.1
"""Least duration of a foot on a plate."""


def floor_finding(evidence: Evidence, model: Body, motion: Motion) -> Finding:
    """Height of the soles above the plate that they stand on, mm; the largest over the plates.

    Args:
        evidence: Plates.
        model: The body.
        motion: Its motion.
    """
    soles = sole_points(model, motion.q)
    lowest = soles[:, :, :SOLE_ENDS, 2].min(axis=2)
    above = []
    for p, plate in enumerate(evidence.plates):
        wrench, surface = np.nan_to_num(evidence.raw[:, p]), surface_height(plate)
        pressed = centres_of_pressure(wrench, surface, LOADED_SHARE * evidence.weight_n)
        away = distances_to_soles(pressed, soles)
        stands = (away <= REACH_M) & (away <= away.min(axis=1, keepdims=True))
        if stands.sum() >= LEAST_S * evidence.rate_hz:
            above.append((1e3 * float(np.median(lowest[stands]) - surface), plate.name))
    if not above:
        return not_judged(NAME, "mm", BOUND_MM, "needs a foot that stands on a plate")
    off_mm, name = max(above, key=lambda one: abs(one[0]))
    hint = f"they lie {abs(off_mm):.0f} mm {'above' if off_mm > 0 else 'below'} plate '{name}'"
    remedy = ": check for thick shoes, a wrong height of the plate, or badly scaled feet"
    return judged(NAME, off_mm, SOLE_MM, "mm", BOUND_MM, hint, remedy)
