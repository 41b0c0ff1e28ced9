"""The marker of the other side by marker of a set: by their names, else by their places on mirrored segments."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from mbkf.model.protocol import ProtocolMarker
from mbkf.model.sides import mirrored

SIDES = (("right", "left"), ("Right", "Left"), ("RIGHT", "LEFT"), ("R", "L"), ("r", "l"), ("D", "G"))
"""Words and letters for the two sides in names."""

APART_M = 0.02
"""Markers correspond without names where their places mirror each other within this, in each coordinate."""


def partners(markers: Sequence[ProtocolMarker]) -> NDArray[np.intp]:
    """(M,) number of the other side's marker; a marker's own number where there is none.

    Args:
        markers: The M markers.
    """
    found = np.arange(len(markers))
    by_segment: dict[str, dict[str, int]] = {}
    for m, marker in enumerate(markers):
        by_segment.setdefault(marker.segment, {})[marker.name] = m
    for m, marker in enumerate(markers):
        others = by_segment.get(mirrored(marker.segment), {})
        named = [others[name] for name in _other_names(marker.name) if others.get(name, m) != m]
        if named and found[m] == m and found[named[0]] == named[0]:
            found[m], found[named[0]] = named[0], m
    for m, marker in enumerate(markers):
        for other in by_segment.get(mirrored(marker.segment), {}).values():
            apart = np.abs(markers[other].position_m - marker.position_m * [1.0, -1.0, 1.0]).max()
            if found[m] == m and found[other] == other and other != m and apart < APART_M:
                found[m], found[other] = other, m
    return found


def _other_names(name: str) -> Iterator[str]:
    """Names with one word or letter for the right side replaced by that for the left."""
    for right, left in SIDES:
        for place in re.finditer(right, name):
            yield name[: place.start()] + left + name[place.end() :]
