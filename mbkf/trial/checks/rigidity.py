"""Markers of one segment against each other: their distances stay, up to the movement of skin.

The check uses the segments that carry the markers, no body and no filter.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding, judged, not_judged
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject

NAME = "markers stay on their segments"

BOUND_MM = 30.0
"""Largest standard deviation of distances without a warning."""

SKIN_MM = 6.0
"""Least standard deviation of a distance, due to skin."""

LEAST_FRAMES = 20
"""Least number of frames in which two markers are seen together."""

TAIL_PERCENT, TAIL_SD = 5.0, 1.645
"""The spread is taken between these percentiles, so that few exchanged frames do not raise it."""


def rigidity_finding(markers: MarkerTrajectories, subject: Subject) -> Finding:
    """The spread of distances, mm, from the marker that moves most against the others of its segment.

    Args:
        markers: The subject's markers, under the subject's names.
        subject: The person.
    """
    own = {marker.name: marker for marker in subject.markers}
    noise_mm = {name: 1e3 * own[name].noise_m for name in markers.names}
    spreads: dict[str, list[tuple[float, float]]] = {name: [] for name in markers.names}
    for (a, first), (b, second) in combinations(enumerate(markers.names), 2):
        if own[first].segment != own[second].segment:
            continue
        spread = _spread_mm(markers.positions_m[:, a] - markers.positions_m[:, b])
        if spread is not None:
            expected = float(np.hypot(SKIN_MM, np.hypot(noise_mm[first], noise_mm[second])))
            for name in (first, second):
                spreads[name].append((spread, expected))
    # A loose marker moves against all others, which move against it alone: the median separates them.
    typical = {name: np.median(pairs, axis=0) for name, pairs in spreads.items() if pairs}
    if not typical:
        return not_judged(NAME, "mm", BOUND_MM, "no segment carries two markers")
    name = max(typical, key=lambda one: float(typical[one][0] / typical[one][1]))
    value, sd = (float(x) for x in typical[name])
    hint = f"{name} moves most against the others of its segment ({own[name].segment.replace('_', ' ')})"
    remedy = ": check its name and segment, and whether it came loose"
    return replace(judged(NAME, value, sd, "mm", BOUND_MM, hint, remedy), segment=own[name].segment)


def _spread_mm(apart: Array) -> float | None:
    """Spread of the length of vectors (T, 3), mm; None for too few known ones."""
    length = np.linalg.norm(apart, axis=1)
    length = length[~np.isnan(length)]
    if len(length) < LEAST_FRAMES:
        return None
    low, high = np.percentile(length, [TAIL_PERCENT, 100.0 - TAIL_PERCENT])
    return 1e3 * float(high - low) / (2.0 * TAIL_SD)
