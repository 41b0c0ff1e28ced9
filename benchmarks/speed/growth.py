"""How a step's time grows with markers and plates."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.speed.steps import STEP, dynamic_times
from benchmarks.speed.walks import synthetic, with_plates

MARKERS, PLATES = (40, 80, 160), (1, 2, 4)
SLOPE = 0.3
"""Bound of what forty markers more cost, P."""

LINEAR = 1.25
"""How many times the first forty's cost each further forty may take, for a time is not measured exactly."""


def rows(seconds: float, steps: int) -> list[Check]:
    """A step by number of markers, and by number of plates.

    Args:
        seconds: Length of the walk.
        steps: Least number of steps timed.
    """
    times = {
        markers: dynamic_times(synthetic(seconds, markers), steps).in_products(STEP) for markers in MARKERS
    }
    checks = [information(f"step, {markers} markers", value, "P") for markers, value in times.items()]
    slope = np.polyfit(list(times), list(times.values()), 1)[0]
    checks.append(Check("step, forty markers more", 40.0 * float(slope), SLOPE, "<=", "P"))
    first, second, third = (times[markers] for markers in MARKERS)
    bent = (third - second) / 2.0 / max(second - first, 1e-9) if third > second else 0.0
    worth = math.inf if third - first > SLOPE * 0.2 else None
    if worth is not None:
        checks.append(
            Check("step, forty of the last eighty markers over the forty before", bent, LINEAR, "<=")
        )
    walk = synthetic(seconds)
    for plates in PLATES:
        value = dynamic_times(with_plates(walk, plates), steps).in_products(STEP)
        checks.append(information(f"step, {plates} plates", value, "P"))
    return checks
