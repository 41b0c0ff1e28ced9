"""Prompts for the person to be scaled: the missing condition, and failures of scaling, at a readable pace."""

from __future__ import annotations

import time
from collections.abc import Callable

from mbkf.stream.run.events import EventLog

TELL_S, AGAIN_S = 5.0, 10.0
"""Least interval between two reasons to wait, and between two prompts of the same reason."""


class Prompting:
    """Says sentences to the person, and notes them as events.

    Attributes:
        refused: Reason of the last failure to scale; "" before the first one.
    """

    def __init__(self, say: Callable[[str], None], events: EventLog) -> None:
        """Args: function that takes the sentences, and the run's events."""
        self.say, self._events = say, events
        self.refused, self._refused_s = "", -AGAIN_S
        self._reason, self._reported_s = "", events.begin_s

    def waiting(self, reason: str) -> None:
        """Says the reason to wait."""
        now = time.perf_counter()
        if now - self._reported_s >= (AGAIN_S if reason == self._reason else TELL_S):
            self.say(f"waiting for a person to stand still: {reason}")
            self._events.note("waiting", reason)
            self._reason, self._reported_s = reason, now

    def scaling(self, frames: int, named: bool) -> None:
        """Says that scaling begins, unless a failure was reported a moment ago."""
        self._reason = ""
        stay = "" if named else ", which takes some seconds as points have no names: stay where you are"
        if time.perf_counter() - self._refused_s >= AGAIN_S:
            self.say(f"standing still; scaling from {frames} frames{stay} …")

    def failed(self, why: str) -> None:
        """Says that scaling failed."""
        self._events.note("scaling", why)
        now = time.perf_counter()
        if why != self.refused or now - self._refused_s >= AGAIN_S:
            self.say(f"scaling failed: {why}; stand still once more")
            self.refused, self._refused_s = why, now
