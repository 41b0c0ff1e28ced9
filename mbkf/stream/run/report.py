"""live.json: frames received and lost, latencies and events of a live run, kept up to date while it runs.

Its space on disk is reserved at the start, so that it can still be written when the disk is full.
"""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.io.atomic import replacing
from mbkf.io.leftovers import errors_name
from mbkf.io.utf8 import encoded
from mbkf.stream.receiving.receiver import FrameCounts

LIVE_FILE = "live.json"

ROOM_BYTES = 128 * 1024
"""Space reserved for it on disk."""


class ReportFile:
    """A JSON file rewritten in place."""

    def __init__(self, path: Path) -> None:
        """Makes the file and reserves its space.

        Raises:
            OSError: It cannot be written.
        """
        self._path, self._lock = path, threading.Lock()
        with replacing(path) as partial:
            partial.write_bytes(b"{}\n".ljust(ROOM_BYTES))

    def write(self, report: Mapping[str, object], last: bool = False) -> None:
        """Writes the report over the one before; the last one gives the rest of the room back.

        Raises:
            OSError: It is larger than its room, and no other is left.
        """
        text = json.dumps(_finite(report), indent=2, allow_nan=False, ensure_ascii=False)
        content = encoded(text + "\n")
        with self._lock, errors_name(self._path), self._path.open("r+b") as file:
            file.write(content if last else content.ljust(ROOM_BYTES))
            if last:
                file.truncate()


def frame_report(counts: FrameCounts, answered: int, unlogged: int, running: bool) -> dict[str, int]:
    """Fates of the frames: each one received was written, or is counted under one reason why it was not.

    ``frames_in = frames_written + frames_not_written + frames_unanswered + frames_late + frames_overwritten``, and
    ``frames_lost = frames_lost_on_the_way + frames_overwritten + frames_unanswered + frames_not_written``; a frame that
    came late had been missed on the way before.

    Args:
        counts: Of the receiving side.
        answered: Frames received for which there is a row.
        unlogged: Of these, frames whose rows are not in the log.
        running: The run goes on; frames that wait to be answered are then not counted as received.
    """
    waiting = counts.received - counts.late - counts.overwritten - answered
    unanswered = 0 if running else waiting
    return {
        "frames_in": counts.received - (waiting if running else 0),
        "frames_lost": counts.lost_on_the_way + counts.overwritten + unanswered + unlogged,
        "frames_lost_on_the_way": counts.lost_on_the_way,
        "frames_overwritten": counts.overwritten,
        "frames_late": counts.late,
        "frames_unanswered": unanswered,
        "frames_processed": answered,
    }


def latency_summary(latencies_s: Sequence[float], at_start_s: Sequence[float]) -> dict[str, float | None]:
    """Latencies in ms, from arrival to result without the lag, and of frames that waited for a start of the filter.

    A start looks a quarter of a second ahead and has to catch up; where there are no other frames, the percentiles are
    those of the frames at a start.
    """
    milliseconds = 1e3 * np.array(latencies_s if len(latencies_s) else at_start_s, dtype=float)
    known = len(milliseconds) > 0
    return {
        "latency_ms_median": float(np.median(milliseconds)) if known else None,
        "latency_ms_p95": float(np.percentile(milliseconds, 95)) if known else None,
        "latency_ms_p99": float(np.percentile(milliseconds, 99)) if known else None,
        "latency_ms_max": float(milliseconds.max()) if known else None,
        "latency_ms_max_at_start": 1e3 * max(at_start_s) if at_start_s else None,
        "frames_at_start": len(at_start_s),
    }


def _finite(value: Any) -> Any:
    """Plain data with NaN and infinities as None."""
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
