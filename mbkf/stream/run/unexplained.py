"""Unexplained loads of a live run: judged in every answered frame, noted as an event, listed in live.json."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.filters.record import UNASKED
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, KeptContact
from mbkf.stream.receiving.alignment import Note, ReadyFrame
from mbkf.stream.run.contacts import ContactList
from mbkf.trial.live.filter import LiveInputs
from mbkf.trial.loads.running import RunningLoad, RunningLoads

MOST = 100
"""Number of loads that are listed."""

HINT = "no contact gives it; torques and reactions are not to be used"


@dataclass
class _Stated:
    """A load while it is stated."""

    from_s: float
    to_s: float
    vector_n: Array
    explained: bool = False


class LoadWatch:
    """Judges the frames of a run, one after another.

    Attributes:
        read: Plates read every loaded foot in the latest frame.
        contacts: Contacts of other parts than the feet; their forces count as explained.
    """

    def __init__(self, live: LiveInputs, rate_hz: float, note: Note) -> None:
        """Makes it.

        Args:
            live: The filter's inputs.
            rate_hz: The stream's rate.
            note: Called with the beginning of a load.
        """
        inputs = live.inputs
        self._model, self._rate_hz, self._note = inputs.sensor.model, rate_hz, note
        self._running = RunningLoads(self._model, rate_hz)
        self._feet = ContactDetector(self._model, inputs.plates, inputs.dt_s) if inputs.plates else None
        self._memory: KeptContact | None = None if self._feet is None else self._feet.begin()
        self.contacts = ContactList(tuple(self._model.description.bearings), note)
        self._first: int | None = None
        self._loads: list[_Stated] = []
        self._acts = self._sized = False
        self.read = False

    def push(self, ready: ReadyFrame, row: NDArray) -> RunningLoad:
        """The judgement of an answered frame.

        Args:
            ready: Its readings.
            row: (1,) the log's row of it.
        """
        if self._first is None:
            self._first = ready.number
        found = row[0]
        if found["started"]:
            self._running.balance.cut()
        on_feet_n, judged = self._on_feet(ready, row)
        self.read = judged
        time_s = (ready.number - self._first) / self._rate_hz
        if self.contacts.push(found["support"], time_s, ready.number):
            self._running.balance.explained()
            if self._acts and self._loads:
                self._loads[-1].explained = True
        q = found["q"] if found["known"] else None
        others_n = np.nan_to_num(found["support"][:, :3]).sum(axis=0)
        load = self._running.push(q, on_feet_n, others_n, ready.plates, judged)
        self._listed(load, time_s, ready.number)
        return load

    def stated(self) -> tuple[UnexplainedLoad, ...]:
        """Loads stated so far whose size is known, but for those that a contact gives which opened after."""
        return tuple(self._load(one) for one in list(self._loads) if one.vector_n.any() and not one.explained)

    def lists(self) -> dict[str, object]:
        """Loads and contacts so far, for live.json."""
        return {"unexplained": self.plain(), "contacts": self.contacts.plain()}

    def plain(self) -> list[dict[str, object]]:
        """Loads stated so far, for live.json."""
        found: list[dict[str, object]] = []
        for load in [self._load(one) for one in list(self._loads) if one.vector_n.any()]:
            found.append(
                {
                    "from_s": load.from_s,
                    "to_s": load.to_s,
                    "force_n": load.force_n,
                    "direction": load.direction,
                    "share_of_weight": load.share,
                }
            )
        return found

    def _on_feet(self, ready: ReadyFrame, row: NDArray) -> tuple[Array | None, bool]:
        """(3,) force on the feet, None where that is not known, and whether plates read every loaded foot."""
        found = row[0]
        if self._feet is None or not found["known"]:
            return None, False
        if found["footing"][0] != UNASKED:
            on_feet_n, footing = found["wrench"][:, :3].sum(axis=0), tuple(found["footing"])
        else:
            assert self._memory is not None
            decision = self._feet.decide(self._memory, found["q"], found["v"], found["a"], ready.plates)
            self._memory, footing = decision.memory, decision.contacts
            wrench = decision.wrench if decision.shared is None else decision.shared.wrench
            on_feet_n = wrench[:, :3].sum(axis=0)
        return on_feet_n, bool(found["tracked"]) and Contact.UNMEASURED not in footing

    def _listed(self, load: RunningLoad, time_s: float, number: int) -> None:
        """Lists a load, and notes where it begins."""
        if load.acts and not self._acts and len(self._loads) < MOST:
            self._loads.append(_Stated(time_s, time_s, np.zeros(3)))
            self._sized = False
        if load.acts and self._loads:
            latest, force_n = self._loads[-1], np.nan_to_num(load.force_n)
            latest.to_s = time_s
            if np.linalg.norm(force_n) > np.linalg.norm(latest.vector_n):
                latest.vector_n = force_n
            if not self._sized and latest.vector_n.any():  # its size is the mean of half a second
                self._sized = True
                self._note("unexplained", self._load(latest).sentence_now, number, 1)
        self._acts = load.acts

    def _load(self, one: _Stated) -> UnexplainedLoad:
        x, y, z = (float(component) for component in one.vector_n)
        share = float(np.linalg.norm(one.vector_n)) / (self._model.mass_kg * GRAVITY_M_S2)
        return UnexplainedLoad(one.from_s, one.to_s, (x, y, z), float("nan"), share, "", HINT)
