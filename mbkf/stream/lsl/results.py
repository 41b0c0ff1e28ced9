"""Results as a Lab Streaming Layer stream: one channel per angle, moment, reaction and standard deviation."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.stream.libraries import lsl
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.sending import SendingThread
from mbkf.stream.results.values import ResultValues

RESULTS_TYPE = "Biomechanics"


class LslResults:
    """A :class:`mbkf.stream.results.frame.FrameSink`; a stamp is the time of sending less the frame's latency."""

    def __init__(self, model: Body, name: str, rate_hz: float) -> None:
        """Opens the stream.

        Args:
            model: The scaled body.
            name: Name of the stream.
            rate_hz: Frame rate.
        """
        self._lsl = lsl()
        self._values = ResultValues(model)
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
        self._thread = SendingThread(self._send, "mbkf-lsl-results")

    def take(self, frame: LiveFrame) -> None:
        """Hands the frame over."""
        self._thread.take(frame)

    def close(self) -> None:
        """Ends the stream."""
        self._thread.close()
        self._outlet = None

    def _send(self, frame: LiveFrame) -> None:
        row = np.append(self._values.row(frame), [frame.number, frame.tracked, frame.latency_s])
        self._outlet.push_sample(row, self._lsl.local_clock() - frame.latency_s)
