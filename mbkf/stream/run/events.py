"""What happened during a live run, for people: each thing once, with when, how long and how often."""

from __future__ import annotations

import threading
from dataclasses import asdict, dataclass
from typing import Any

MERGED_S = 2.0
"""The same thing again within this time is one event that goes on."""

MOST = 500
"""No more events than this are told one by one."""


@dataclass
class Event:
    """Something that happened.

    Attributes:
        kind: A word for it.
        what: A sentence.
        first_s: When it began, from the start of the run.
        last_s: When it happened last.
        frame: Frame at which it began.
        count: How often.
    """

    kind: str
    what: str
    first_s: float
    last_s: float
    frame: int | None
    count: int


class Events:
    """Collects events from several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._events: list[Event] = []
        self._latest: dict[str, Event] = {}
        self._unlisted = 0

    def note(self, kind: str, what: str, at_s: float, frame: int | None = None, count: int = 1) -> None:
        """Something happened.

        Args:
            kind: A word; the same one again soon is the same event.
            what: A sentence.
            at_s: When, from the start of the run.
            frame: At which frame.
            count: How often at once.
        """
        with self._lock:
            known = self._latest.get(kind)
            if known is not None and at_s - known.last_s <= MERGED_S:
                known.last_s, known.count = at_s, known.count + count
                return
            event = Event(kind, what, at_s, at_s, frame, count)
            self._latest[kind] = event
            if len(self._events) < MOST:
                self._events.append(event)
            else:
                self._unlisted += 1

    def plain(self) -> list[dict[str, Any]]:
        """All of them, as plain data."""
        with self._lock:
            listed = [asdict(event) for event in self._events]
            if self._unlisted:
                listed.append({"kind": "unlisted", "what": "further events", "count": self._unlisted})
            return listed

    def counts(self) -> dict[str, int]:
        """How often each kind happened, among those listed."""
        with self._lock:
            total: dict[str, int] = {}
            for event in self._events:
                total[event.kind] = total.get(event.kind, 0) + event.count
            return total
