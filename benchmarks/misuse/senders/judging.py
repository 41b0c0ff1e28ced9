"""Judgement of a run: where each frame that was sent is, whether its number is right, how soon answers were live."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array

SAME_M = 1e-5
"""A row of the log holds the frame that was sent whose markers it has, within single precision."""

SAME_LOAD = 1e-2
"""Readings of a plate agree within this, N or N m: NatNet sends single precision."""

LIVE_S, WITHIN_S = 0.05, 1.0
"""An answer is live where it comes so soon after its frame was sent; the first one has to come within so long."""

FATES = ("frames_late", "frames_overwritten", "frames_not_written", "frames_unanswered")


@dataclass(frozen=True)
class SentFrame:
    """A frame that was sent.

    Attributes:
        frame: Which of the capture.
        number: The number that it should have, from any first number on.
        at_s: When it was sent, on the clock of ``time.perf_counter``.
    """

    frame: int
    number: int
    at_s: float


def frames_in(measured_m: Array, markers_m: Array) -> NDArray[np.int64]:
    """(T,) which frame of a capture (F, M, 3) each row (T, M, 3) of a log holds; −1 for a row without markers.

    A row that holds no frame of the capture, as one with markers in a wrong order, is −2.
    """
    found = np.full(len(measured_m), -1)
    for k, row in enumerate(measured_m):
        seen = np.isfinite(row).all(axis=1)
        if seen.any():
            apart = np.nan_to_num(np.abs(markers_m[:, seen] - row[seen]), nan=np.inf).max(axis=(1, 2))
            best = int(np.argmin(apart))
            found[k] = best if apart[best] <= SAME_M else -2
    return found


def wrong_numbers(
    numbers: NDArray[np.int64], frames: NDArray[np.int64], sent: Sequence[SentFrame], apart: int
) -> int:
    """Number of rows whose number is not that of the frame that they hold.

    Args:
        numbers: (T,) numbers of rows that arrived.
        frames: (T,) the frame of each, from :func:`frames_in`.
        sent: All frames sent.
        apart: Difference that is allowed.
    """
    due = {one.frame: one.number for one in sent}
    known = frames >= 0
    if not known.any():
        return len(numbers)
    expected = np.array([due[frame] for frame in frames[known]])
    off = numbers[known] - expected
    return int((np.abs(off - off[0]) > apart).sum() + (frames == -2).sum())


def unaccounted(
    counts: Mapping[str, int], frames: NDArray[np.int64], sent: Sequence[SentFrame], whole: bool
) -> int:
    """Number of frames that were sent, are not in the log, and are counted under no reason.

    Args:
        counts: Those of live.json.
        frames: (T,) frames of the rows that arrived.
        sent: All frames sent, one that was sent twice twice.
        whole: Whether each that was sent must have been received.
    """
    missing = len(sent) - len(frames)
    known = sum(counts[fate] for fate in FATES)
    if not whole:
        known += counts["frames_lost_on_the_way"]
        return max(0, missing - known)
    return abs(missing - known)


def wrong_loads(found: Array, sent: Array) -> int:
    """Number of samples (S, K, 6) in a log that differ from those sent, where both are there."""
    count = min(len(found), len(sent))
    apart = np.abs(found[:count] - sent[:count])
    return int((np.nan_to_num(apart, nan=0.0) > SAME_LOAD).any(axis=(1, 2)).sum())


def first_live_s(answers: Sequence[tuple[float, int]], sent: Sequence[SentFrame], begin_s: float) -> float:
    """Time from a beginning to the first answer that is live; infinite without one.

    Args:
        answers: Time and frame of each answer.
        sent: All frames sent.
        begin_s: The beginning, from which frames are sent and received.
    """
    when = {one.frame: one.at_s for one in sent}
    live = (at_s for at_s, frame in answers if at_s - when.get(frame, -np.inf) <= LIVE_S)
    return next(live, float("inf")) - begin_s
