"""Contacts of other parts than the feet in a live run: noted as events, listed with their times in live.json."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.contacts import bearing
from mbkf.stream.receiving.alignment import Note

MOST = 100
"""Number of contacts that are listed."""

MOST_SAID = 6
"""Number of contacts that stand beside the running verdict."""


@dataclass
class _Open:
    """A contact."""

    part: str
    from_s: float
    to_s: float
    peak_n: float


class ContactList:
    """Takes the wrenches of a run's frames, one after another."""

    def __init__(self, names: Sequence[str], note: Note) -> None:
        """Makes it.

        Args:
            names: The B parts that may bear load besides the feet.
            note: Called with the beginning of a contact.
        """
        self._names, self._note = tuple(names), note
        self._contacts: list[_Open] = []
        self._latest: dict[str, _Open] = {}

    def push(self, support: Array, time_s: float, number: int) -> bool:
        """The contacts of a frame.

        Args:
            support: (B, 6) wrenches on the parts; NaN where the filter has no such contacts.
            time_s: Time since the first frame.
            number: The frame.

        Returns:
            True where a contact has opened or closed.
        """
        before, now = self._latest, {}
        for k in np.flatnonzero(bearing(support[None])[0]):
            name, force_n = self._names[k], float(np.linalg.norm(support[k, :3]))
            one = before.get(name)
            if one is None:
                one = _Open(name, time_s, time_s, 0.0)
                self._note("contact", f"the {name.replace('_', ' ')} bears load: a contact opened", number, 1)
                if len(self._contacts) < MOST:
                    self._contacts.append(one)
            one.to_s, one.peak_n = time_s, max(one.peak_n, force_n)
            now[name] = one
        self._latest = now
        return bool(now) != bool(before)

    def sentences(self) -> tuple[str, ...]:
        """The latest contacts in words; one that is open has no end and no largest force yet."""
        return tuple(
            f"the {one.part.replace('_', ' ')} "
            + (
                f"bears load since {one.from_s:.2f} s"
                if self._latest.get(one.part) is one
                else f"bore up to {one.peak_n:.0f} N from {one.from_s:.2f} to {one.to_s:.2f} s"
            )
            for one in list(self._contacts)[-MOST_SAID:]
        )

    def plain(self) -> list[dict[str, object]]:
        """The contacts so far, for live.json."""
        return [
            {"part": one.part, "from_s": one.from_s, "to_s": one.to_s, "peak_n": one.peak_n}
            for one in list(self._contacts)
        ]
