"""Likeness of a trial's markers to those of the standing trial: the same person, with the same markers where they were.

Distances between markers of one segment show it without a body: skin changes them by some millimetres, another person
or markers put on anew by more.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.numerics.printed import percent
from mbkf.trial.preparation.static_names import markers_as_scaled

LEAST_COVERAGE = 0.5
"""Least share of the standing trial's markers that the frames looked at show."""

MOST_CHANGED_MM = 5.0
"""Greatest median change of distances between markers of a segment. Trials of 14 public sessions and of 16 made from
bodies of OpenSim change them by 0.0 to 3.5 mm, deep squats included; the same trials of another person of these by 6.0
to 70 mm, public ones of another person, or with markers put on anew, by 8.6 to 45 mm."""

LEAST_PAIRS = 3
"""Least number of pairs of markers whose distances are compared."""

SKIN_M, ANEW_M, SIZE = 0.003, 0.015, 0.05
"""Spread of a distance between trials of one session; between two sessions, with markers put on anew; and, as a share,
between two persons. With :data:`DEGREES` and :data:`LOOSE` chosen on the persons that
``benchmarks/strangers/mixed_folders.py`` names as chosen on."""

DEGREES = 3.0
"""Degrees of freedom of Student's distribution of the changes: a marker that fell off changes few of the distances."""

LOOSE = 0.05
"""Probability that skin or cloth moves the markers of a segment as far as putting them on anew would: shoulders in a
deep squat, a belt."""


class Places(NamedTuple):
    """Markers of a trial against those of a reference.

    Attributes:
        changed_mm: Median change of distances between markers of a segment, mm.
        elsewhere: Logarithm to base 10 of the density of these changes for markers put on anew, on this or another
            person, over that for markers where they were.
    """

    changed_mm: float
    elsewhere: float


class StandingMarkers:
    """The markers of a standing trial.

    Args:
        subject: The person scaled from it.
        standing: Its markers.
    """

    def __init__(self, subject: Subject, standing: MarkerTrajectories) -> None:
        own = markers_as_scaled(standing, subject)
        self._segments = {marker.name: marker.segment for marker in subject.markers}
        there = np.asarray(own.present.any(axis=0))
        self._seen = [name for name, seen in zip(own.names, there, strict=True) if seen]
        self._distances = _distances(own, self._segments)

    def refusal(self, own: MarkerTrajectories) -> str:
        """Reason why a trial does not show this person with these markers, a clause; "" where it does.

        Args:
            own: Frames of the trial, (T, M, 3) m under the subject's own names.
        """
        coverage = self.coverage(own)
        if coverage < LEAST_COVERAGE:
            return f"it shows {percent(coverage)} of the markers of the standing trial"
        changed = self.changed_mm(own)
        if changed is not None and changed > MOST_CHANGED_MM:
            return (
                f"distances between markers of a segment differ from standing by {changed:.0f} mm: another person, or "
                "markers put on anew"
            )
        return ""

    def coverage(self, own: MarkerTrajectories) -> float:
        """Share of the standing trial's markers that a trial's frames show, 0 to 1."""
        known = [name in self._seen for name in own.names]
        return float(own.present[:, known].sum() / max(own.frames * len(self._seen), 1))

    def changed_mm(self, own: MarkerTrajectories) -> float | None:
        """Median change of the distances since standing, mm; None with fewer than :data:`LEAST_PAIRS` of them."""
        places = self.places(own)
        return None if places is None else places.changed_mm

    def places(self, own: MarkerTrajectories) -> Places | None:
        """The changes of the distances since standing; None with fewer than :data:`LEAST_PAIRS` of them.

        The changes of pairs of one marker depend on each other: a segment's count as one for each marker.

        Args:
            own: Frames of the trial, (T, M, 3) m under the subject's own names.
        """
        now = _distances(own, self._segments)
        common = [pair for pair in self._distances if pair in now]
        if len(common) < LEAST_PAIRS:
            return None
        before_m = np.array([self._distances[pair] for pair in common])
        change_m = np.array([now[pair] for pair in common]) - before_m
        gains = _log_density(change_m, np.hypot(ANEW_M, SIZE * before_m)) - _log_density(change_m, SKIN_M)
        by_segment: dict[str, list[int]] = {}
        for number, (name, _) in enumerate(common):
            by_segment.setdefault(self._segments[name], []).append(number)
        elsewhere = 0.0
        for rows in by_segment.values():
            markers = {name for row in rows for name in common[row]}
            gain = min(len(markers), len(rows)) * float(np.mean(gains[rows]))
            elsewhere -= np.log10(LOOSE + (1.0 - LOOSE) * np.exp(-gain))
        return Places(1e3 * float(np.median(np.abs(change_m))), float(elsewhere))


def _log_density(change_m: Array, spread_m: Array | float) -> Array:
    """Logarithm of Student's density of changes of a spread, up to a constant."""
    return np.asarray(
        -np.log(spread_m) - 0.5 * (DEGREES + 1.0) * np.log1p((change_m / spread_m) ** 2 / DEGREES)
    )


def _distances(markers: MarkerTrajectories, segments: Mapping[str, str]) -> dict[tuple[str, str], float]:
    """Median distance by pair of markers of one segment, m."""
    found = {}
    for (a, i), (b, j) in combinations(sorted((name, i) for i, name in enumerate(markers.names)), 2):
        if segments[a] == segments[b]:
            apart = np.linalg.norm(markers.positions_m[:, i] - markers.positions_m[:, j], axis=1)
            if np.isfinite(apart).any():
                found[a, b] = float(np.nanmedian(apart))
    return found
