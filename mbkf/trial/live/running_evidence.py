"""Evidence of a live run so far: sums over its answered frames, a block at a time, and the verdict on them.

The verdict is the same function of the same evidence as that of a whole trial (:mod:`mbkf.trial.verdict`), so that a
run and ``reconstruct --causal`` of its frames come to the same words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from mbkf.filters.record import UNASKED
from mbkf.io.contacts import bearing, foot_sources
from mbkf.io.findings import Finding
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import Verdict
from mbkf.model.clinical import ClinicalAngles, dof_names
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.limb_starts import Order
from mbkf.trial.checks import mass
from mbkf.trial.live.filter import LiveInputs
from mbkf.trial.live.running_contacts import RunningContacts
from mbkf.trial.results.assembly import FOOT_SD_M
from mbkf.trial.results.innovations import SETTLING_S
from mbkf.trial.results.validity import torques_known
from mbkf.trial.verdict.evidence import Found, evidence_from
from mbkf.trial.verdict.fit import MarkerFrames
from mbkf.trial.verdict.judge import judge
from mbkf.trial.verdict.sums import Followed, Frames, TrialSums

BLOCK_S = 0.25
"""Frames of this time are added together."""

READ = frozenset((int(Contact.AIR), int(Contact.MEASURED)))
"""Contacts of a foot whose load needs no estimate."""

NAN = float("nan")


class RunningEvidence:
    """Takes the answered frames of a run one by one.

    Attributes:
        frames: Number of frames that are counted.
    """

    def __init__(self, live: LiveInputs, subject: Subject, rate_hz: float) -> None:
        """Evidence without a frame.

        Args:
            live: The filter's inputs.
            subject: The person.
            rate_hz: The stream's rate.
        """
        self._sensor = live.inputs.sensor
        model = self._model = self._sensor.model
        self._clinical, names = ClinicalAngles(model), dof_names(model)
        held = tuple(compress(names, live.inputs.unobservable))
        followed = Followed(subject, model, live.names, self._clinical.names, names, held, rate_hz)
        self._sums = TrialSums(followed)
        self._contacts = RunningContacts(tuple(model.description.bearings), rate_hz)
        self._block = max(1, round(BLOCK_S * rate_hz))
        self._rows: list[NDArray] = []
        self._known: list[bool] = []
        self._spoilt: list[bool] = []
        self._settles = int(np.ceil(SETTLING_S * rate_hz - 1e-6))
        self._next: int | None = None
        self._order: Order | None = None
        self._estimates_known: tuple[int, bool] | None = None

    @property
    def frames(self) -> int:
        """Number of frames so far, those of gaps included."""
        return self._sums.frames + len(self._rows)

    def push(self, row: NDArray, read: bool, acts: bool, order: Order | None = None) -> bool:
        """The next answered frame; True where every load is known in it, or would be without an unexplained one.

        Args:
            row: (1,) the log's row of it.
            read: Plates read every loaded foot.
            acts: An unexplained force acts.
            order: (M,) place in the stream of each marker that the filter reads; None: as the stream names them.
        """
        if len(self._rows) >= self._block:  # innovations of the latest row are filled in after it was pushed
            self._add()
        number = int(row["number"][0])
        if self._next is not None and number > self._next:
            self._add()
            self._sums.frames += number - self._next
        self._next = number + 1
        if order is not self._order:
            self._add()
            self._order = order
        known = self._loads_known(row, read)
        self._rows.append(row)
        self._known.append(known or acts)
        self._spoilt.append(acts)
        return known

    def verdict(self, found: Found) -> Verdict:
        """The verdict on the frames so far.

        Args:
            found: The evidence that is not gathered from frames; contacts are.
        """
        self._add()
        return judge(evidence_from(self._sums, replace(found, contacts=self._contacts.intervals())))

    def _add(self) -> None:
        """Adds the frames that wait."""
        if not self._rows:
            return
        # As bytes: numpy joins records field by field.
        rows = np.concatenate([row.view(np.uint8) for row in self._rows]).view(self._rows[0].dtype)
        first = self._sums.frames
        q, tracked, measured = rows["q"].copy(), rows["tracked"], rows["measured_m"]  # a copy is aligned
        if self._order is not None:
            measured = measured[:, self._order]
        known = rows["known"] & np.isfinite(q).all(axis=1)
        places = np.full(measured.shape, NAN)
        for t in np.flatnonzero(known):
            places[t] = self._sensor.positions(q[t])
        apart = measured - places
        squared = np.einsum("tmi,tmi->tm", apart, apart)
        markers = MarkerFrames(
            ~np.isnan(measured).any(axis=2),
            squared,
            tracked & known,
            rows["rejected"],
            rows["marker_nis"],
            np.arange(first, first + len(rows)) >= self._settles,
        )
        self._contacts.add(first, rows["support"])
        self._sums.add(Frames(q, markers, rows["angle_sd"], np.array(self._known), np.array(self._spoilt)))
        self._rows, self._known, self._spoilt = [], [], []

    def _loads_known(self, row: NDArray, read: bool) -> bool:
        """True where every load is read, or estimated so well that torques are known."""
        found = row[0]
        if not (found["tracked"] and (found["foot_height_sd"] <= FOOT_SD_M).all()):
            return False
        footing, support = found["footing"].tolist(), found["support"]
        if footing[0] == UNASKED:
            return read
        bears = support.size > 0 and bool((np.abs(support) > 0.0).any())  # NaN is not above 0
        if not bears and READ.issuperset(footing):
            return True
        block = self.frames // self._block
        if self._estimates_known is None or self._estimates_known[0] != block:
            self._estimates_known = block, self._torques_known(row)
        return self._estimates_known[1]

    def _torques_known(self, row: NDArray) -> bool:
        """True where the torques that an estimated load changes are known."""
        q, wrench, bears = row["q"].copy(), row["wrench"], bearing(row["support"])
        moments_sd = self._clinical.moments_sd(q, row["torque_sd"], self._clinical.angles(q))
        feet = foot_sources(row["footing"], wrench), wrench[:, :, 2]
        return bool(torques_known(self._model, self._clinical.names, moments_sd, *feet, bears)[0])


def with_causes(loads: Sequence[UnexplainedLoad], checks: Sequence[Finding]) -> tuple[UnexplainedLoad, ...]:
    """Loads with the cause that checks have found: a wrong mass moves the body as a vertical force does.

    Args:
        loads: Loads stated so far.
        checks: Checks of the run so far.
    """
    wrong = any(one.name == mass.NAME and one.verdict == "outside" for one in checks)
    vertical = ("upward", "downward")
    return tuple(replace(one, cause="mass") if wrong and one.direction in vertical else one for one in loads)
