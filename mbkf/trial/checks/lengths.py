"""Left against right: the scale factors that limbs of a person were given on both sides."""

from __future__ import annotations

import math

from mbkf.io.findings import Finding, judged, not_judged
from mbkf.io.subject import Subject
from mbkf.model.sides import mirrored

NAME = "left against right lengths"

BOUND_PERCENT, PERSON_PERCENT = 6.0, 1.5
"""Largest difference of limbs without a warning, and standard deviation of that of healthy persons."""


def length_finding(subject: Subject) -> Finding:
    """Right length over left, % more, of the limb that differs most."""
    factors, errors = subject.scale_factors, _standard_errors(subject)
    found = []
    for name, right in factors.items():
        other = mirrored(name)
        if not name.startswith("right_") or "width" in name or other not in factors:
            continue
        percent = 100.0 * (right / factors[other] - 1.0)
        sd = 100.0 * math.hypot(errors.get(name, 0.0) / right, errors.get(other, 0.0) / factors[other])
        found.append((percent, math.hypot(sd, PERSON_PERCENT), name.removeprefix("right_").replace("_", " ")))
    if not found:
        return not_judged(NAME, "%", BOUND_PERCENT, "the body has one scale factor for both sides")
    percent, sd, limb = max(found, key=lambda one: abs(one[0]) / one[1])
    hint = f"the right {limb} is scaled {abs(percent):.1f} % {'longer' if percent > 0 else 'shorter'} than the left"
    return judged(NAME, percent, sd, "%", BOUND_PERCENT, hint, ": check the markers of both")


def _standard_errors(subject: Subject) -> dict[str, float]:
    """Standard error by scale factor, where the subject's report has them."""
    table = subject.report.get("factors")
    if not isinstance(table, dict):
        return {}
    return {name: float(entry["standard_error"]) for name, entry in table.items()}
