"""What later readings tell, carried back over several frames at once: the backward pass of a moving window.

The backward pass (:mod:`mbkf.numerics.smoothing`) over a frame is affine in gradient g and curvature L of what later
readings tell. With P the frame's posterior covariance, Λ and λ its readings, Φ the transition into it, E = Φ − P Λ Φ:

    g ← Eᵀ (g − λ),    L ← Eᵀ L E + Eᵀ Λ Φ

so passages over neighbouring frames join into one, in any grouping (Särkkä 2021). A window that gains a frame at its
end and loses one at its beginning is therefore kept joined with few products per frame, however long it is
(Tangwongsan 2015): sums from each of its older frames to a boundary, and one sum of the frames after the boundary.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.smoothing import BackwardPass


class Passage(NamedTuple):
    """From after the readings of a frame to after those of an earlier one: g ← Eᵀ g + h, L ← Eᵀ L E + M.

    Attributes:
        matrix: (N, N) E.
        gradient: (N,) h.
        curvature: (N, N) M.
    """

    matrix: Array
    gradient: Array
    curvature: Array

    @classmethod
    def over(cls, P: Array, information: Array, vector: Array, transition: Array) -> Passage:
        """Over one frame.

        Args:
            P: (N, N) its posterior covariance.
            information: (N, N) Λ = HᵀR⁻¹H of its readings.
            vector: (N,) λ = HᵀR⁻¹y with the innovation y of its prior.
            transition: (N, N) Φ into the frame.
        """
        told = information @ transition
        matrix = transition - P @ told
        return cls(matrix, -(vector @ matrix), matrix.T @ told)

    @classmethod
    def nothing(cls, size: int) -> Passage:
        """Over a frame that changes nothing: no motion and no readings."""
        return cls(np.eye(size), np.zeros(size), np.zeros((size, size)))

    def after(self, earlier: Passage) -> Passage:
        """This one and then, further back, an earlier one."""
        gradient, curvature = self.told(earlier)
        return Passage(self.matrix @ earlier.matrix, gradient, curvature)

    def told(self, earlier: Passage | None) -> tuple[Array, Array]:
        """(N,) gradient and (N, N) curvature after this one and an earlier one, where nothing comes later."""
        if earlier is None:
            return self.gradient, self.curvature
        back = earlier.matrix.T
        return (
            back @ self.gradient + earlier.gradient,
            back @ self.curvature @ earlier.matrix + earlier.curvature,
        )


class PassageWindow:
    """Passages over the frames that follow one frame, joined; the frame moves on as they come."""

    def __init__(self) -> None:
        self._sums: list[Passage] = []
        """From each frame before the boundary to the boundary; the first frame's last."""
        self._beyond: list[Passage] = []
        """Over the single frames after the boundary."""
        self._beyond_sum: Passage | None = None

    def __len__(self) -> int:
        return len(self._sums) + len(self._beyond)

    def append(self, passage: Passage) -> None:
        """A frame more at the end."""
        self._beyond.append(passage)
        total = self._beyond_sum
        self._beyond_sum = passage if total is None else passage.after(total)

    def drop(self) -> None:
        """The first frame leaves."""
        if not self._sums:
            total: Passage | None = None
            for passage in self._beyond[:0:-1]:
                total = passage if total is None else total.after(passage)
                self._sums.append(total)
            self._beyond, self._beyond_sum = [], None
            return
        self._sums.pop()

    def told(self) -> BackwardPass | None:
        """What all its frames tell of the frame before them; None where there is none."""
        first = self._sums[-1] if self._sums else None
        last = self._beyond_sum or first
        if last is None:
            return None
        back = BackwardPass(len(last.gradient))
        back.gradient, back.curvature = last.told(None if last is first else first)
        return back
