"""How a step's time grows with markers and plates."""

from __future__ import annotations

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.speed.steps import STEP, dynamic_times
from benchmarks.speed.walks import synthetic, with_plates

MARKERS, PLATES = (40, 80, 160), (1, 2, 4)
SLOPE = 0.3
"""Bound of what forty markers more cost, P."""

LINEAR = 1.25
"""Bound of the last over a straight line, for a time is not measured exactly."""


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
    straight = first + 3.0 * (second - first)
    checks.append(Check("step, 160 markers over the line through 40 and 80", third / straight, LINEAR, "<="))
    walk = synthetic(seconds)
    for plates in PLATES:
        value = dynamic_times(with_plates(walk, plates), steps).in_products(STEP)
        checks.append(information(f"step, {plates} plates", value, "P"))
    return checks
