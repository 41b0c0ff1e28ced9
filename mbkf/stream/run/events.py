"""The events of a live run (frames lost, plates silent, filter restarted …): each once, with times and count."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection
from dataclasses import asdict, dataclass

MERGED_S = 2.0
"""An event of the same kind within this time prolongs the one before."""

EACH = ("verdict", "limb", "person", "names", "chosen")
"""Kinds whose sentences differ in more than a number: each sentence is an event of its own."""

MOST = 300
"""Number of events that are listed one by one."""


@dataclass
class RunEvent:
    """An event of a live run, or several of one kind in quick succession.

    Attributes:
        kind: One word, e.g. "lost".
        what: One sentence.
        first_s: Time of the first occurrence, s from the start of the run.
        last_s: Time of the last occurrence, s.
        frame: Frame of the first occurrence, None for events without a frame.
        count: Number of occurrences.
    """

    kind: str
    what: str
    first_s: float
    last_s: float
    frame: int | None
    count: int


class EventLog:
    """Collects events from several threads.

    Attributes:
        begin_s: Start of the run on the log's clock, s.
    """

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        """Args: the clock, in s, that event times are read from."""
        self._clock, self.begin_s = clock, clock()
        self._lock = threading.Lock()
        self._events: list[RunEvent] = []
        self._latest: dict[str, RunEvent] = {}
        self._unlisted = 0

    def note(self, kind: str, what: str, frame: int | None = None, count: int = 1) -> None:
        """Records an event that happens now.

        Args:
            kind: One word; an event of the same kind within :data:`MERGED_S` is prolonged instead.
            what: One sentence.
            frame: Frame it happened at, None where it belongs to none.
            count: Number of occurrences at once.
        """
        at_s = self._clock() - self.begin_s
        with self._lock:
            known = self._latest.get(kind)
            alike = known is not None and (kind not in EACH or known.what == what)
            if known is not None and alike and at_s - known.last_s <= MERGED_S:
                known.last_s, known.count = at_s, known.count + count
                return
            event = RunEvent(kind, what, at_s, at_s, frame, count)
            self._latest[kind] = event
            if len(self._events) < MOST:
                self._events.append(event)
            else:
                self._unlisted += 1

    def sentences(self, kinds: Collection[str]) -> tuple[str, ...]:
        """Sentences of the events of some kinds, in order of time, each once.

        Args:
            kinds: The kinds.
        """
        with self._lock:
            return tuple(dict.fromkeys(event.what for event in self._events if event.kind in kinds))

    def plain(self) -> list[dict[str, object]]:
        """All events as plain data, for JSON."""
        with self._lock:
            listed = [asdict(event) for event in self._events]
            if self._unlisted:
                listed.append({"kind": "unlisted", "what": "further events", "count": self._unlisted})
            return listed
