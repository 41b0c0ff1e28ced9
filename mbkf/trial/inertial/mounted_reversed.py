"""Sensors that are mounted reversed or under each other's name, found by the body's misfit to their readings.

Two kinds are looked for: groups of sensors strapped on the other way round (pelvis, trunk, legs, feet), which are put
right, and two sensors under each other's name, which are reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.numerics.printed import percent

CLEARLY = 0.6
"""An exchange is reported where it leaves a smaller share of the misfit than the names as given."""

TURNED, TURNED_TOO = 0.7, 0.99
"""Sensors are taken to be strapped on the other way round where that leaves a smaller share of the misfit: clearly
smaller for a person who else follows custom, smaller at all for one who does not. The mounting of pelvis and trunk
shows little in walking."""

Judge = Callable[[frozenset[str], Mapping[str, str], float], float]
"""Misfit with sensors on some segments the other way round, and some segments named anew; it may be inf where it
exceeds a bound, the last argument."""


@dataclass(frozen=True)
class Exchange:
    """Two segments whose sensors are exchanged.

    Attributes:
        segments: They.
        share: Misfit with them exchanged over the misfit as named, 0 to 1.
    """

    segments: tuple[str, str]
    share: float

    @property
    def remark(self) -> str:
        """The finding and its remedy."""
        one, other = self.segments
        return (
            f"the sensors of {one} and {other} seem to be exchanged: the body explains the readings with "
            f"{percent(self.share)} of the misfit if they are; rename them and run again"
        )


@dataclass(frozen=True)
class SensorPlacement:
    """Mounting of the sensors as found.

    Attributes:
        turned: Segments whose sensors are strapped on the other way round than usual.
        exchange: Two sensors under each other's name; None: no exchange.
    """

    turned: frozenset[str] = frozenset()
    exchange: Exchange | None = None

    @property
    def names(self) -> dict[str, str]:
        """The segments of exchanged sensors by those they are named after."""
        return {} if self.exchange is None else both_ways(self.exchange.segments)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks."""
        found = [] if self.exchange is None else [self.exchange.remark]
        if self.turned:
            listed = ", ".join(sorted(self.turned))
            found.append(
                f"the sensors of {listed} are strapped on the other way round than usual (turned by 180 deg about the "
                "vertical): the body explains the readings better so; it was taken into account"
            )
        return tuple(found)


def mounted_reversed(
    model: HumanModel, segments: Sequence[str], named: float, judge: Judge
) -> SensorPlacement:
    """Mounting of the sensors: the change that lessens the misfit most comes first, as long as one does.

    Args:
        model: The body.
        segments: Segments that carry sensors.
        named: Misfit of the sensors as named, mounted as usual.
        judge: Misfit of another way in which they may be worn.
    """
    found, least = SensorPlacement(), named
    if not np.isfinite(least):
        return found
    open_groups = list(groups(model, segments))
    while True:
        turn, group = (TURNED_TOO if found.turned else TURNED) * least, frozenset[str]()
        for one in open_groups:
            other = judge(found.turned | one, found.names, turn)
            if other < turn:
                turn, group = other, one
        swap, pair = min(CLEARLY * least, turn), None
        for both in () if found.exchange else likely(model, segments):
            other = judge(found.turned, both_ways(both), swap)
            if other < swap:
                swap, pair = other, both
        if pair is not None:
            found, least = SensorPlacement(found.turned, Exchange(pair, swap / least)), swap
        elif group:
            found, least = SensorPlacement(found.turned | group, found.exchange), turn
            open_groups.remove(group)
        else:
            return found


def both_ways(pair: tuple[str, str]) -> dict[str, str]:
    """Each of two names by the other."""
    one, other = pair
    return {one: other, other: one}


def groups(model: HumanModel, segments: Sequence[str]) -> Iterator[frozenset[str]]:
    """Sensors that people strap on alike: on both legs, on both feet, on the pelvis, on the trunk."""
    legs = frozenset(name for pair in model.roles.knees for name in pair)
    feet, root = frozenset(model.roles.feet), frozenset({model.roles.root})
    for group in (legs, feet, root, frozenset(segments) - legs - feet - root):
        if worn := group & frozenset(segments):
            yield worn


def likely(model: HumanModel, segments: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Pairs of segments that are easily mistaken: the same of both legs, and neighbours on a leg."""
    legs = [[*knee, foot] for knee, foot in zip(model.roles.knees, model.roles.feet, strict=True)]
    pairs = [*zip(*legs, strict=True), *(pair for leg in legs for pair in pairwise(leg))]
    for one, other in pairs:
        if one in segments and other in segments:
            yield one, other
