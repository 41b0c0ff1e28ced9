"""Strides of a foot from its path: how long, how fast, how high.

A stride goes from the middle of one rest on the ground to the middle of the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.runs import runs

SHORTEST_M = 0.15
"""Shorter movements (shifts of weight, shuffling on the spot) do not count as strides."""

_HALF_REST_S = 0.25
"""Time that a stride takes of the rest at either end, where two strides follow each other without a rest."""


@dataclass(frozen=True)
class Stride:
    """One stride.

    Attributes:
        first, last: Samples in the middle of the rests it lies between.
        start_s, end_s: Times it is counted from and to; of a pause it takes as much as of a usual rest.
        length_m: Horizontal distance.
        length_sd_m: Its standard deviation, NaN where unknown.
        rise_m: Height gained.
        lift_m: Greatest height above the straight line between its ends.
        swing_s: Time off the rests.
        turn_rad: Change of the foot's heading, positive to the left; NaN where unknown.
        doubt: Why it can be no stride of a person, "" where it can.
    """

    first: int
    last: int
    start_s: float
    end_s: float
    length_m: float
    length_sd_m: float
    rise_m: float
    lift_m: float
    swing_s: float
    turn_rad: float
    doubt: str = ""

    @property
    def duration_s(self) -> float:
        """Time from start to end."""
        return self.end_s - self.start_s

    @property
    def speed_m_s(self) -> float:
        """Length by duration."""
        return self.length_m / self.duration_s


def find_strides(
    time_s: Array,
    position_m: Array,
    still: BoolArray,
    *,
    orientation: Array | None = None,
    displacement_covariances_m2: Array | None = None,
    shortest_m: float = SHORTEST_M,
) -> tuple[Stride, ...]:
    """Strides between consecutive rests.

    Args:
        time_s: (T,) times at equal steps.
        position_m: (T, 3) z up.
        still: (T,) samples in which the foot rests.
        orientation: (T, 4) sensor → world as quaternions (x, y, z, w), for the turns.
        displacement_covariances_m2: (n − 1, 3, 3) of the ways between the middles of the n rests.
        shortest_m: Shorter movements are left out.

    Raises:
        InvalidInput: ``shortest_m`` is negative.
    """
    if not shortest_m >= 0.0:
        raise InvalidInput(f"the shortest stride must be 0 m or more, got {shortest_m}")
    rests = runs(still)
    step_s = float(time_s[1] - time_s[0]) if len(time_s) > 1 else 0.0
    half_s = _half_rest(rests, step_s)
    strides = []
    for n, ((a, b), (c, d)) in enumerate(pairwise(rests)):
        i, j = (a + b - 1) // 2, (c + d - 1) // 2
        way = position_m[j] - position_m[i]
        length = float(np.hypot(way[0], way[1]))
        if length < shortest_m:
            continue
        left_s, landed_s = float(time_s[b - 1]), float(time_s[c])
        sd = np.nan
        if displacement_covariances_m2 is not None:
            along = way[:2] / max(length, 1e-9)
            sd = float(np.sqrt(along @ displacement_covariances_m2[n][:2, :2] @ along))
        line = np.linspace(position_m[i, 2], position_m[j, 2], j - i + 1)
        strides.append(
            Stride(
                first=i,
                last=j,
                start_s=max(float(time_s[i]), left_s - half_s),
                end_s=min(float(time_s[j]), landed_s + half_s),
                length_m=length,
                length_sd_m=sd,
                rise_m=float(way[2]),
                lift_m=float((position_m[i : j + 1, 2] - line).max()),
                swing_s=landed_s - left_s,
                turn_rad=np.nan if orientation is None else _turn(orientation[i], orientation[j]),
            )
        )
    return tuple(strides)


def _half_rest(rests: list[tuple[int, int]], step_s: float) -> float:
    """Half the length of a usual rest between two strides."""
    inner = [(b - 1 - a) * step_s for a, b in rests[1:-1]]
    return 0.5 * float(np.median(inner)) if inner else _HALF_REST_S


def _turn(before: Array, after: Array) -> float:
    """Angle about the vertical of the rotation from one orientation to the other."""
    M = quaternion_matrices(after) @ quaternion_matrices(before).T
    return float(np.arctan2(M[1, 0] - M[0, 1], M[0, 0] + M[1, 1]))
