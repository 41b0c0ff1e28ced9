"""A filter's way through a trial, frame by frame: start, steps, a restart after a loss, and limbs set right.

Where a frame shows the body elsewhere than it was predicted (it was moved while it was hidden, or the capture has a
cut), or the estimate is implausible (:mod:`mbkf.filters.plausibility`), the same frame starts anew: a filter would take
a jump for a movement, and its readings would correct the frames before. Where the start is implausible, too, the frame
has no estimate, and the next one starts anew. A limb in doubt (:mod:`mbkf.filters.limb_watch`) is set right in the same
frame, while the rest of the body goes on.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from mbkf.filters.contact_opening import ContactWatch, OpenContacts
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.limb_mend import LimbMend
from mbkf.filters.limb_search import agrees
from mbkf.filters.limb_watch import LimbWatch
from mbkf.filters.plausibility import plausible
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.sensors.limb_starts import Order

VELOCITY_S = 0.04
"""Time between the two poses that give the velocity of a limb where a track is taken up again."""

MOST_TAKEN_UP = 8
"""A track is taken up again at earlier frames at most so many times."""


class TrackingLoop:
    """Drives a filter from frame to frame, through a whole trial or a live stream alike.

    Attributes:
        filter: The filter.
        estimate: The latest estimate, None before the first start and after an implausible one.
        again: The latest frame has no answer yet and is to be given again, with those after it.
        implausible: The latest frame has no estimate, since its start was implausible.
        watch: Watches the limbs; None for a filter that follows no markers.
        mend: Better pose of a limb that the latest frame was given; None in most frames.
        contacts: Contacts of other parts than the feet that open and close on the way; None: those of the recording.
    """

    def __init__(self, filter: TrackingFilter, contacts: ContactWatch | None = None) -> None:
        self.filter = filter
        self.contacts = None if contacts is None else OpenContacts(filter, contacts)
        self.estimate: Posterior | None = None
        self.again = self.implausible = False
        self.watch = None if filter.limbs is None else LimbWatch(filter.limbs, filter.dt_s)
        self.mend: LimbMend | None = None
        self._number = 0
        self._lost_for = 0
        self._prediction: Prediction | None = None
        self._rejoined = False
        self._renamed: tuple[Recording, Order, Recording] | None = None

    @property
    def frames(self) -> int:
        """Number of frames that have been answered, with an estimate or without."""
        return self._number

    @property
    def must_start(self) -> bool:
        """True where the next frame tries a start, which needs the frames after it, too."""
        lost = self._lost_for * self.filter.dt_s > self.filter.restart_after_s
        return self.estimate is None or lost or self.again

    def predict(self) -> Prediction | None:
        """Prediction of the next frame, None where it has to start; the step into that frame goes on from it."""
        if self.estimate is None or self.must_start:
            return None
        self._rejoined = self._opened() or self._rejoined
        if self._prediction is None:
            self._prediction = self.filter.predict(self.estimate)
        return self._prediction

    def advance(self, recording: Recording, t: int) -> Posterior | None:
        """The estimate of frame t, the one after the latest; None as long as no start has succeeded, and ``again``."""
        with np.errstate(all="ignore"):  # the result is checked
            return self._advanced(recording, t)

    def _advanced(self, recording: Recording, t: int) -> Posterior | None:
        rejoined, self._rejoined = self._opened() or self._rejoined, False
        before, fresh = self.estimate, None
        prediction, self._prediction = self._prediction, None
        starting, self.again, self.mend = self.must_start, False, None
        named = self._named(recording)
        if self.contacts is not None:
            named = self.contacts.added_to(named, t)
        if starting:
            fresh = self.filter.start(named, t, None if before is None else before.q)
        if fresh is None and before is not None:
            fresh = self.filter.step(before, named, t, prediction)
        astray = fresh is not None and not plausible(fresh, self.filter.model)
        self.implausible = astray and starting
        if self.implausible:
            self._number += 1
            self.forget()
            return None
        if fresh is not None and not starting and (astray or fresh.lost):
            self.again = True
            return None
        if fresh is not None:
            fresh = self._watched(before, fresh, recording, t)
            fresh = fresh._replace(rejoined=True) if rejoined else fresh
            self.estimate = fresh
            self._lost_for = 0 if fresh.tracked else self._lost_for + 1
            if self.contacts is not None:
                self.contacts.note(fresh, named.frame(t))
        self._number += 1
        return fresh

    def _opened(self) -> bool:
        """Goes on from an estimate that knows a contact that has opened; True where one has."""
        found = None if self.contacts is None or self.estimate is None else self.contacts.opened()
        if found is None:
            return False
        self.estimate, self._prediction = found, None
        return True

    def take_up(
        self, before: Posterior | None, recording: Recording, t: int, mend: LimbMend
    ) -> Posterior | None:
        """The estimate of an earlier frame t with a limb set right, from which the track goes on.

        Args:
            before: Estimate of the frame before; None where the filter started in frame t.
            recording: The readings.
            t: The frame.
            mend: The limb.
        """
        self._number, self._prediction, self.again = t + 1, None, False
        if self.watch is not None:
            self.watch.back_to(t)
        self.estimate = self.filter.mended(before, self._named(recording), t, mend)
        self._lost_for = 0
        return self.estimate

    def _watched(self, before: Posterior | None, fresh: Posterior, recording: Recording, t: int) -> Posterior:
        """The estimate, with a limb set right where it is in doubt and a better pose is known."""
        if self.watch is None:
            return fresh
        self.mend = self.watch.look(self._number, fresh, recording.markers_m[t])
        if self.mend is None:
            return fresh
        after = None if fresh.started else before
        found = self.filter.mended(after, self._named(recording), t, self.mend)
        if found is None or not plausible(found, self.filter.model):
            self.mend = None
            return fresh
        return found

    def _named(self, recording: Recording) -> Recording:
        """The recording under the names that the watch has found."""
        order = None if self.watch is None else self.watch.order
        if order is None:
            return recording
        if self._renamed is None or self._renamed[0] is not recording or self._renamed[1] is not order:
            named = replace(recording, markers_m=recording.markers_m[:, order])
            self._renamed = recording, order, named
        return self._renamed[2]

    def forget(self) -> None:
        """Drops the estimate; the next frame has to start anew."""
        self.estimate, self._lost_for, self._prediction, self.again = None, 0, None, False
        if self.contacts is not None:
            self.contacts.forget()


def followed(
    loop: TrackingLoop, recording: Recording, earliest: Callable[[], int] | None = None
) -> Iterator[tuple[int, Posterior, float]]:
    """The estimates with their frames and computing times, s; frames before the first start have none.

    Where a limb was set right, the track may be taken up again at an earlier frame, from which on the limb was wrong:
    frames then come again, the first of them as a start.

    Args:
        loop: The filter's loop, which has seen no frame.
        recording: The readings.
        earliest: Gives the first frame that may come again; None: frames come once, as in a live run.
    """
    kept: deque[tuple[int, Posterior]] = deque()
    t, taken_up = 0, 0
    while t < len(recording):
        begin = time.perf_counter()
        fresh = loop.advance(recording, t)
        if loop.again:
            fresh = loop.advance(recording, t)
        if fresh is not None and earliest is not None:
            if loop.mend is not None and taken_up < MOST_TAKEN_UP:
                taken_up += 1
                since, mend = _wrong_since(loop, recording, t, kept, loop.mend)
                if since < t:
                    while kept and kept[-1][0] >= since:
                        last = kept.pop()
                    before = kept[-1][1] if kept and not last[1].started else None
                    t, fresh = since, loop.take_up(before, recording, since, mend)
            while kept and kept[0][0] < min(earliest(), t) - 1:
                kept.popleft()
            if fresh is not None:
                fresh = loop.filter.kept(fresh)
                kept.append((t, fresh))
        if fresh is not None:
            yield t, fresh, time.perf_counter() - begin
        t += 1
    if loop.watch is not None:
        loop.watch.finish(len(recording))


def _wrong_since(
    loop: TrackingLoop, recording: Recording, t: int, kept: deque[tuple[int, Posterior]], mend: LimbMend
) -> tuple[int, LimbMend]:
    """The first of the kept frames, one after the other back from t, in which the limb lies elsewhere than it should.

    Args:
        loop: The loop.
        recording: The readings.
        t: Frame of the mend.
        kept: Frames before it with their estimates.
        mend: The limb's pose in frame t.

    Returns:
        That frame, and the limb in it.
    """
    watch, model, course = loop.watch, loop.filter.model, [mend]
    assert watch is not None
    for number, estimate in reversed(kept):
        if number != t - 1:
            break
        earlier = watch.carried(course[-1], number, estimate.q, recording.markers_m[number])
        if earlier is None or agrees(model, estimate.q, earlier):
            break
        t = number
        course.append(earlier)
        if estimate.started:
            break
    steps = min(len(course) - 1, max(1, round(VELOCITY_S / loop.filter.dt_s)))
    first, later = course[-1], course[-1 - steps]
    if steps:
        v = model.difference(first.q, later.q)[first.dofs] / (steps * loop.filter.dt_s)
        first = replace(first, v=v)
    return t, first
