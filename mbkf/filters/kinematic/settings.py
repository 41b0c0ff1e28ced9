"""Settings of the kinematic filter: one default set for every capture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array


@dataclass(frozen=True)
class KinematicSettings:
    """Noise of the kinematic filter and its gate for outlying markers.

    Attributes:
        acceleration_scale: Factor on the body's table of typical accelerations (σ_a per dof).
        marker_noise_scale: Factor on the markers' own noise.
        marker_noise_m: One noise for all markers in place of their own, m, as in the thesis; None: their own.
        gate: Squared Mahalanobis distance (3 readings) above which a marker is refused.
        gate_radius_m: Distance below which no marker is refused, m.
        posture_scale: The posture prior's spread is the body's table times this, per reading; times 0.35 for joints
            beside a segment without markers (:mod:`mbkf.sensors.holes`).
        velocity_sd: Spread of a velocity about rest, rad/s or m/s, per reading; holds back the joints of segments
            none of whose markers is seen.
        restart_rms_m: A pose fit better than this is accepted to start or restart the filter, m.
        restart_after_s: Time without enough markers inside their gates after which the filter starts anew.
        min_markers: Fewer markers than this in a frame leave the body untracked.
    """

    acceleration_scale: float = 1.0
    marker_noise_scale: float = 1.0
    marker_noise_m: float | None = field(default=None, metadata={"absent": "own"})
    gate: float = 60.0
    gate_radius_m: float = 0.03
    posture_scale: float = 10.0
    velocity_sd: float = 20.0
    restart_rms_m: float = 0.05
    restart_after_s: float = 0.2
    min_markers: int = 6

    def noise(self, own_m: Array) -> Array:
        """(M,) noise of the markers before the factor on it, m.

        Args:
            own_m: (M,) their own.
        """
        return own_m if self.marker_noise_m is None else np.full_like(own_m, self.marker_noise_m)
