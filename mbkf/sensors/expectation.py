"""Where a filter expects the markers of the next frame, and how surely (eq. 4.5 with its covariance)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.markers import MarkerReading


@dataclass(frozen=True)
class MarkerExpectation:
    """Markers predicted from a state.

    Attributes:
        reading: Predicted positions ĥ(x⁻) and, when asked for, their Jacobian H.
        predict_covariance: Works out the (nv, nv) covariance P⁻ of the predicted configuration, which many frames do
            not need.
    """

    reading: MarkerReading
    predict_covariance: Callable[[], Array]

    @property
    def positions_m(self) -> Array:
        """(M, 3) predicted positions in the world, m."""
        return self.reading.positions_m

    @cached_property
    def covariance(self) -> Array:
        """(nv, nv) covariance P⁻ of the predicted configuration in its tangent space."""
        return self.predict_covariance()

    def spread(self, markers: BoolArray) -> Array:
        """(m, 3, 3) covariance H P⁻ Hᵀ of the chosen markers' (M,) predicted positions, m²."""
        H = self.reading.only(markers).jacobian
        return (H @ self.covariance) @ H.transpose(0, 2, 1)
