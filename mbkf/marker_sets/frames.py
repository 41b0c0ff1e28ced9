"""Frames of captures from which a marker set is inferred: one of standing, and some of the movement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.numerics.runs import spread_indices

SPREAD = 16
"""Number of frames of a movement."""

NEARLY_ALL = 0.9
"""Least number of markers in a well-seen frame, as a share of those in the best frame."""


def anchor_frames(trials: Sequence[MarkerTrajectories], names: Sequence[str], count: int) -> Array:
    """(F, K, 3) well-seen frames: the tallest of each of so many parts of the trials, the tallest of all first.

    Args:
        trials: The trials.
        names: (K,) names of the markers, in their order.
        count: Number of frames.
    """
    columns = np.concatenate([_in_order(one, names) for one in trials])
    seen = (~np.isnan(columns[:, :, 0])).sum(axis=1)
    good = np.flatnonzero(seen >= NEARLY_ALL * seen.max(initial=0))
    height = np.array([_height(columns[t]) for t in good])
    parts = [part for part in np.array_split(np.arange(len(good)), count) if len(part)]
    tallest = sorted((part[np.argmax(height[part])] for part in parts), key=lambda k: -height[k])
    return columns[good[tallest]]


def spread_frames(trials: Sequence[MarkerTrajectories], names: Sequence[str]) -> Array:
    """(F, K, 3) well-seen frames spread over each of the trials, with markers in the order of names (K,)."""
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
    """Height of a frame's points less 0.3 of their width: limbs are separated best in upright, narrow postures."""
    z, across = points_m[:, 2], points_m[:, :2]
    return float(
        np.nanmax(z) - np.nanmin(z) - 0.3 * (np.nanmax(across, axis=0) - np.nanmin(across, axis=0)).max()
    )
