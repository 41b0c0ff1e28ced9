"""More than one person in view: markers that are not the subject's, further away than one body reaches.

A marker belongs to somebody else where another one of the same name (behind a prefix as in ``B:LASI``, or renamed to
``LASI_2`` by the reader) is the subject's and lies elsewhere, or where every marker of the subject is far from it.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories

LEAST_MARKERS = 6
"""So many markers of somebody else are another person; frames of calibration and wands have at most five."""

NAMESAKE_M, FAR_M = 0.3, 0.8
"""Median distance from the marker of the same name, and from the nearest marker of the subject, from which a marker is
somebody else's."""

MOST_FRAMES = 60
"""Frames that are looked at, evenly spaced where there are more."""

_PREFIX, _AGAIN = re.compile(r"^.*:"), re.compile(r"_\d+$")


class Others(NamedTuple):
    """Markers of somebody else.

    Attributes:
        names: Their names.
        far_m: Median distance of the farthest one from the subject's markers.
    """

    names: tuple[str, ...]
    far_m: float

    @property
    def is_person(self) -> bool:
        """True where there are enough of them for a person."""
        return len(self.names) >= LEAST_MARKERS

    @property
    def sentence(self) -> str:
        """The finding in words."""
        return (
            f"{len(self.names)} markers that are not the subject's, such as {self.names[0]}, lie up to "
            f"{self.far_m:.1f} m from the subject's"
        )


def others_in_view(markers: MarkerTrajectories, own: Collection[str]) -> Others:
    """Markers of somebody else in a capture, or in a part of it.

    Args:
        markers: All markers, also those without a name of their own.
        own: Names of those that are the subject's.
    """
    mine = [m for m, name in enumerate(markers.names) if name in own]
    step = max(1, -(-markers.frames // MOST_FRAMES))
    places = markers.positions_m[::step]
    if not mine or not len(places):
        return Others((), 0.0)
    namesakes = {plain_name(markers.names[m]): m for m in mine}
    found, far = [], 0.0
    for m, name in enumerate(markers.names):
        if name in own:
            continue
        nearest = _nearest(places[:, m], places[:, mine])
        twin = namesakes.get(plain_name(name))
        elsewhere = twin is not None and _nearest(places[:, m], places[:, [twin]]) > NAMESAKE_M
        if elsewhere or nearest > FAR_M:
            found.append(name)
            far = max(far, nearest)
    return Others(tuple(found), far)


def far_points(points_m: Array, own_m: Array) -> int:
    """Number of points without a name that lie far from the subject's markers in the usual frame.

    Args:
        points_m: (T, C, 3) points that are no marker's, NaN for others; their order may change from frame to frame.
        own_m: (T, M, 3) the subject's markers.
    """
    step = max(1, -(-len(points_m) // MOST_FRAMES))
    counts = []
    for points, own in zip(points_m[::step], own_m[::step], strict=True):
        mine, theirs = (one[~np.isnan(one).any(axis=1)] for one in (own, points))
        if len(mine):
            away = np.linalg.norm(theirs[:, None] - mine, axis=2)
            counts.append(int((away.min(axis=1) > FAR_M).sum()) if len(theirs) else 0)
    return int(np.median(counts)) if counts else 0


def plain_name(name: str) -> str:
    """A marker's name without a prefix (``B:LASI``) or the number that a reader adds to a repeated one (``LASI_2``)."""
    return _AGAIN.sub("", _PREFIX.sub("", name))


def _nearest(place: Array, others: Array) -> float:
    """Median distance of a marker (T, 3) from the nearest of others (T, n, 3); 0 where they are never seen together."""
    away = np.linalg.norm(others - place[:, None], axis=2)
    known = ~np.isnan(away).all(axis=1)
    return float(np.median(np.nanmin(away[known], axis=1))) if known.any() else 0.0
