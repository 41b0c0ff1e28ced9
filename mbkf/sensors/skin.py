"""Sliding skin: lasting marker errors (Gauss–Markov).

Each marker carries an artefact state s' = ρ s + noise of standard deviation σ. With y = h(q) + s, the state before is
known given q, so it is eliminated (Bryson & Henrikson 1968): y_k − ρ y_{k−1} reads h(q_k) − ρ h(q_{k−1}) with white
noise σ √(1 − ρ²), and the estimate of s is the marker's residual. q_{k−1} = q ⊖ (v Δt − a Δt²/2).
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.kalman import Information, information
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerReading, MarkerSensor


class SkinMarkers:
    """Information of markers on sliding skin.

    Attributes:
        sensor: The markers on the body.
        rho: Share of an artefact that remains after a frame.
        dt_s: Time between frames.
    """

    def __init__(
        self, sensor: MarkerSensor, noise_m: Array, camera_m: float, decay_s: float, dt_s: float
    ) -> None:
        """Makes the information of a marker set.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) standard deviation of the skin's artefacts.
            camera_m: Standard deviation of the cameras' white noise.
            decay_s: Correlation time of an artefact.
            dt_s: Time between frames.
        """
        self.sensor, self.dt_s = sensor, dt_s
        self.rho = float(np.exp(-dt_s / decay_s))
        new = np.sqrt(noise_m**2 + camera_m**2)
        self._known_sd = np.sqrt(noise_m**2 * (1.0 - self.rho**2) + camera_m**2 * (1.0 + self.rho**2))
        self._new = MarkerInformation(sensor, new)

    def at(
        self,
        q: Array,
        v: Array,
        a: Array,
        reading: MarkerReading,
        innovation_m: Array,
        trusted: BoolArray,
        before_m: Array,
    ) -> Information:
        """Information on (q, v, a) (3 nv).

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            reading: The sensor's at q.
            innovation_m: (M, 3) measured minus predicted, NaN where missing.
            trusted: (M,) markers that count, all of them seen.
            before_m: (M, 3) positions measured in the frame before; NaN without a credible one.
        """
        dt, rho, nv = self.dt_s, self.rho, len(v)
        known = trusted & ~np.isnan(before_m).any(axis=1)
        model, back = self.sensor.model, a * (0.5 * dt * dt) - v * dt
        then = self.sensor.reading(model.integrate(q, back))
        y = (innovation_m - rho * (before_m - then.positions_m))[known].ravel()
        A, B = model.integration_derivatives(q, back)
        H, turned = reading.jacobian[known].reshape(-1, nv), rho * then.jacobian[known].reshape(-1, nv)
        moved = turned @ B
        J = np.hstack([H - turned @ A, dt * moved, (-0.5 * dt * dt) * moved])
        seen_before = information(y, J, np.repeat(self._known_sd[known], 3))
        first_seen = self._new.at(reading, innovation_m, trusted & ~known)
        matrix, vector = seen_before.matrix, seen_before.vector
        matrix[:nv, :nv] += first_seen.matrix
        vector[:nv] += first_seen.vector
        return Information(
            matrix,
            vector,
            seen_before.innovation + first_seen.innovation,
            seen_before.readings + first_seen.readings,
        )
