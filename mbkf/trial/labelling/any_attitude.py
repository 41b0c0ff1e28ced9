"""A subject's markers found in any attitude, prone or kneeling, from the tracks of a whole capture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame, FirstFrameSearch
from mbkf.labelling.keyframe_beam_search import search_keyframes
from mbkf.labelling.keyframes import choose_keyframes
from mbkf.labelling.skeleton import clusters
from mbkf.labelling.tracks import Tracks, link_tracks
from mbkf.sensors.marker_sensor import MarkerSensor

STAGE = "Searching any attitude"
"""Name of the stage in progress reports; it takes seconds."""

KEYFRAMES = 6
"""Number of keyframes at which a body is matched with the tracks."""

ENOUGH = 3
"""Number of labelled frames after which the search ends."""


def name_tracks_of_frame(
    sensor: MarkerSensor, sd_m: Array, points_m: Array, tracks: Tracks, frame: int
) -> tuple[Indices, float]:
    """Marker of every track (count,) that a frame shows, by the body that explains them best, and its score.

    Args:
        sensor: The markers on a body whose geometry may be rough.
        sd_m: (M,) spread of each marker about its place on its segment.
        points_m: (T, C, 3) points of the capture.
        tracks: Their tracks.
        frame: The frame.
    """
    owner = np.full(tracks.count, HIDDEN, dtype=np.intp)
    seen = choose_keyframes(points_m, tracks, frame, KEYFRAMES)
    bodies = [] if seen is None else search_keyframes(clusters(sensor, sd_m), seen, 1)
    if seen is None or not bodies:
        return owner, 0.0
    there = bodies[0].labels != HIDDEN
    owner[seen.tracks[bodies[0].labels[there]]] = np.flatnonzero(there)
    return owner, bodies[0].score


class AnyAttitude:
    """A subject's search in one capture.

    Attributes:
        search: The subject's search within a frame.
    """

    def __init__(self, search: FirstFrameSearch, positions_m: Array, rate_hz: float) -> None:
        """Prepares the search.

        Args:
            search: The subject's search within a frame.
            positions_m: (T, C, 3) points of the capture, NaN where empty.
            rate_hz: Frame rate.
        """
        self.search, self._positions_m, self._rate_hz = search, positions_m, rate_hz

    @cached_property
    def _tracks(self) -> Tracks:
        return link_tracks(self._positions_m, self._rate_hz)

    def at(self, frame: int) -> FirstFrame | None:
        """Labels of a frame's points, in the order of their columns, or None without a plausible body."""
        points = self._positions_m[frame]
        columns = np.flatnonzero(~np.isnan(points).any(axis=1))
        sensor, sd = self.search.sensor, self.search.sd_m
        owner, _ = name_tracks_of_frame(sensor, sd, self._positions_m, self._tracks, frame)
        own = owner[self._tracks.number[frame, columns]]
        labels = np.full(len(sd), HIDDEN, dtype=np.intp)
        labels[own[own != HIDDEN]] = np.flatnonzero(own != HIDDEN)
        return self.search.refined(points[columns], labels)

    def starts(
        self, looks: Sequence[int], progress: Callable[[int, int], None]
    ) -> list[tuple[int, FirstFrame]]:
        """A few frames that can be labelled, with their labels, the most likely first.

        Args:
            looks: Frames to search.
            progress: Called with frames searched and frames in all.
        """
        found: list[tuple[int, FirstFrame]] = []
        for done, frame in enumerate(looks):
            progress(done, len(looks))
            first = self.at(frame)
            if first is not None:
                found.append((frame, first))
            if len(found) == ENOUGH:
                break
        progress(len(looks), len(looks))
        return sorted(found, key=lambda pair: -pair[1].log_ratio)
