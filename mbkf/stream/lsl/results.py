"""Results as a Lab Streaming Layer stream: one channel per angle, moment, reaction and standard deviation.

Beside it a stream of markers tells the running verdict: a line of text whenever the judgement changes.
"""

from __future__ import annotations

import numpy as np

from mbkf.stream.libraries import lsl
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.results.sending import SendingThread
from mbkf.stream.results.values import ResultValues

RESULTS_TYPE = "Biomechanics"

VERDICT_SUFFIX, VERDICT_TYPE = "-verdict", "Markers"
"""Name of the stream of verdicts, after that of the results, and its type."""


class LslResults:
    """A :class:`mbkf.stream.results.frame.FrameSink`; a stamp is the time of sending less the frame's latency."""

    def __init__(self, values: ResultValues, name: str, rate_hz: float) -> None:
        """Opens the stream.

        Args:
            values: Makes the numbers; receivers of one run share it.
            name: Name of the stream.
            rate_hz: Frame rate.
        """
        self._lsl = lsl()
        self._values = values
        extra = (("frame", "none"), ("tracked", "none"), ("latency", "s"))
        count = len(self._values.names) + len(extra)
        info = self._lsl.StreamInfo(
            name, RESULTS_TYPE, count, rate_hz, self._lsl.cf_double64, f"mbkf-results-{name}"
        )
        channels = info.desc().append_child("channels")
        named = [*zip(self._values.names, self._values.units, strict=True), *extra]
        for label, unit in named:
            entry = channels.append_child("channel")
            entry.append_child_value("label", label)
            entry.append_child_value("unit", unit)
        self._outlet = self._lsl.StreamOutlet(info)
        told, irregular = name + VERDICT_SUFFIX, 0.0
        markers = self._lsl.StreamInfo(
            told, VERDICT_TYPE, 1, irregular, self._lsl.cf_string, f"mbkf-results-{told}"
        )
        self._verdicts = self._lsl.StreamOutlet(markers)
        self._judgement: Judgement | None = None
        self._thread = SendingThread(self._send, "mbkf-lsl-results")

    def take(self, frame: LiveFrame) -> None:
        """Hands the frame over."""
        self._thread.take(frame)

    def close(self) -> None:
        """Ends the stream."""
        self._thread.close()
        self._outlet = self._verdicts = None

    def _send(self, frame: LiveFrame) -> None:
        row = np.append(self._values.row(frame), [frame.number, frame.tracked, frame.latency_s])
        stamp = self._lsl.local_clock() - frame.latency_s
        self._outlet.push_sample(row, stamp)
        if frame.judgement is not None and frame.judgement is not self._judgement:
            self._judgement = frame.judgement
            self._verdicts.push_sample([frame.judgement.verdict.line], stamp)
