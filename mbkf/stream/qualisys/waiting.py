"""Frames that wait for the forces of their time, which QTM hands on in chunks, and not for ever."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from math import ceil

import numpy as np

from mbkf.io.resample import WHOLE
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription

FORCES_WITHIN_S, SILENT_S = 0.1, 1.0
"""A frame waits so long for its forces; after so long without any it does not wait."""

HELD_SAMPLES = 20_000
"""Samples of the plates that wait for their frame, at most."""

MOST_VAIN = 20
"""After so many frames in a row that waited in vain, forces are numbered otherwise than frames, or come later."""


class WaitingFrames:
    """Joins frames and the plates' samples until each frame's end."""

    def __init__(self, stream: StreamDescription, report: Callable[[str, str], None]) -> None:
        """Args: the stream's description, and what takes events."""
        self._plates, self._ratio = len(stream.plates), stream.plate_rate_hz / stream.rate_hz
        self._report = report
        self._samples: list[PlateSamples] = []
        self._held: deque[SourceFrame] = deque()
        self._newest, self._vain, self._forces_s = -1, 0, 0.0

    def put(self, frame: SourceFrame) -> None:
        """A frame without its samples."""
        self._held.append(frame)

    def put_samples(self, samples: PlateSamples, arrival_s: float) -> None:
        """Samples of the plates, and when they arrived."""
        if not len(samples.index):
            return
        self._samples.append(samples)
        while len(self._samples) > 1 and sum(len(one.index) for one in self._samples) > HELD_SAMPLES:
            self._samples.pop(0)
        self._newest, self._forces_s = int(samples.index[-1]), arrival_s

    def wait_s(self, now_s: float) -> float:
        """Longest time until the oldest frame is given without its forces; infinite without one."""
        return self._held[0].arrival_s + FORCES_WITHIN_S - now_s if self._held else np.inf

    def due(self) -> SourceFrame | None:
        """The oldest frame, once the forces of its time are here or are not waited for any more."""
        if not self._held:
            return None
        one, now = self._held[0], time.perf_counter()
        wanted = ceil((one.number + 0.5) * self._ratio - WHOLE)
        waits = self._vain < MOST_VAIN and now - self._forces_s < SILENT_S
        if self._plates and waits and self._newest < wanted:
            if now - one.arrival_s < FORCES_WITHIN_S:
                return None
            self._vain += 1
            if self._vain == MOST_VAIN:
                self._report(
                    "plates late", "QTM sends forces too late for their frames, which do not wait for them"
                )
        else:
            self._vain = MOST_VAIN if self._vain == MOST_VAIN else 0
        self._held.popleft()
        samples, self._samples = self._samples, []
        if not samples:
            return one
        plates = samples[0]
        if len(samples) > 1:
            index = np.concatenate([chunk.index for chunk in samples])
            plates = PlateSamples(index, np.concatenate([chunk.wrench for chunk in samples]))
        return replace(one, plates=plates)
