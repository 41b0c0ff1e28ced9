"""Hands all that a stream brings, frame by frame, to the recording in the run's log."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.frame_log import FrameLogWriter
from mbkf.stream.source import PlateSamples, SourceFrame, plausible
from mbkf.trial.live.recording import MOST_POINTS, POINT_DTYPE, RecordingFiles

Put = Callable[[FrameLogWriter, NDArray], None]
"""Takes rows for a file; returns at once."""


class Recorder:
    """Takes the frames of the receiving thread."""

    def __init__(self, files: RecordingFiles, put: Put) -> None:
        """Args: the recording, and what writes its rows."""
        self._files, self._put = files, put
        self._newest: int | None = None

    def take(self, number: int | None, frame: SourceFrame, samples: PlateSamples) -> None:
        """A frame as it came.

        Args:
            number: Its number in the run; None for one that came too late.
            frame: The frame.
            samples: The plates' samples that came with it, as the run numbers them.
        """
        files = self._files
        if number is not None:
            row = np.zeros(1, dtype=files.markers.dtype)
            row["number"], row["markers"] = number, plausible(frame.markers_m)[0]
            row["residuals"] = self._residuals(frame)[: len(frame.markers_m)]
            self._put(files.markers, row)
        if number is not None and len(frame.unlabelled_m):
            seen = plausible(frame.unlabelled_m)[0]
            kept = np.flatnonzero(~np.isnan(seen).any(axis=1))[:MOST_POINTS]
            points = np.zeros(len(kept), dtype=POINT_DTYPE)
            points["number"], points["point"] = number, seen[kept]
            points["residual"] = self._residuals(frame)[len(frame.markers_m) :][kept]
            self._put(files.points, points)
        fresh = samples.index if self._newest is None else samples.index[samples.index > self._newest]
        if len(fresh):
            rows = np.zeros(len(fresh), dtype=files.samples.dtype)
            rows["index"], rows["wrench"] = fresh, samples.wrench[-len(fresh) :]
            self._put(files.samples, rows)
            self._newest = int(fresh[-1])

    @staticmethod
    def _residuals(frame: SourceFrame) -> Array:
        """(M + N,) residuals of markers and points, NaN where they are not known."""
        count = len(frame.markers_m) + len(frame.unlabelled_m)
        return np.full(count, np.nan) if frame.residuals_m is None else frame.residuals_m
