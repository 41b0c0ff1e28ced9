"""Backward pass of a Kalman smoother after Bryson and Frazier: no covariance is inverted, singular ones are welcome.

With λ and L the gradient and curvature that later readings add (zero at the end), a smoothed estimate is
x⁺ − P⁺ λ with covariance P⁺ − P⁺ L P⁺ (Bierman 1973, "Fixed interval smoothing with discrete measurements").
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.transition import Transition


class BackwardPass:
    """Carries the information of later readings from frame to frame, towards the beginning.

    Attributes:
        gradient: (N,) λ after the frame it now stands at.
        curvature: (N, N) L, or None when covariances are not wanted.
    """

    def __init__(self, size: int, covariances: bool = True) -> None:
        self.gradient = np.zeros(size)
        self.curvature: Array | None = np.zeros((size, size)) if covariances else None

    def step(self, P: Array) -> Array:
        """(N,) correction of a frame's posterior mean by later readings, for its posterior covariance P (N, N)."""
        return -(P @ self.gradient)

    def covariance(self, P: Array) -> Array:
        """(N, N) smoothed covariance of a frame with posterior covariance P.

        Raises:
            ValueError: The pass carries no covariances.
        """
        if self.curvature is None:
            raise ValueError("this pass carries no covariances")
        smoothed = P - P @ self.curvature @ P
        return 0.5 * (smoothed + smoothed.T)

    def corrected(self, P: Array) -> tuple[Array, Array]:
        """Both of a frame; without curvature its own covariance, which is never smaller than the smoothed one."""
        return self.step(P), P if self.curvature is None else self.covariance(P)

    def through_readings(self, P: Array, information: Array, vector: Array) -> None:
        """From after a frame's readings to before them.

        Args:
            P: (N, N) posterior covariance.
            information: (N, N) Λ = HᵀR⁻¹H of the frame's readings.
            vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
        """
        kept = self.gradient - vector
        self.gradient = kept - information @ (P @ kept)
        if self.curvature is not None:
            C = -(P @ information)
            C.reshape(-1)[:: len(C) + 1] += 1.0
            curvature = C.T @ (self.curvature @ C + information)
            self.curvature = 0.5 * (curvature + curvature.T)

    def through_frame(
        self, P: Array, matrix: Array, rows: Array, vector: Array, transition: Transition
    ) -> Array:
        """From after a frame's readings to after those of the frame before it; returns :meth:`step` of the frame.

        Args:
            P: (N, N) posterior covariance.
            matrix: (n, n) information on the first n components.
            rows: (m, N) whitened Jacobian of the other readings: Λ is ``matrix`` on the first n, and rowsᵀ rows.
            vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
            transition: Φ of the step into the frame.
        """
        step, information = self.step(P), rows.T @ rows
        information[: len(matrix), : len(matrix)] += matrix
        self.through_readings(P, information, vector)
        self.through_plant(transition.matrix(len(self.gradient)))
        return step

    def through_plant(self, transition: Array) -> None:
        """From before a frame's readings to after those of the frame before it; ``transition`` is Φ (N, N)."""
        self.gradient = self.gradient @ transition
        if self.curvature is not None:
            self.curvature = transition.T @ self.curvature @ transition
