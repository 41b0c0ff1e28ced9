"""A live frame as plain data for JSON: its numbers, beside the verdict's word."""

from __future__ import annotations

import math

from mbkf.conventions import Array
from mbkf.stream.results.frame import LiveFrame


def frame_message(frame: LiveFrame, values: Array) -> dict[str, object]:
    """Plain data of a frame.

    Args:
        frame: The frame.
        values: (n,) its numbers, as :class:`mbkf.stream.results.values.ResultValues` gives them; ``None`` for unknown
            ones in the message.
    """
    return {
        "frame": frame.number,
        "time_s": frame.time_s,
        "tracked": frame.tracked,
        "latency_s": frame.latency_s,
        "lost": frame.lost,
        "rate_hz": frame.rate_hz,
        "valid": frame.valid,
        "verdict": None if frame.judgement is None else frame.judgement.verdict.overall,
        "values": [value if math.isfinite(value) else None for value in values.tolist()],
    }
