"""Contacts of other parts than the feet, opened and closed while a motion goes on.

Where an unexplained force is stated (:mod:`mbkf.trial.loads.running`), the search of a trial
(:mod:`mbkf.sensors.supports.search`) runs on the last second and a half of filtered motion. A part that it finds bears
from the next frame on, unless a wrong mass, unequal clocks or a foot beside its plate explains the force, too
(:mod:`mbkf.trial.loads.causes`). Its wrench then is a state of the filter; the contact closes where that has become
small.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray, read_only
from mbkf.filters.contact_opening import Noted
from mbkf.model.body import Body
from mbkf.numerics.runs import runs
from mbkf.sensors.contact.plates import force_read
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.supports.search import LASTING_S, LASTING_SHARE, LEAST_SHARE, other_contacts
from mbkf.trial.loads.balance import LoadBalance
from mbkf.trial.loads.running import RunningLoad, RunningLoads
from mbkf.trial.loads.unexplained import unexplained_loads

SEARCHED_S, SEARCHED_HZ = 1.5, 100.0
"""Duration of the motion that is searched, at no more frames a second than this."""

CAUSES_S = 3.0
"""Duration of the motion by which likelier causes are judged."""

AGAIN_S, OFTEN_S, RARELY_S = 0.1, 1.0, 1.0
"""A force that no part explains is searched again in the first interval, from the second duration on in the third."""

RECHECKED_S = (0.25, 0.5, 1.0)
"""So long after a contact has opened, it is looked at again: which part bears shows better then."""

NOW_S = 0.05
"""A part bears now where it bears in any of the last frames of so long."""

LANDED_SHARE, TOGETHER_S, STANCE_S, AFTER_S = 0.02, 0.2, 1.0, 0.5
"""A foot stands while it bears more than the first share of body weight. A plate may read a part of a step alone: where
a force begins within the second time of a landing, no contact opens during that stance, unless the stance lasts longer
than the third time. Nor does one open in the fourth time after the stance, over which forces are averaged. Set on five
walks with half a step beside a plate (``python -m benchmarks loads``)."""

LEFT_S = 0.1
"""A contact closes when the mean of its force over such a time is small, or is not judged for :data:`LASTING_S`."""


_NO_FORCE_N = read_only(np.zeros(3))
"""Force of other contacts than the feet where none are open."""


class _Kept(NamedTuple):
    """A frame."""

    q: Array
    v: Array
    centre_m: Array
    wrench: Array
    others_n: Array
    judged: bool


@dataclass(frozen=True)
class _OfFeet:
    """Loads of the feet in the frames that are searched (:class:`mbkf.sensors.supports.search.FeetLoads`)."""

    wrench: Array
    valid: BoolArray
    floor_m: float


class ContactOpener:
    """Takes frames in order, one by one (:class:`mbkf.filters.contact_opening.ContactWatch`).

    Attributes:
        flags: (B,) parts that bear.
        began: Number of latest frames in which the contact that has opened acts already.
    """

    def __init__(
        self, model: Body, rate_hz: float, floor_m: float, unobservable: BoolArray | None = None
    ) -> None:
        """Makes it.

        Args:
            model: The body.
            rate_hz: Frame rate.
            floor_m: Height of the floor, that of the lowest plate.
            unobservable: (nv,) dofs that move no marker; None: markers show every dof.
        """
        self._model, self._rate_hz, self._floor_m, self._unobservable = model, rate_hz, floor_m, unobservable
        self._weight_n, self._running = model.mass_kg * GRAVITY_M_S2, RunningLoads(model, rate_hz)
        self._every = max(1, round(rate_hz / SEARCHED_HZ))
        self._kept: deque[_Kept] = deque(maxlen=self._frames(CAUSES_S))
        self._none = np.zeros(len(model.description.bearings), dtype=bool)
        self.forget()

    def forget(self) -> None:
        """Begins anew: the next frame follows none of those noted."""
        self._running.forget()
        self._load: RunningLoad | None = None
        self._kept.clear()
        self.flags, self._lighter = self._none, float("nan")
        self._noted: Noted | None = None
        self._open = self._stated = self._unjudged = self.began = 0

    def note(self, one: Noted) -> None:
        """Takes a frame; it is judged when it is asked which parts bear, after its answer."""
        if one.estimate.started:
            self.forget()
        self._noted = one

    def _judge(self, one: Noted) -> None:
        """Judges a frame."""
        estimate, plates = one
        others_n = _NO_FORCE_N if estimate.support is None else estimate.support[:, :3].sum(axis=0)
        read = estimate.contact is not None and Contact.UNMEASURED not in estimate.contact
        judged = bool(read and estimate.tracked and force_read(plates)[0])
        on_feet_n = estimate.wrench[0, :3] + estimate.wrench[1, :3]
        self._load = self._running.push(estimate.q, on_feet_n, others_n, plates, judged)
        whole = judged and not self._running.strays
        self._kept.append(
            _Kept(estimate.q, estimate.v, self._running.centre_m, estimate.wrench, others_n, whole)
        )
        self._unjudged = 0 if whole else self._unjudged + 1
        self._stated = self._stated + 1 if self._load.acts else 0
        self._open += 1

    def again(self, frames: Sequence[Noted]) -> None:
        """Takes the latest frames anew, with estimates that know of the contact that has opened."""
        for _ in range(min(len(frames), len(self._kept))):
            self._kept.pop()
        self._running.balance.explained()
        for one in frames:
            self._judge(one)
        self._open = 0

    def bearing(self) -> BoolArray:
        """(B,) parts that bear load from the next frame on."""
        if self._noted is not None:
            one, self._noted = self._noted, None
            self._judge(one)
            if self.flags is not self._none:
                self._look_again()
            elif self._searches():
                found = self._found()
                if found.any() and not self._began_with_a_step() and self._is_load():
                    self._change(found)
        return self.flags

    def _searches(self) -> bool:
        """True in frames in which a stated force is searched."""
        if not self._stated:
            return False
        often = self._stated <= self._frames(OFTEN_S)
        return (self._stated - 1) % self._frames(AGAIN_S if often else RARELY_S) == 0

    def _look_again(self) -> None:
        """Closes contacts that have been left, or lets other parts take their place."""
        if self._left():
            self._change(self._none)
        elif self._open in [self._frames(s) for s in RECHECKED_S] or self._searches():
            found = self._found()
            if found.any():
                self.flags = found

    def _change(self, flags: BoolArray) -> None:
        """Opens contacts, or closes them."""
        self._running.balance.explained()
        self._open = self._stated = 0
        self.flags = flags

    def _left(self) -> bool:
        """True where the contacts bear no load any more."""
        if self._unjudged > self._frames(LASTING_S):
            return True
        last = self._last(LEFT_S)
        if self._open <= len(last):
            return False
        force = np.mean([one.others_n for one in last], axis=0)
        least, lighter = LASTING_SHARE, self._lighter
        if np.isnan(lighter):  # a mass may be wrong by as much
            least, lighter = LEAST_SHARE, 0.0
        force[2] -= lighter * self._weight_n
        return float(np.linalg.norm(force)) < least * self._weight_n

    def _found(self) -> BoolArray:
        """(B,) parts through which the missing force leads now."""
        kept = list(self._kept)[:: -self._every][: round(SEARCHED_S * self._rate_hz / self._every)][::-1]
        rate_hz, judged = self._rate_hz / self._every, np.array([one.judged for one in kept])
        q, v = (np.array([getattr(one, name) for one in kept]) for name in ("q", "v"))
        feet = _OfFeet(np.array([one.wrench for one in kept]), judged, self._floor_m)
        found = other_contacts(self._model, q, v, rate_hz, feet, judged, unobservable=self._unobservable)
        flags = found.flags[-max(1, round(NOW_S * rate_hz)) :].any(axis=0)
        free = np.flatnonzero(~found.flags[:, flags].any(axis=1))
        now = max(1, round(NOW_S * rate_hz))
        before = free[free < len(kept) - now]
        self.began = self._every * (len(kept) - 1 - int(before[-1]) if len(before) else len(kept))
        if (
            not self.flags.any()
        ):  # while a contact is open, frames without a missing force are those of its beginning
            self._lighter = found.lighter
        return np.asarray(flags)

    def _began_with_a_step(self) -> bool:
        """True where the force began as a foot landed whose stance lasts or is just over."""
        feet_n = np.array([one.wrench[:, :3] for one in self._kept])
        count, began = len(feet_n), len(feet_n) - self.began
        for force_n in np.linalg.norm(feet_n, axis=2).T:
            for first, after in runs(force_n > LANDED_SHARE * self._weight_n):
                brief = first > 0 and after - first <= self._frames(STANCE_S)
                late = count - after <= self._frames(AFTER_S)
                if brief and late and abs(began - first) <= self._frames(TOGETHER_S):
                    return True
        return False

    def _is_load(self) -> bool:
        """True where a force acts now that no wrong mass, unequal clocks or foot beside its plate explains."""
        kept = list(self._kept)[:: -self._every][::-1]
        judged = np.array([one.judged for one in kept])
        balance = LoadBalance(
            self._rate_hz / self._every,
            self._model.mass_kg,
            np.array([one.centre_m for one in kept]),
            np.where(judged[:, None, None], [one.wrench[:, :3] for one in kept], 0.0),
            np.where(judged[:, None], [one.others_n for one in kept], 0.0),
            judged,
        )
        times_s = np.arange(len(kept)) / balance.rate_hz
        since = times_s[-1] - 2.0 * NOW_S
        now = [one for one in unexplained_loads(balance, times_s).loads if one.to_s >= since]
        return bool(now) and all(one.cause == "" for one in now)

    def _last(self, seconds: float) -> Sequence[_Kept]:
        """The frames of the last seconds."""
        frames = max(1, self._frames(seconds))
        return list(self._kept)[-frames:]

    def _frames(self, seconds: float) -> int:
        return round(seconds * self._rate_hz)
