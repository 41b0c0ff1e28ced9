"""Ring buffer between the thread that reads a stream and the filter: it overwrites old frames instead of growing.

It holds the frames of a short time, so that a pause of the machine loses none; of a longer time when the filter starts.
When the filter falls behind by more, all frames but the latest are dropped, which bounds the latency. Frames that come
at once, after a pause of their sender, are not behind yet and are all taken.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class RingBuffer(Generic[T]):
    """Holds a limited number of items; a full buffer drops all of them for the next one."""

    def __init__(
        self,
        size: int,
        patient: bool = False,
        stale: Callable[[T, T], bool] | None = None,
        joined: Callable[[list[T], T], T] | None = None,
    ) -> None:
        """An empty buffer.

        Args:
            size: Items held at most.
            patient: Whether a full buffer makes the writer wait instead of dropping items.
            stale: Whether the oldest item is too old beside the newest; until it is, a buffer whose size was reduced by
                :meth:`allow` holds up to its first size, since items that come at once are soon taken. None for always.
            joined: Makes of items that are dropped and the next one that next one; None leaves it as it is.
        """
        self._size, self._patient = max(1, size), patient
        self._most, self._stale, self._joined = self._size, stale, joined
        self._items: deque[T] = deque()
        self._changed = threading.Condition()
        self._closed = False

    def allow(self, size: int) -> None:
        """Holds so many items at most from now on; those that are held already stay."""
        with self._changed:
            self._size = max(1, size)
            self._changed.notify_all()

    def put(self, item: T) -> list[T]:
        """A new item; a closed buffer overwrites none. Returns the items it overwrote."""
        with self._changed:
            while self._patient and len(self._items) >= self._size and not self._closed:
                self._changed.wait()
            overwritten: list[T] = []
            if len(self._items) >= self._size and not self._closed and self._too_old(item):
                overwritten.extend(self._items)
                self._items.clear()
            self._items.append(
                item if self._joined is None or not overwritten else self._joined(overwritten, item)
            )
            self._changed.notify_all()
            return overwritten

    def _too_old(self, newest: T) -> bool:
        return self._stale is None or len(self._items) >= self._most or self._stale(self._items[0], newest)

    def take(self, timeout_s: float) -> T | None:
        """The oldest item held; None where none comes for so long, or ever (see :attr:`ended`)."""
        with self._changed:
            if not self._items:
                self._changed.wait_for(lambda: self._items or self._closed, timeout_s)
            if not self._items:
                return None
            item = self._items.popleft()
            self._changed.notify_all()
            return item

    def close(self) -> None:
        """Refuses further items; those held can still be taken."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    @property
    def empty(self) -> bool:
        """True while it holds no item."""
        return not self._items

    def left(self) -> list[T]:
        """The items still in the buffer, oldest first."""
        with self._changed:
            return list(self._items)

    @property
    def ended(self) -> bool:
        """True once it is closed and empty."""
        with self._changed:
            return self._closed and not self._items
