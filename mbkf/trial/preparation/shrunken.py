"""Clusters that shrink for a moment: a file whose names were exchanged and then low-passed holds mixtures of markers.

A mean of two places of a rigid cluster is smaller than the cluster. Skin and a bending foot make a segment smaller by
up to 8 % (17 public captures), such mixtures by 20 to 45 %.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.numerics.runs import runs

SMALLER = 0.85
"""A cluster smaller than this share of its median size can hold mixtures; set on one run (ric_run), between its
mixtures and the feet of 17 captures without such (0.92)."""

BEYOND_SDS = 10.0
"""A mixture is so many standard deviations of the cluster's size below the median: 195 and more in ric_run, up to 4.6
for key points of 20 mm noise and for shoulders that move on a trunk (landings). In 50 further public captures no
cluster is left out; one falls below the share, by 3.0 sd. A second file with mixtures is not known."""

BESIDE_S = 0.05
"""A low-pass spreads an exchange over so much time before and after."""

LEAST_MARKERS = 3
"""A cluster of fewer markers has no size of its own: one that is loose would do."""


def without_shrunken(
    markers: MarkerTrajectories, subject: Subject
) -> tuple[MarkerTrajectories, tuple[str, ...]]:
    """The trajectories without samples of clusters that shrink, and a note for each segment that has some.

    Args:
        markers: The subject's markers, under the subject's names.
        subject: The person.
    """
    segment_of = {marker.name: marker.segment for marker in subject.markers}
    segments = np.array([segment_of[name] for name in markers.names])
    positions, notes = markers.positions_m.copy(), []
    beside = round(BESIDE_S * markers.rate_hz)
    for segment in dict.fromkeys(segments.tolist()):
        own = np.flatnonzero(segments == segment)
        cluster = markers.positions_m[:, own]
        size = np.linalg.norm(cluster - cluster.mean(axis=1, keepdims=True), axis=(1, 2))
        if len(own) < LEAST_MARKERS or np.isnan(size).all():
            continue
        shrunken = runs(size < _least_size(size))
        for first, after in shrunken:
            positions[max(first - beside, 0) : after + beside, own] = np.nan
        frames = sum(after - first for first, after in shrunken)
        if frames:
            notes.append(
                f"the markers of the {segment.replace('_', ' ')} lie closer together than a rigid cluster's in "
                f"{frames} frames: mixtures of exchanged markers, left out; label the capture anew"
            )
    return replace(markers, positions_m=positions), tuple(notes)


def _least_size(size: Array) -> float:
    """Size (m) below which a cluster holds mixtures; sd of the (T,) sizes by their median absolute deviation."""
    usual = float(np.nanmedian(size))
    sd = 1.4826 * float(np.nanmedian(np.abs(size - usual)))
    return min(SMALLER * usual, usual - BEYOND_SDS * sd)
