"""Reading a source frame by frame: errors of its library become events, and the run goes on."""

from __future__ import annotations

import threading
from collections.abc import Callable

from mbkf.stream.source import FrameSource, SourceFrame

READ_S = 0.1
"""Longest wait for a frame, so that a thread notices soon when it is to stop."""

SILENT_S = 1.0
"""A source without frames for this long counts as silent, which is an event of the run."""

PAUSE_S = 0.5
"""Time until a source is read again after an unforeseen error."""


def next_frame(
    source: FrameSource, note: Callable[[str, str], None], stopping: threading.Event
) -> SourceFrame | None:
    """The next frame of a connected source; None where none came in time, or the source failed.

    Args:
        source: The source.
        note: Called with events: kind and sentence.
        stopping: Ends the pause after a failure.

    Raises:
        EOFError: No more frames will ever come.
    """
    try:
        frame = source.read(READ_S)
        news = source.news()
    except EOFError:
        raise
    except Exception as error:  # libraries of sources raise errors of any kind
        note("source", f"the source failed ({type(error).__name__}: {error})")
        stopping.wait(PAUSE_S)
        return None
    for kind, sentence in news:
        note(kind, sentence)
    return frame
