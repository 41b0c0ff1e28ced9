"""What later readings tell of a frame while it moves on: the backward pass over a window of frames after it.

The gradient is carried back frame by frame (:mod:`mbkf.numerics.smoothing`), with products of matrix and vector that
cost next to nothing. The curvature L is not: but over one frame, with P its posterior covariance, Λ its readings, Φ the
transition into it and E = Φ − P Λ Φ,

    L ← Eᵀ L E + Eᵀ Λ Φ

and such passages over neighbouring frames join into one, in any grouping (Särkkä 2021). A window that gains a frame at
its end and loses one at its beginning is therefore kept joined with few products per frame, however long it is
(Tangwongsan 2015): from each of its older frames to a boundary, and over all frames after the boundary.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.numerics.smoothing import BackwardPass


class LinearStep(NamedTuple):
    """A filter's step into a frame.

    Attributes:
        P: (N, N) posterior covariance.
        information: (N, N) Λ = HᵀR⁻¹H of the frame's readings.
        vector: (N,) λ = HᵀR⁻¹y with the innovation y of the prior.
        transition: (N, N) Φ from the frame before.
    """

    P: Array
    information: Array
    vector: Array
    transition: Array


class Passage(NamedTuple):
    """From after the readings of a frame to after those of an earlier one: L ← Eᵀ L E + M.

    Attributes:
        matrix: (N, N) E.
        curvature: (N, N) M.
    """

    matrix: Array
    curvature: Array

    @classmethod
    def over(cls, step: LinearStep) -> Passage:
        """Over one frame."""
        told = step.information @ step.transition
        matrix = step.transition - step.P @ told
        return cls(matrix, matrix.T @ told)

    def after(self, earlier: Passage) -> Passage:
        """This one and then, further back, an earlier one."""
        return Passage(self.matrix @ earlier.matrix, earlier.carried(self.curvature))

    def carried(self, curvature: Array) -> Array:
        """(N, N) a curvature after its frames, brought before them."""
        return self.matrix.T @ curvature @ self.matrix + self.curvature


class _Joined:
    """Passages over the frames of a window, in two parts: up to a boundary, and after it."""

    def __init__(self) -> None:
        self._to_boundary: list[Passage] = []
        """From each frame before the boundary, the first frame's last."""
        self._single: list[Passage] = []
        self._beyond: Passage | None = None

    def append(self, passage: Passage) -> None:
        self._single.append(passage)
        self._beyond = passage if self._beyond is None else passage.after(self._beyond)

    def drop(self) -> None:
        if self._to_boundary:
            self._to_boundary.pop()
            return
        total: Passage | None = None
        for passage in self._single[:0:-1]:
            total = passage if total is None else total.after(passage)
            self._to_boundary.append(total)
        self._single, self._beyond = [], None

    @property
    def curvature(self) -> Array | None:
        first = self._to_boundary[-1] if self._to_boundary else None
        if first is None or self._beyond is None:
            only = first or self._beyond
            return None if only is None else only.curvature
        return first.carried(self._beyond.curvature)


class LaterWindow:
    """The frames that follow one frame, which moves on as they come."""

    def __init__(self, covariances: bool = True) -> None:
        """Args: whether covariances are wanted, too; they cost several times as much."""
        self._steps: deque[LinearStep] = deque()
        self._joined = _Joined() if covariances else None

    def __len__(self) -> int:
        return len(self._steps)

    def append(self, step: LinearStep) -> None:
        """A frame more at the end."""
        self._steps.append(step)
        if self._joined is not None:
            self._joined.append(Passage.over(step))

    def drop(self) -> None:
        """The first frame leaves."""
        self._steps.popleft()
        if self._joined is not None:
            self._joined.drop()

    def told(self) -> BackwardPass | None:
        """What all its frames tell of the frame before them; None where there is none."""
        if not self._steps:
            return None
        back = BackwardPass(len(self._steps[0].vector), covariances=False)
        for step in reversed(self._steps):
            back.through_readings(step.P, step.information, step.vector)
            back.through_plant(step.transition)
        if self._joined is not None:
            back.curvature = self._joined.curvature
        return back
