"""Segments without markers between others with some, and the spreads of the joints beside them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.model.body import Body
from mbkf.numerics.printed import rounded
from mbkf.sensors.holes import holes_of

MOST_LANDMARKS = 3
"""Places for markers that the remedy names."""


class Hole(NamedTuple):
    """A segment without markers in a chain of others.

    Attributes:
        segment: Its name.
        parts: Its part, and those of the joints beside it.
        spread_deg: Mean standard deviation by main coordinate of these joints; of both sides the larger one.
        landmarks: Bony landmarks of the segment.
    """

    segment: str
    parts: tuple[str, ...]
    spread_deg: Mapping[str, float]
    landmarks: tuple[str, ...]

    @property
    def found(self) -> str:
        """Sentence on the segment and the spreads."""
        sds = [f"{_plain(name)} by {rounded(sd)}°" for name, sd in self.spread_deg.items()]
        uncertain = f"; uncertain (1 sd) are {', '.join(sds)}" if sds else ""
        return f"the {_plain(self.segment)} has no markers{uncertain}"

    @property
    def remedy(self) -> str:
        """Sentence on markers that would help."""
        places = ", ".join(_plain(one) for one in self.landmarks[:MOST_LANDMARKS])
        return f"use these angles with their intervals, or put markers on it ({places})"


def holes(
    model: Body,
    marked: frozenset[str],
    unobservable: BoolArray,
    part_of: Mapping[str, str],
    mean_sd: Mapping[str, float],
) -> tuple[Hole, ...]:
    """The holes of a trial, in the order of the body.

    Args:
        model: The body.
        marked: Segments with markers.
        unobservable: (nv,) dofs that move no marker.
        part_of: Part by segment.
        mean_sd: Mean standard deviation, rad, by clinical coordinate.
    """
    body = model.description
    without = holes_of(model, marked, unobservable)
    found = []
    for segment in (one.name for one in body.segments if one.name in without):
        joints = [one for one in body.clinical_joints if segment in (one.proximal, one.distal)]
        spreads: dict[str, float] = {}
        for joint in joints:
            if joint.main in mean_sd:
                name = joint.main.removesuffix("_r").removesuffix("_l")
                spreads[name] = max(spreads.get(name, 0.0), float(np.rad2deg(mean_sd[joint.main])))
        parts = dict.fromkeys((part_of[segment], *(part_of[one.distal] for one in joints)))
        places = tuple(one.name for one in body.landmarks.values() if one.segment == segment)
        found.append(Hole(segment, tuple(parts), spreads, places))
    return tuple(found)


def _plain(name: str) -> str:
    return name.replace("_", " ")
