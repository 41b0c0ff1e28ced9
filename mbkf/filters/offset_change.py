"""Change of the offset with the posture: the part of errors by the body that varies within a trial.

An error by the body is B_t e in frame t, with e ~ N(0, I) the same in all frames (:mod:`mbkf.filters.body_errors`).
About its mean over the trial it is (B_t − B̄) e, with B̄ the mean of B over the trial, so that its variances are the
squared sums of the rows of B_t − B̄. B̄ is the mean over the instants at which roots are worked out, 0.1 s apart.

Live there is no mean over the trial: a frame takes that over the instants so far. A trial is gone through once more
when its mean is known, with the roots that were kept; those of a long trial's later instants are worked out anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.model.clinical import ClinicalAngles

Root: TypeAlias = NDArray[np.float32]
"""Root of errors, one row for each number."""

KEPT_BYTES = 60_000_000
"""Memory for the roots of a trial: those of a minute, for a body with 52 dofs."""


class ReadRoots(NamedTuple):
    """Roots of the numbers that people read; each has r columns.

    Attributes:
        angle: (A, r) of the clinical coordinates.
        rate: (A, r) of their rates.
        torque: (nv, r) of the generalised forces.
        wrench: (12, r) of the feet's wrenches.
    """

    angle: Root
    rate: Root
    torque: Root
    wrench: Root


@dataclass(frozen=True)
class OffsetChange:
    """Standard deviations of the change of the offset about its mean.

    Attributes:
        angle: (A,) of the clinical coordinates, rad or m.
        rate: (A,) of their rates.
        torque: (nv,) of the generalised forces.
        wrench: (2, 6) of the feet's wrenches.
    """

    angle: Array
    rate: Array
    torque: Array
    wrench: Array


@dataclass(frozen=True)
class _Instant:
    """First frame of a stretch whose frames share their roots, its configuration, and the roots if they are kept."""

    number: int
    q: Array
    roots: ReadRoots | None


class OffsetChanges:
    """Follows the roots along a trial."""

    def __init__(self, clinical: ClinicalAngles, whole_trial: bool = False) -> None:
        """Args: the clinical coordinates, and True where :meth:`about_the_whole` will be asked for."""
        self._clinical, self._whole_trial = clinical, whole_trial
        self._latest: BodyErrorRoots | None = None
        self._sums: list[Array] = []
        self._count, self._room = 0, KEPT_BYTES
        self._instants: list[_Instant] = []
        self._change: OffsetChange | None = None

    def so_far(self, number: int, q: Array, roots: BodyErrorRoots) -> OffsetChange:
        """Change of the offset in a frame about the mean over the instants so far, its own among them.

        Args:
            number: The frame; frames come in order.
            q: (nq,) configuration.
            roots: Its roots; the same object for all frames of a stretch.
        """
        if self._change is None or roots is not self._latest:
            self._latest = roots
            read = self._read(q, roots)
            self._add(read)
            if self._whole_trial:
                size = sum(one.nbytes for one in read)
                fits = size <= self._room
                self._room -= size if fits else 0
                self._instants.append(_Instant(number, q.copy(), read if fits else None))
            self._change = self._about_mean(read)
        return self._change

    def about_the_whole(
        self, again: Callable[[int], BodyErrorRoots]
    ) -> Iterator[tuple[int, int | None, OffsetChange]]:
        """Changes about the mean of the whole trial: of the frames from one number up to another, None for the end.

        Args:
            again: Works out the roots of a frame anew.
        """
        ends = [*(one.number for one in self._instants[1:]), None]
        for one, end in zip(self._instants, ends, strict=False):
            roots = one.roots or self._read(one.q, again(one.number))
            yield one.number, end, self._about_mean(roots)

    def _read(self, q: Array, roots: BodyErrorRoots) -> ReadRoots:
        E = self._clinical.rate_matrix(q)
        found = (E @ roots.position, E @ roots.velocity, roots.torque, roots.wrench)
        return ReadRoots(*(one.astype(np.float32) for one in found))

    def _add(self, roots: ReadRoots) -> None:
        self._sums = self._sums or [np.zeros(one.shape) for one in roots]
        self._count += 1
        self._sums = [total + one for total, one in zip(self._sums, roots, strict=True)]

    def _about_mean(self, roots: ReadRoots) -> OffsetChange:
        angle, rate, torque, wrench = (
            _row_norms(one - total / self._count) for one, total in zip(roots, self._sums, strict=True)
        )
        return OffsetChange(angle, rate, torque, wrench.reshape(2, 6))


def _row_norms(root: Array) -> Array:
    """(n,) roots of the squared sums of rows."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", root, root)))
