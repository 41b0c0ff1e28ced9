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
        positions_m: (M, 3) predicted positions ĥ(x⁻) in the world, m.
        read: Works out the reading with its Jacobian H.
        predict_covariance: Works out the (nv, nv) covariance P⁻ of the predicted configuration. Many frames need
            neither.
    """

    positions_m: Array
    read: Callable[[], MarkerReading]
    predict_covariance: Callable[[], Array]

    @cached_property
    def reading(self) -> MarkerReading:
        """The reading at the predicted state."""
        return self.read()

    @cached_property
    def covariance(self) -> Array:
        """(nv, nv) covariance P⁻ of the predicted configuration in its tangent space."""
        return self.predict_covariance()

    def spread(self, markers: BoolArray) -> Array:
        """(m, 3, 3) covariance H P⁻ Hᵀ of the chosen markers' (M,) predicted positions, m²."""
        H = self.reading.only(markers).jacobian
        return (H @ self.covariance) @ H.transpose(0, 2, 1)
