"""Predicted markers of the next frame with their covariance (thesis eq. 4.5)."""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.marker_sensor import MarkerReading


@dataclass(frozen=True)
class MarkerPrediction:
    """Markers predicted from a state.

    Attributes:
        reading: The markers at the predicted configuration; its Jacobian H is computed on demand.
        covariance: (nv, nv) covariance P⁻ of the predicted configuration in its tangent space.
    """

    reading: MarkerReading
    covariance: Array

    @property
    def positions_m(self) -> Array:
        """(M, 3) predicted positions ĥ(x⁻) in the world, m."""
        return self.reading.positions_m

    def spread(self, markers: BoolArray) -> Array:
        """(m, 3, 3) covariance H P⁻ Hᵀ of the chosen markers' (M,) predicted positions, m²."""
        H = self.reading.only(markers).jacobian
        return (H @ self.covariance) @ H.transpose(0, 2, 1)
