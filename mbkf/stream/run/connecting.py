"""Waiting for a source that is not there yet."""

from __future__ import annotations

import threading
import time

from mbkf.errors import InvalidInput
from mbkf.stream.source import FrameSource, StreamDescription

CONNECT_S = 0.5
"""Length of one attempt to connect, after which the run checks for its end."""


def wait_for(
    source: FrameSource, source_name: str, stop: threading.Event, patience_s: float | None
) -> StreamDescription | None:
    """A stream's description once its source is connected; None where it was stopped first.

    Args:
        source: The source of frames.
        source_name: Its name, for messages.
        stop: Set when the run is to end.
        patience_s: Longest wait; None for as long as it takes.

    Raises:
        InvalidInput: The source did not appear in time.
        MbkfError: The stream cannot be used.
    """
    begin = time.perf_counter()
    while not stop.is_set():
        found = source.connect(CONNECT_S)
        if found is not None:
            return found
        if patience_s is not None and time.perf_counter() - begin > patience_s:
            raise InvalidInput(
                f"no {source_name} stream appeared within {patience_s:.0f} s; start it, or 'mbkf replay', and check "
                "its name and the network"
            )
    return None
