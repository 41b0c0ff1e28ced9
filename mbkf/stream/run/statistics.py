"""Counts and latencies of a live run, for live.json."""

from __future__ import annotations

from array import array

from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.run.report import latency_summary

RECENT_FRAMES = 5000
"""While a run goes on, its latencies are those of so many frames."""


class RunStatistics:
    """Counts of a run.

    Attributes:
        first, latest: First and latest frame taken, None before the first.
        processed: Frames that arrived and were answered; each has a row in the log.
        starts: Starts of the filter, the first included.
    """

    def __init__(self) -> None:
        self.first: ReadyFrame | None = None
        self.latest: ReadyFrame | None = None
        self.processed = self.starts = 0
        self._latencies_s, self._at_start_s = array("d"), array("d")

    def taken(self, frame: ReadyFrame) -> ReadyFrame | None:
        """Counts a frame as taken from the ring buffer; returns the one before it."""
        before, self.latest = self.latest, frame
        if self.first is None:
            self.first = frame
        return before

    def answered(self, latency_s: float, at_start: bool) -> None:
        """Counts the latency of an answered frame beyond the lag, separately for frames that waited for a start."""
        (self._at_start_s if at_start else self._latencies_s).append(latency_s)

    def latencies(self, recent: bool) -> dict[str, float | None]:
        """Latencies in ms, of recent frames only where asked for."""
        count = RECENT_FRAMES if recent else 0
        return latency_summary(self._latencies_s[-count:], self._at_start_s[-count:])

    def rates(self, nominal_hz: float) -> dict[str, object]:
        """Measured and nominal frame rate, and the number of starts."""
        first, latest = self.first, self.latest
        rate = None
        if first is not None and latest is not None and latest.arrival_s > first.arrival_s:
            rate = (self.processed - 1) / (latest.arrival_s - first.arrival_s)
        return {"rate_hz": rate, "nominal_rate_hz": nominal_hz, "starts": self.starts}
