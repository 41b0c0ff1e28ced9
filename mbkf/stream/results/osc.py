"""Open Sound Control: a frame's numbers as one bundle of messages.

Source: Open Sound Control Specification 1.0 (Wright 2002), sections OSC Packets and OSC Bundles.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.results.frame import LiveFrame

ROOT = "/mbkf"
"""Every address begins with it."""

AT_ONCE = struct.pack(">Q", 1)
"""Time tag of a bundle that is due when it arrives."""


class OscBundles:
    """Makes bundles of frames: ``/mbkf/NAME`` for each number but standard deviations."""

    def __init__(self, names: Sequence[str]) -> None:
        """Args: names of the numbers of a frame."""
        self._sent = [k for k, name in enumerate(names) if "_sd" not in name]
        self._heads = [text(f"{ROOT}/{names[k]}") + text(",f") for k in self._sent]

    def bundle(self, frame: LiveFrame, values: Array) -> bytes:
        """The bundle of a frame; unknown numbers are left out.

        Args:
            frame: The frame.
            values: (n,) its numbers.
        """
        word = "" if frame.judgement is None else frame.judgement.verdict.overall
        parts = [
            message("frame", ",i", struct.pack(">i", frame.number & 0x7FFFFFFF)),
            message("time", ",d", struct.pack(">d", frame.time_s)),
            message("latency", ",f", struct.pack(">f", frame.latency_s)),
            message("usable", ",i", struct.pack(">i", frame.valid)),
            message("verdict_word", ",s", text(word)),
        ]
        numbers = values[self._sent]
        for head, number, known in zip(self._heads, numbers, np.isfinite(numbers), strict=True):
            if known:
                parts.append(head + struct.pack(">f", number))
        return text("#bundle") + AT_ONCE + b"".join(struct.pack(">i", len(part)) + part for part in parts)


def message(name: str, tags: str, payload: bytes) -> bytes:
    """A message.

    Args:
        name: Of the value, below the root.
        tags: Types of its arguments.
        payload: The arguments.
    """
    return text(f"{ROOT}/{name}") + text(tags) + payload


def text(value: str) -> bytes:
    """A text, closed by a nought and filled up to four bytes."""
    data = value.encode("ascii", "replace") + b"\0"
    return data + b"\0" * (-len(data) % 4)
