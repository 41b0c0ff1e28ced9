"""Frames in which a person enters the measured volume: few markers fit many poses, and the first ones seen err most.

Software that solves clusters extrapolates them at the border of the volume by 0.1 to 0.3 m, and a filter that starts
from these samples refuses right ones later on.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.numerics.runs import runs

LEAST_SHARE = 0.5
"""Share of the most markers of a stretch with which it begins. On the walk that it was set on, poses from fewer lie
20 to 60 mm from their markers, those from more 6 to 10 mm."""

LONGEST_S = 1.0
"""A person passes the border of the volume in so much time; fewer markers for longer are seen of a part of the body."""


def without_entering(
    markers: MarkerTrajectories, fewest: int, gap_s: float
) -> tuple[MarkerTrajectories, tuple[str, ...]]:
    """The trajectories without samples of frames in which the person enters the volume, and a note on these.

    Args:
        markers: The subject's markers.
        fewest: Number of markers from which on a frame can be followed.
        gap_s: Time with fewer after which the body is sought anew.
    """
    count, rate_hz = markers.present.sum(axis=1), markers.rate_hz
    entering = np.zeros(markers.frames, dtype=bool)
    for first, after in _stretches(count >= fewest, round(gap_s * rate_hz)):
        seen = count[first:after]
        begin = int(np.argmax(seen >= LEAST_SHARE * seen.max()))
        if begin <= LONGEST_S * rate_hz:
            entering[first : first + begin] = True
    frames = int(entering.sum())
    if not frames:
        return markers, ()
    last_s = float(markers.times_s[np.flatnonzero(entering)[-1]])
    note = (
        f"in {frames} frames (the last at {last_s:.2f} s) the person enters the measured volume, with less than half "
        "of the markers seen later: they show many poses, and are left out"
    )
    return replace(markers, positions_m=np.where(entering[:, None, None], np.nan, markers.positions_m)), (
        note,
    )


def _stretches(seen: BoolArray, gap: int) -> list[tuple[int, int]]:
    """First frame and the one after the last of each stretch in which a body is seen, with gaps of so many frames."""
    found: list[tuple[int, int]] = []
    for first, after in runs(seen):
        if found and first - found[-1][1] <= gap:
            found[-1] = found[-1][0], after
        else:
            found.append((first, after))
    return found
