"""Stretches in which markers of another person come so near that both may touch: such forces are not measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.numerics.runs import runs

NEAR_M, LEAST_S = 0.1, 0.1
"""Distance below which two persons may touch, and its least duration."""

MOST_LISTED = 3
"""Stretches that have a remark of their own."""


class NearStretch(NamedTuple):
    """A stretch of time in which another person is near.

    Attributes:
        part: Name of the marker or segment that is near.
        from_s, to_s: Times of its first and its last frame.
        nearest_m: Least distance.
    """

    part: str
    from_s: float
    to_s: float
    nearest_m: float

    @property
    def sentence(self) -> str:
        """The stretch in words."""
        return (
            f"another person comes within {1e3 * self.nearest_m:.0f} mm of {self.part} from {self.from_s:.2f} to "
            f"{self.to_s:.2f} s: a possible contact, whose forces are not measured"
        )


def nearest_m(own_m: Array, others_m: Array) -> Array:
    """(T, M) distance of each point from the nearest of others; infinite where they are not seen together.

    Args:
        own_m: (T, M, 3) points.
        others_m: (T, N, 3) the others; NaN where not seen.
    """
    found = np.full(own_m.shape[:2], np.inf)
    for other in others_m.transpose(1, 0, 2):
        apart = np.linalg.norm(own_m - other[:, None], axis=2)
        found = np.fmin(found, apart)
    return found


def stretches(part: str, distance_m: Array, times_s: Array) -> list[NearStretch]:
    """Stretches in which a distance stays small.

    Args:
        part: The marker or segment.
        distance_m: (T,) its distance from the nearest marker of another person.
        times_s: (T,) times of the frames.
    """
    return [
        NearStretch(part, float(times_s[a]), float(times_s[b - 1]), float(distance_m[a:b].min()))
        for a, b in runs(np.asarray(distance_m < NEAR_M))
        if times_s[b - 1] - times_s[a] >= LEAST_S or b - a == len(times_s)
    ]


def near_markers(own: MarkerTrajectories, others: MarkerTrajectories) -> list[NearStretch]:
    """Stretches in which a person's markers have another person's near them.

    Args:
        own: The person's markers.
        others: The others' markers.
    """
    apart = nearest_m(own.positions_m, others.positions_m)
    return [one for m, name in enumerate(own.names) for one in stretches(name, apart[:, m], own.times_s)]


def near_remarks(found: Sequence[NearStretch], most: int = MOST_LISTED) -> list[str]:
    """A remark on each stretch, the nearest first, and on the number of those left out.

    Args:
        found: The stretches.
        most: Remarks on single stretches at most.
    """
    nearest = sorted(found, key=lambda one: one.nearest_m)
    rest = [f"and {len(found) - most} more possible contacts"] if len(found) > most else []
    return [*(one.sentence for one in nearest[:most]), *rest]
