"""Readings of inertial sensors from orientations: angular velocity and specific force by differences of neighbours.

    ω_k = (Log(R_kᵀ R_{k+1}) + Log(R_{k−1}ᵀ R_k)) / (2 Δt)
    f_k = R_kᵀ (a_k + g),  a_k = (p_{k+1} − 2 p_k + p_{k−1}) / Δt² where no acceleration is sent

in the axes of R_k. A frame waits for the one after it. Where a neighbour is missing, the orientation alone is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array

HELD_S = 0.1
"""A frame waits so long for the one after it."""

BACK = 50
"""A count that goes back by more frames than this begins anew; one that goes back by fewer came late."""


@dataclass(frozen=True)
class OrientedFrame:
    """Orientations of a frame.

    Attributes:
        number: As the source counts frames.
        arrival_s: When it arrived.
        turns: (S, 4) unit quaternions sensor → world, z up; NaN where missing.
        places_m: (S, 3) origins, from which accelerations follow; None where these are sent.
        accelerations: (S, 3) m/s² in the world, without gravity; None where places are sent.
        imus: (S, 6) angular velocity rad/s and specific force m/s², NaN where not known.
    """

    number: int
    arrival_s: float
    turns: Array
    places_m: Array | None
    accelerations: Array | None
    imus: Array


class Differences:
    """Holds a frame until the next one has come."""

    def __init__(self, rate_hz: float) -> None:
        """Args: the rate of the frames."""
        self._rate_hz = rate_hz
        self._before: OrientedFrame | None = None
        self._held: OrientedFrame | None = None
        self._late: list[OrientedFrame] = []

    def put(self, one: OrientedFrame) -> Iterator[OrientedFrame]:
        """Takes a frame; gives those that wait no more, in order, frames that came late or twice behind."""
        held = self._held
        if held is not None and held.number - BACK <= one.number <= held.number:
            self._late.append(one)
            return
        yield from self._release(one)
        self._held = one

    def due(self, now_s: float) -> Iterator[OrientedFrame]:
        """Gives the frame that has waited for too long."""
        if self._held is not None and now_s - self._held.arrival_s > HELD_S:
            yield from self._release(None)

    def _release(self, after: OrientedFrame | None) -> Iterator[OrientedFrame]:
        if self._held is not None:
            yield self._derived(self._before, self._held, after)
        yield from self._late
        self._before, self._held, self._late = self._held or self._before, None, []

    def _derived(
        self, before: OrientedFrame | None, one: OrientedFrame, after: OrientedFrame | None
    ) -> OrientedFrame:
        if before is None or after is None or not before.number + 1 == one.number == after.number - 1:
            return one
        there = np.isfinite(np.hstack([before.turns, one.turns, after.turns])).all(axis=1)
        imus = np.full_like(one.imus, np.nan)
        if not there.any():
            return one
        first, here, last = (Rotation.from_quat(x.turns[there]) for x in (before, one, after))
        ahead, behind = (here.inv() * last).as_rotvec(), (first.inv() * here).as_rotvec()
        imus[there, :3] = 0.5 * self._rate_hz * (ahead + behind)
        acceleration = one.accelerations
        if acceleration is None:
            assert before.places_m is not None and one.places_m is not None and after.places_m is not None
            acceleration = self._rate_hz**2 * (after.places_m - 2.0 * one.places_m + before.places_m)
        felt = acceleration[there] + np.array([0.0, 0.0, GRAVITY_M_S2])
        imus[there, 3:] = here.inv().apply(felt)
        return replace(one, imus=imus)
