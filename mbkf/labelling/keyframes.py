"""Tracks at a few keyframes of a capture, with their distances over the whole of it.

Two tracks of one segment keep their distance; those of different segments do not, as soon as the body moves. This holds
in any attitude and without a model of the body, so that it helps most before the subject is scaled.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import Indices
from mbkf.labelling.tracks import Tracks
from mbkf.numerics.runs import spread_indices

LOOKS = 160
"""Frames, spread over the capture, from which distances are taken."""

SHOWN = 0.8
"""Least number of tracks in a keyframe, as a share of those in the best frame."""

STILL_M, TRAVEL_M = 0.05, 0.50
"""A track that moves less than the first, while half of all tracks move more than the second, is not on the body."""

MIN_SHOWN = 0.15
"""Least share of the frames in which a track is seen."""

_MIDDLE = (5.0, 95.0)


@dataclass(frozen=True)
class Keyframes:
    """N tracks at K keyframes.

    Attributes:
        frames: (K,) the frames; the first is the one that the tracks were taken from.
        tracks: (N,) their numbers.
        positions_m: (K, N, 3) their positions, NaN where not seen.
        spread_m: (N, N) range of the distance of two in the capture, 0 where they never appear together.
        length_m: (N, N) median of their distance.
    """

    frames: Indices
    tracks: Indices
    positions_m: Array
    spread_m: Array
    length_m: Array


def choose_keyframes(points_m: Array, tracks: Tracks, frame: int, count: int) -> Keyframes | None:
    """The tracks seen in a frame, at keyframes in which their distances differ most from each other.

    Args:
        points_m: (T, C, 3) the capture's points.
        tracks: Their tracks.
        frame: The frame.
        count: Greatest number of keyframes.

    Returns:
        None where the frame shows fewer than three tracks that may be a body's.
    """
    looks = np.union1d(spread_indices(len(points_m), LOOKS), frame)
    every = tracks.positions(points_m, looks)
    there = ~np.isnan(every[:, :, 0])
    own = there[np.searchsorted(looks, frame)] & (there.mean(axis=0) >= MIN_SHOWN) & moving(every)
    chosen = np.flatnonzero(own)
    if len(chosen) < 3:
        return None
    seen = every[:, chosen]
    distance = np.linalg.norm(seen[:, :, None] - seen[:, None], axis=3)
    low, high, middle = _quantiles(distance, (*_MIDDLE, 50.0))
    shown = (~np.isnan(seen[:, :, 0])).sum(axis=1)
    picked = _differing(distance, shown >= SHOWN * shown.max(), int(np.searchsorted(looks, frame)), count)
    return Keyframes(looks[picked], chosen, seen[picked], high - low, middle)


def moving(positions_m: Array) -> BoolArray:
    """(N,) tracks (T, N, 3) that move, where most do: the others are on the furniture."""
    low, high = _quantiles(positions_m, (2.0, 98.0))
    way = np.linalg.norm(high - low, axis=1)
    return np.asarray((way > STILL_M) | (np.median(way) < TRAVEL_M))


def _quantiles(values: Array, shares: tuple[float, ...]) -> Array:
    """Percentiles along the first axis, 0 where all is NaN."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "All-NaN slice", RuntimeWarning)
        return np.nan_to_num(np.nanpercentile(values, shares, axis=0))


def _differing(distance_m: Array, good: BoolArray, first: int, count: int) -> Indices:
    """Frames of (F, N, N) distances: the first, then always the good one that differs most from those picked."""
    picked = [first]
    pairs = np.triu_indices(distance_m.shape[1], 1)
    flat = distance_m[:, pairs[0], pairs[1]]
    unlike = np.where(good, np.inf, -1.0)
    while len(picked) < count:
        away = (flat - flat[picked[-1]]) ** 2
        known = ~np.isnan(away)
        mean = np.where(known, away, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
        unlike = np.minimum(unlike, mean)
        best = int(unlike.argmax())
        if unlike[best] <= 0.0:
            break
        picked.append(best)
    return np.array(picked, dtype=np.intp)
