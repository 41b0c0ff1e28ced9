"""Gait cycles from strike to strike of the same foot: curves over 0–100 %, and spatiotemporal parameters."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.session import FootEvent
from mbkf.trial.gait.events import (
    HEEL,
    FeetInMotion,
    FootEvents,
    events_by_hand,
    feet_in_motion,
    foot_events,
)

POINTS = 101
"""Curves over a cycle have values at 0, 1, … 100 %."""

CYCLE_S = (0.3, 2.5)
"""Cycles outside this are not gait."""

OPPOSITE = (0.2, 0.8)
"""Shares of a cycle between which the other foot strikes; in hops and jumps it does not."""

STRAIGHT_DEG = 15.0
"""A pelvis that faces another way by more than this at the second strike of a cycle turns in it. The pelvis of six
persons who walked straight differed by 6° at most, that of seven made ones who turned round a corner by 48° at least.
"""

BELT_FROM_M_S = 0.15
"""Standing feet that move back faster than this, under a pelvis that stays, stand on a belt."""

STAYS_M_S, STAYS_SHARE = 0.3, 0.5
"""A pelvis stays whose mean speed over all cycles is below the first, and below this share of the feet's."""


@dataclass(frozen=True)
class Cycle:
    """One cycle of a foot.

    Attributes:
        side: 0 right, 1 left.
        start_s, off_s, end_s: Strike, toe-off, next strike.
        opposite_s: Strike of the other foot in between.
        support_s: Time in it with both feet on the floor; negative where there is flight, NaN where not known.
    """

    side: int
    start_s: float
    off_s: float
    end_s: float
    opposite_s: float
    support_s: float

    @property
    def seconds(self) -> float:
        """Duration."""
        return self.end_s - self.start_s

    @property
    def off_percent(self) -> float:
        """Toe-off in per cent of the cycle: the stance phase."""
        return 100.0 * (self.off_s - self.start_s) / self.seconds


@dataclass(frozen=True)
class GaitParameter:
    """A spatiotemporal parameter: values of the cycles of right and left foot, in ``unit``."""

    name: str
    unit: str
    values: tuple[Array, Array]


@dataclass(frozen=True)
class Gait:
    """The gait of a trial.

    Attributes:
        events: Of right and left foot.
        cycles: All whole cycles, right ones first.
        parameters: Spatiotemporal parameters.
        belt_m_s: Speed of the treadmill under the feet; 0 on a floor.
    """

    events: tuple[FootEvents, FootEvents]
    cycles: tuple[Cycle, ...]
    parameters: tuple[GaitParameter, ...]
    belt_m_s: float

    def of(self, side: int) -> tuple[Cycle, ...]:
        """The cycles of the right (0) or left (1) foot."""
        return tuple(cycle for cycle in self.cycles if cycle.side == side)


def find_gait(
    r: Reconstruction, by_hand: Iterable[FootEvent] | None = None, straight: bool = False
) -> Gait | None:
    """The gait of a reconstruction; None where no foot makes a whole cycle.

    Args:
        r: The reconstruction.
        by_hand: All strikes and toe-offs, as a person set them; None: those that are found.
        straight: Leaves out the cycles in which the pelvis turns (:data:`STRAIGHT_DEG`).
    """
    feet = feet_in_motion(r)
    events = foot_events(r, feet) if by_hand is None else events_by_hand(by_hand, r.times_s)
    cycles = tuple(
        cycle
        for side in range(2)
        for cycle in cycles_of(events, side)
        if not (straight and abs(turned_deg(feet, cycle)) > STRAIGHT_DEG)
    )
    if not cycles:
        return None
    belt = belt_velocity(feet, cycles)
    return Gait(events, cycles, _parameters(feet, cycles, belt), float(np.linalg.norm(belt)))


def cycles_of(events: tuple[FootEvents, FootEvents], side: int) -> list[Cycle]:
    """Whole cycles of a foot: strike, one toe-off, strike, with one strike of the other foot about half-way."""
    mine, other = events[side], events[1 - side]
    found = []
    for start, end in zip(mine.strikes_s[:-1], mine.strikes_s[1:], strict=True):
        offs = mine.offs_s[(mine.offs_s > start) & (mine.offs_s < end)]
        share = (other.strikes_s - start) / (end - start)
        opposite = other.strikes_s[(share > OPPOSITE[0]) & (share < OPPOSITE[1])]
        if len(offs) == 1 and len(opposite) == 1 and CYCLE_S[0] <= end - start <= CYCLE_S[1]:
            near = other.offs_s[np.abs(other.offs_s - start) < 0.35 * (end - start)]
            first = near[np.argmin(np.abs(near - start))] - start if len(near) else np.nan
            support = first + offs[0] - opposite[0]
            found.append(
                Cycle(side, float(start), float(offs[0]), float(end), float(opposite[0]), float(support))
            )
    return found


