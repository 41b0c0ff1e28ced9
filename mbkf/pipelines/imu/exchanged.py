"""Sensors on other segments than named, found by how well the body explains what they read.

A body whose sensors are exchanged (sides, or neighbours on a leg) cannot stand on feet that rest while its sensors turn
as they do. The filter runs through the beginning of a recording with the names as given and with each likely exchange;
what is left of the gyroscopes' innovations, times what is left of feet that should rest, is least for the right names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.tracking import DynamicStep
from mbkf.filters.dynamic.worn_tracking import WornTracking
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking_loop import followed
from mbkf.model.human import HumanModel
from mbkf.sensors.block import AnyBlock, Rows
from mbkf.sensors.standing_feet import StandingFeet
from mbkf.sensors.worn_sensors import WornSensors

LOOKED_AT_S = 5.0
"""So much of a recording is looked at, from the first frame on."""

SETTLED_S = 0.3
"""The first frames still find out how fast the body moves."""

CLEARLY = 0.6
"""An exchange is told where it leaves a smaller share than the names as given."""

Run = Callable[[Mapping[str, str]], tuple[WornTracking, Recording]]
"""The filter and its readings, with segments named anew where the mapping says so."""


@dataclass(frozen=True)
class Exchange:
    """Two segments whose sensors are exchanged.

    Attributes:
        segments: They.
        share: What is left of the misfit with them exchanged, 0 to 1.
    """

    segments: tuple[str, str]
    share: float

    @property
    def told(self) -> str:
        """What is the matter, and what to do."""
        one, other = self.segments
        return (
            f"the sensors of {one} and {other} seem to be exchanged: the body explains the readings with "
            f"{100 * self.share:.0f} % of the misfit if they are; rename them and run again"
        )


def exchanged(model: HumanModel, segments: Sequence[str], run: Run) -> Exchange | None:
    """The exchange of two sensors that explains the readings clearly better than the names as given, or None.

    Args:
        model: The body.
        segments: Segments that carry sensors.
        run: Makes the filter with some of them named anew.
    """
    given = misfit(*run({}))
    found = [(misfit(*run({one: other, other: one})), (one, other)) for one, other in likely(model, segments)]
    if not found or not np.isfinite(given):
        return None
    least, pair = min(found)
    return Exchange(pair, least / given) if least < CLEARLY * given else None


def likely(model: HumanModel, segments: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Pairs of segments that are easily mistaken: the same of both legs, and neighbours on a leg."""
    legs = [[*knee, foot] for knee, foot in zip(model.roles.knees, model.roles.feet, strict=True)]
    pairs = [*zip(*legs, strict=True), *(pair for leg in legs for pair in pairwise(leg))]
    for one, other in pairs:
        if one in segments and other in segments:
            yield one, other


def misfit(filter: WornTracking, recording: Recording) -> float:
    """What is left of the gyroscopes' innovations, times what is left of feet that should rest; inf for no person.

    Args:
        filter: The filter.
        recording: Its readings; the beginning is looked at.
    """
    frames = max(2, round(LOOKED_AT_S / recording.dt_s))
    rates, feet = [], []
    for t, posterior, _ in followed(filter, recording):
        if t >= frames:
            break
        if t * recording.dt_s < SETTLED_S:
            continue
        parts = cast(DynamicStep, posterior.inner).readings.parts
        rates += [_of(filter, parts, WornSensors).reshape(-1, 2, 3)[:, 0].ravel()]
        feet += [_of(filter, parts, StandingFeet)]
    if not rates:
        return np.inf
    return _rms(np.concatenate(rates)) * (_rms(np.concatenate(feet)) or 1.0)


def _of(filter: WornTracking, parts: Sequence[Sequence[Rows]], kind: type[AnyBlock]) -> Array:
    """(k,) whitened innovations of a filter's first block of a kind."""
    for block, own in zip(filter.kalman.blocks, parts, strict=True):
        if isinstance(block, kind):
            return np.concatenate([np.zeros(0), *(one.innovation for one in own)])
    return np.zeros(0)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
