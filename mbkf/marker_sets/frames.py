"""Which frames of captures are looked at: one in which the person stands, and some of the movement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.numerics.runs import spread_indices

SPREAD = 16
"""Frames of a movement that are looked at."""

NEARLY_ALL = 0.9
"""A frame that shows so much of what the best one shows is well seen."""


def anchor_frames(trials: Sequence[MarkerTrajectories], names: Sequence[str], count: int) -> Array:
    """(F, K, 3) well-seen frames of the trials, the tallest of each of so many stretches, the tallest of all first.

    Args:
        trials: The trials.
        names: (K,) names of the markers, in the order wanted.
        count: How many frames.
    """
    columns = np.concatenate([_in_order(one, names) for one in trials])
    seen = (~np.isnan(columns[:, :, 0])).sum(axis=1)
    good = np.flatnonzero(seen >= NEARLY_ALL * seen.max(initial=0))
    height = np.array([_height(columns[t]) for t in good])
    parts = [part for part in np.array_split(np.arange(len(good)), count) if len(part)]
    tallest = sorted((part[np.argmax(height[part])] for part in parts), key=lambda k: -height[k])
    return columns[good[tallest]]


def spread_frames(trials: Sequence[MarkerTrajectories], names: Sequence[str]) -> Array:
    """(F, K, 3) well-seen frames spread over each of the trials.

    Args:
        trials: The trials.
        names: (K,) names of the markers, in the order wanted.
    """
    chosen = []
    for one in trials:
        columns = _in_order(one, names)
        seen = (~np.isnan(columns[:, :, 0])).sum(axis=1)
        good = np.flatnonzero(seen >= 0.5 * seen.max(initial=0))
        chosen.append(columns[good[spread_indices(len(good), SPREAD)]])
    return np.concatenate(chosen)


def _in_order(trial: MarkerTrajectories, names: Sequence[str]) -> Array:
    positions = np.full((trial.frames, len(names), 3), np.nan)
    column = {name: k for k, name in enumerate(names)}
    positions[:, [column[name] for name in trial.names]] = trial.positions_m
    return positions


def _height(points_m: Array) -> float:
    """How tall and narrow a frame's points stand: legs together and arms at the side are told apart best."""
    z, across = points_m[:, 2], points_m[:, :2]
    return float(
        np.nanmax(z) - np.nanmin(z) - 0.3 * (np.nanmax(across, axis=0) - np.nanmin(across, axis=0)).max()
    )
