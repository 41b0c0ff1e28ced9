"""Information of a window of later frames on one frame, while the window moves on: the backward pass, kept joined.

The gradient is carried back frame by frame (:mod:`mbkf.numerics.smoothing`), with products of matrix and vector that
cost next to nothing. The curvature L costs more: over one frame, with P its posterior covariance, Λ its readings, Φ the
transition into it and E = Φ − P Λ Φ,

    L ← Eᵀ L E + Eᵀ Λ Φ

and such transitions over neighbouring frames join into one, in any grouping (Särkkä 2021). A window that gains a frame
at its end and loses one at its beginning is therefore kept joined with few products per frame, however long it is
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


class CurvatureTransition(NamedTuple):
    """From after the readings of a frame to after those of an earlier one: L ← Eᵀ L E + M.

    Attributes:
        matrix: (N, N) E.
        curvature: (N, N) M.
    """

    matrix: Array
    curvature: Array

    @classmethod
    def over(cls, step: LinearStep) -> CurvatureTransition:
        """Over one frame."""
        known = step.information @ step.transition
        matrix = step.transition - step.P @ known
        return cls(matrix, matrix.T @ known)

    def after(self, earlier: CurvatureTransition) -> CurvatureTransition:
        """This one and then, further back, an earlier one."""
        return CurvatureTransition(self.matrix @ earlier.matrix, earlier.applied(self.curvature))

    def applied(self, curvature: Array) -> Array:
        """(N, N) a curvature after its frames, brought before them."""
        return self.matrix.T @ curvature @ self.matrix + self.curvature


class _Joined:
    """Transitions over the frames of a window, in two parts: up to a boundary, and after it."""

    def __init__(self) -> None:
        self._to_boundary: list[CurvatureTransition] = []
        """From each frame before the boundary, the first frame's last."""
        self._single: list[CurvatureTransition] = []
        self._beyond: CurvatureTransition | None = None

    def append(self, one: CurvatureTransition) -> None:
        self._single.append(one)
        self._beyond = one if self._beyond is None else one.after(self._beyond)

    def drop(self) -> None:
        if self._to_boundary:
            self._to_boundary.pop()
            return
        total: CurvatureTransition | None = None
        for one in self._single[:0:-1]:
            total = one if total is None else total.after(one)
            self._to_boundary.append(total)
        self._single, self._beyond = [], None

    @property
    def curvature(self) -> Array | None:
        first = self._to_boundary[-1] if self._to_boundary else None
        if first is None or self._beyond is None:
            only = first or self._beyond
            return None if only is None else only.curvature
        return first.applied(self._beyond.curvature)


class LaterFrames:
    """The frames that follow one frame, a window that moves on as they come."""

    def __init__(self, covariances: bool = True) -> None:
        """Args: True to carry covariances, too; they cost several times as much."""
        self._steps: deque[LinearStep] = deque()
        self._joined = _Joined() if covariances else None

    def append(self, step: LinearStep) -> None:
        """A frame more at the end."""
        self._steps.append(step)
        if self._joined is not None:
            self._joined.append(CurvatureTransition.over(step))

    def drop(self) -> None:
        """The first frame leaves."""
        self._steps.popleft()
        if self._joined is not None:
            self._joined.drop()

    def backward(self) -> BackwardPass | None:
        """The pass over all its frames, at the frame before them; None where there are no frames."""
        if not self._steps:
            return None
        back = BackwardPass(len(self._steps[0].vector), covariances=False)
        for step in reversed(self._steps):
            back.through_readings(step.P, step.information, step.vector)
            back.through_plant(step.transition)
        if self._joined is not None:
            back.curvature = self._joined.curvature
        return back
