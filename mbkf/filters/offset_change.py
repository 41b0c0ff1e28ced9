"""Change of the offset with the posture: the part of errors by the body that varies within a trial.

An error by the body is B_t e in frame t, with e ~ N(0, I) the same in all frames (:mod:`mbkf.filters.body_errors`).
About its mean over the trial it is (B_t − B̄) e, with B̄ the mean of B over the trial, so that its variances are the
squared sums of the rows of B_t − B̄. B̄ is the mean over the instants at which roots are worked out.

It needs the whole trial, so that it is worked out when the trial is over: with the roots that were kept, as far as
there is memory for them, and with those of later instants worked out anew.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots, BodyErrors
from mbkf.filters.record import Stretches, Track, roots_again
from mbkf.model.clinical import ClinicalAngles

Float32: TypeAlias = NDArray[np.float32]

KEPT_BYTES = 60_000_000
"""Memory for the roots of a trial: those of about a minute, for a body with 52 dofs."""


class ReadRoots(NamedTuple):
    """Roots of the numbers that people read; each has as many columns as its part of the errors by the body.

    Attributes:
        angle: (A, r) of the clinical coordinates.
        rate: (A, r) of their rates.
        torque: (nv, r) of the generalised forces.
        wrench: (12, r) of the feet's wrenches.
    """

    angle: Float32
    rate: Float32
    torque: Float32
    wrench: Float32


CHANGES = tuple(f"{name}_change" for name in ReadRoots._fields)
"""Fields of a track that hold the changes."""


class OffsetChanges:
    """Changes of the offsets of a trial."""

    def __init__(
        self, body: BodyErrors, clinical: ClinicalAngles, dt_s: float, room: int | None = None
    ) -> None:
        """Makes it.

        Args:
            body: The errors by the body.
            clinical: The clinical coordinates.
            dt_s: Time between frames.
            room: Memory for roots, bytes; others are worked out twice. None: :data:`KEPT_BYTES`.
        """
        self._body, self._clinical, self._dt_s = body, clinical, dt_s
        self._latest: BodyErrorRoots | None = None
        self._begins: list[int] = []
        self._sums: list[Array] = []
        self._kept: dict[int, ReadRoots] = {}
        self._room = KEPT_BYTES if room is None else room

    def follow(self, number: int, q: Array, roots: BodyErrorRoots) -> None:
        """Takes the roots of a frame; frames of a stretch share one object, and its first one counts.

        Args:
            number: The frame; frames come in order.
            q: (nq,) configuration.
            roots: The roots.
        """
        if roots is self._latest:
            return
        self._latest = roots
        read = self._read(q, roots)
        self._sums = self._sums or [np.zeros(one.shape) for one in read]
        for one, total in zip(read, self._sums, strict=True):
            np.add(total, one, out=total)
        self._begins.append(number)
        size = sum(one.nbytes for one in read)
        if size <= self._room:
            self._kept[number], self._room = read, self._room - size

    def follow_all(self, rows: NDArray) -> None:
        """Takes the roots of all frames of a trial whose roots were not kept, from its records (T,)."""
        stretches = Stretches(self._dt_s)
        for t in np.flatnonzero(rows["known"]):
            if stretches.begins(int(rows["number"][t]), bool(rows["started"][t])):
                self.follow(int(t), rows["q"][t], roots_again(self._body, rows[t]))

    def added_to(self, track: Track, rows: NDArray, begin: int = 0) -> Track:
        """The trial, or a part of it, with the standard deviations of changes about their mean over the trial.

        They are NaN in frames without an estimate, and at the beginning of a part until the next roots.

        Args:
            track: The trial or the part; it is not changed.
            rows: (T,) records of all its frames, with those that were followed (:mod:`mbkf.filters.record`).
            begin: Number of the part's first frame.
        """
        begins = [one - begin for one in self._begins if 0 <= one - begin < len(rows)]
        if not begins:
            return track
        means = [(total / len(self._begins)).astype(np.float32) for total in self._sums]
        found = [np.full((len(rows), len(mean)), np.nan, np.float32) for mean in means]
        for first, end in zip(begins, [*begins[1:], len(rows)], strict=True):
            stretch = first + np.flatnonzero(rows["known"][first:end])
            roots = self._kept.get(begin + first) or self._read(
                rows["q"][first], roots_again(self._body, rows[first])
            )
            for changes, root, mean in zip(found, roots, means, strict=True):
                apart = root - mean
                changes[stretch] = np.sqrt(np.einsum("ij,ij->i", apart, apart))
        changed: dict[str, Any] = dict(zip(CHANGES, found, strict=True))
        changed["wrench_change"] = found[-1].reshape(-1, 2, 6)
        return replace(track, **changed)

    def _read(self, q: Array, roots: BodyErrorRoots) -> ReadRoots:
        E = self._clinical.rate_matrix(q).astype(np.float32)
        position, velocity, torque, wrench = (
            one.astype(np.float32) for one in (roots.position, roots.velocity, roots.torque, roots.wrench)
        )
        return ReadRoots(E @ position, E @ velocity, torque, wrench)