def turned_deg(feet: FeetInMotion, cycle: Cycle) -> float:
    """Angle by which the pelvis turns to the left between both strikes of a cycle, degrees; 0 where it is not known.

    Args:
        feet: Feet and pelvis.
        cycle: The cycle.
    """
    known = ~np.isnan(feet.forward).any(axis=1)
    if not known.any():
        return 0.0
    yaw = np.unwrap(np.arctan2(feet.forward[known, 1], feet.forward[known, 0]))
    start, end = np.interp((cycle.start_s, cycle.end_s), feet.times_s[known], yaw)
    return float(np.rad2deg(end - start))


def over_cycle(times_s: Array, values: Array, cycle: Cycle) -> Array:
    """(101,) a curve (T,) over a cycle; NaN where one of the two frames around a point is.

    Args:
        times_s: (T,) times of the frames, s.
        values: (T,) the curve.
        cycle: The cycle.
    """
    at = np.linspace(cycle.start_s, cycle.end_s, POINTS)
    return np.interp(at, times_s, values)


def belt_velocity(feet: FeetInMotion, cycles: tuple[Cycle, ...]) -> Array:
    """(2,) horizontal velocity of the ground under the feet: the ball's in mid-stance.

    It is 0 unless the pelvis stays while the feet travel back: on a floor, feet of a sprint also move in mid-stance.

    Args:
        feet: Feet and pelvis.
        cycles: At least one cycle.
    """
    speeds = []
    velocity = np.gradient(feet.soles_m[:, :, 1, :2], feet.times_s, axis=0)
    for cycle in cycles:
        stance = (feet.times_s - cycle.start_s) / (cycle.off_s - cycle.start_s)
        middle = (stance > 0.35) & (stance < 0.65)
        speeds.append(velocity[middle, cycle.side])
    found = np.concatenate(speeds)
    found = found[~np.isnan(found).any(axis=1)]
    if not len(found):
        return np.zeros(2)
    belt = np.median(found, axis=0)
    back = -float(belt @ np.nanmean(feet.forward, axis=0))
    stays = _pelvis_speed(feet, cycles) < min(STAYS_M_S, STAYS_SHARE * back)
    return belt if stays and back > BELT_FROM_M_S else np.zeros(2)


def _pelvis_speed(feet: FeetInMotion, cycles: tuple[Cycle, ...]) -> float:
    """Mean horizontal speed of the pelvis over all cycles, m/s; between frames in which the body is followed."""
    first, last = min(cycle.start_s for cycle in cycles), max(cycle.end_s for cycle in cycles)
    within = (feet.times_s >= first) & (feet.times_s <= last) & ~np.isnan(feet.pelvis_m).any(axis=1)
    times, places = feet.times_s[within], feet.pelvis_m[within]
    if len(times) < 2:
        return 0.0
    return float(np.linalg.norm(places[-1] - places[0]) / (times[-1] - times[0]))


def _parameters(feet: FeetInMotion, cycles: tuple[Cycle, ...], belt: Array) -> tuple[GaitParameter, ...]:
    """A step ends with the strike of its side; it is measured from the other foot's strike, on the ground."""
    table: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name, _ in _PARAMETERS}
    for cycle in cycles:
        side, T = cycle.side, cycle.seconds
        start, end = (_heel(feet, side, t, belt) for t in (cycle.start_s, cycle.end_s))
        middle = _heel(feet, 1 - side, cycle.opposite_s, belt)
        way = end - start
        length = float(np.linalg.norm(way))
        along = way / max(length, 1e-9)
        step = end - middle
        across = abs(float(along[0] * (middle - start)[1] - along[1] * (middle - start)[0]))
        both = 100.0 * cycle.support_s / T
        values = (
            120.0 / T, length / T, length, float(step @ along), across, T, cycle.end_s - cycle.opposite_s,
            cycle.off_percent, 100.0 - cycle.off_percent, cycle.off_percent - np.maximum(both, 0.0), both,
        )  # fmt: skip
        for (name, _), value in zip(_PARAMETERS, values, strict=True):
            table[name][side].append(value)
    found = [GaitParameter(n, u, (np.array(table[n][0]), np.array(table[n][1]))) for n, u in _PARAMETERS]
    support = np.concatenate(found[-1].values)
    if support[~np.isnan(support)].sum() < 0:
        right, left = found[-1].values
        found[-1] = GaitParameter("Flight", "%", (-right, -left))
    return tuple(found)


_PARAMETERS = (
    ("Cadence", "steps/min"), ("Speed", "m/s"), ("Stride length", "m"), ("Step length", "m"),
    ("Step width", "m"), ("Stride time", "s"), ("Step time", "s"), ("Stance", "%"), ("Swing", "%"),
    ("Single support", "%"), ("Double support", "%"),
)  # fmt: skip


def _heel(feet: FeetInMotion, side: int, time_s: float, belt: Array) -> Array:
    """(2,) place of a heel at a time, on axes that move with the belt."""
    heel = feet.soles_m[:, side, HEEL, :2]
    place = np.array([np.interp(time_s, feet.times_s, heel[:, axis]) for axis in range(2)])
    return place - belt * time_s
