"""Contacts of other parts than the feet that open and close while a filter goes on.

A contact shows some time after it began. Until then the filter gave the force to all else, and its accelerations,
velocities and reactions are wrong. So it goes back to an estimate before the contact began and takes the frames since
then again, with the contact; the estimate of now is that of a filter which knew of it all along. Answers that were
given stay.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.plausibility import plausible
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.sensors.block import Frame
from mbkf.sensors.supports.block import BEARING

REACH_S, KEPT_EVERY_S = 1.2, 0.1
"""Frames of the first duration can be taken again, from an estimate that is kept in every second one."""


class Noted(NamedTuple):
    """A frame with its estimate."""

    estimate: Posterior
    plates: Array


class ContactWatch(Protocol):
    """Finds parts of the body that bear load besides the feet, while a motion goes on.

    Attributes:
        began: Number of latest frames in which the contact that has opened acts already.
    """

    began: int

    def note(self, one: Noted) -> None:
        """Takes a frame; the estimate of a start begins anew."""

    def bearing(self) -> BoolArray:
        """(B,) parts that bear load from the next frame on, by all frames noted; the same until another is noted."""

    def again(self, frames: Sequence[Noted]) -> None:
        """Takes the latest frames anew, with estimates that know of the contact that has opened."""

    def forget(self) -> None:
        """Begins anew: the next frame follows none of those noted."""


class OpenContacts:
    """Opens contacts for a filter and takes frames again that they acted in.

    Attributes:
        watch: Finds them.
    """

    def __init__(self, filter: TrackingFilter, watch: ContactWatch) -> None:
        """Args: the filter, and what finds contacts."""
        self.watch, self._filter = watch, filter
        reach, self._every = (max(1, round(s / filter.dt_s)) for s in (REACH_S, KEPT_EVERY_S))
        self._frames: deque[Frame] = deque(maxlen=reach)
        self._kept: deque[tuple[int, Posterior]] = deque(maxlen=reach // self._every + 1)
        self._latest: Posterior | None = None
        self._number, self._bore = 0, False

    def note(self, estimate: Posterior, frame: Frame) -> None:
        """Takes a frame.

        Args:
            estimate: The filter's estimate.
            frame: The readings that it is made from, those of contacts among them.
        """
        if estimate.started:
            self._clear()
        self._number += 1
        self._frames.append(frame)
        if self._number % self._every == 0 or estimate.started:
            self._kept.append((self._number, estimate))
        self._latest = estimate
        self.watch.note(Noted(estimate, frame.plates))

    def added_to(self, recording: Recording, t: int) -> Recording:
        """The recording, for frame t, with the contacts that have opened besides those that it knows of."""
        flags = self.watch.bearing()
        if not np.count_nonzero(flags):
            return recording
        known = recording.readings.get(BEARING)
        opened = flags.astype(float) if known is None else np.maximum(known[t], flags)
        shown = np.broadcast_to(opened, (len(recording), len(flags)))
        return replace(recording, readings={**recording.readings, BEARING: shown})

    def opened(self) -> Posterior | None:
        """The estimate of the latest frame by a filter that knows of a contact which has opened; None without one."""
        bears, before = bool(np.count_nonzero(self.watch.bearing())), self._bore
        self._bore = bears
        if self._latest is None or not bears or before:
            return None
        self._latest = self._taken_again() or self._filter.widened(self._latest)
        return self._latest

    def forget(self) -> None:
        """Begins anew."""
        self._clear()
        self.watch.forget()

    def _clear(self) -> None:
        self._frames.clear()
        self._kept.clear()
        self._latest, self._bore = None, False

    def _taken_again(self) -> Posterior | None:
        """The estimate of the latest frame, from one before the contact began; None where that fails."""
        since = self._number - self.watch.began
        earlier = [(number, one) for number, one in self._kept if number <= since] or list(self._kept)[:1]
        if not earlier or len(self._frames) < self._number - earlier[-1][0]:
            return None
        first, estimate = earlier[-1]
        estimate, flags, found = self._filter.widened(estimate), self.watch.bearing().astype(float), []
        for number, frame in enumerate(list(self._frames)[first - self._number :], first + 1):
            read = {**frame.readings, BEARING: flags} if number > since else frame.readings
            recording = Recording.of([frame._replace(readings=read)], self._filter.dt_s)
            try:
                estimate = self._filter.step(estimate, recording, 0)
            except (np.linalg.LinAlgError, ArithmeticError, ValueError):
                return None
            if not plausible(estimate, self._filter.model):
                return None
            found.append(Noted(estimate, frame.plates))
        self.watch.again(found)
        return estimate
