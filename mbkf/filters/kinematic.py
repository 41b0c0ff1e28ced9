"""The kinematic filter: markers through a white-acceleration plant (SPEC §5), one pure step per frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.dwna import WhiteAccelerationPlant
from mbkf.filters.gate import believable
from mbkf.filters.settings import KinematicSettings
from mbkf.filters.state import FilterState
from mbkf.numerics.kalman import Information, correct, information
from mbkf.sensors.markers import MarkerSensor
from mbkf.sensors.pose_fit import PoseFit, fit_pose, segment_by_segment
from mbkf.sensors.posture import PostureSensor

START_SPEED_SD_M_S = 2.0
START_SPEED_SD_RAD_S = 5.0
"""How fast a body may move when the filter starts knowing only its pose."""


@dataclass(frozen=True)
class StepResult:
    """One step of the filter.

    Attributes:
        state: Posterior.
        refused: (M,) markers seen but not believed.
        nis: Normalised innovation squared of the believed markers.
        readings: How many coordinates those are.
        tracked: Whether enough markers were believed.
        velocity_step_covariance: (nv, nv) covariance of v_k − v_{k−1}, for accelerations by eq. 3.7.
    """

    state: FilterState
    refused: BoolArray
    nis: float
    readings: int
    tracked: bool
    velocity_step_covariance: Array


class KinematicFilter:
    """Extended Kalman filter of a body followed by markers.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) marker noise.
        plant: The white-acceleration plant.
        held: (nv,) dofs that no marker of the capture moves with; they keep the neutral posture.
        settings: What it believes.
    """

    def __init__(
        self, sensor: MarkerSensor, noise_m: Array, dt_s: float, held: BoolArray, settings: KinematicSettings
    ) -> None:
        self.sensor, self.settings, self.held = sensor, settings, held
        self.noise_m = noise_m * settings.marker_noise_scale
        model = sensor.model
        self.posture = PostureSensor(model)
        acceleration = np.where(held, 0.0, settings.acceleration_scale * model.acceleration_sd)
        self.plant = WhiteAccelerationPlant(model, dt_s, acceleration)
        self._free = np.flatnonzero(~held[self.posture.dofs])
        self._rest = model.nv + np.flatnonzero(~held)

    def start(self, measured_m: Array, guess: Array | None = None) -> FilterState | None:
        """A state at rest from one frame of markers (M, 3), or None where they do not fit the body.

        Args:
            measured_m: Positions, NaN where missing.
            guess: (nq,) configuration to start the fit from besides the segment-by-segment one.
        """
        fit = self._fit(measured_m, guess)
        if fit is None:
            return None
        nv = self.sensor.model.nv
        speed = np.where(np.arange(nv) < 3, START_SPEED_SD_M_S, START_SPEED_SD_RAD_S)
        P = np.zeros((2 * nv, 2 * nv))
        P[:nv, :nv] = fit.covariance
        P[nv:, nv:] = np.diag(np.where(self.held, 1e-6, speed) ** 2)
        return FilterState(fit.q, np.zeros(nv), P)

    def _fit(self, measured_m: Array, guess: Array | None) -> PoseFit | None:
        if (~np.isnan(measured_m).any(axis=1)).sum() < self.settings.min_markers:
            return None
        guesses = [segment_by_segment(self.sensor, measured_m)] + ([] if guess is None else [guess])
        fits = [fit_pose(self.sensor, self.posture, measured_m, self.noise_m, q) for q in guesses]
        best = min(fits, key=lambda one: one.rms_m)
        return best if best.rms_m <= self.settings.restart_rms_m else None

    def step(self, state: FilterState, measured_m: Array) -> StepResult:
        """Prediction and correction by one frame of markers (M, 3), NaN where missing."""
        phi = self.plant.transition(state)
        predicted = self.plant.predict(state, phi)
        reading = self.sensor.reading(predicted.q)
        nv = self.sensor.model.nv
        innovation = measured_m - reading.positions_m
        seen = np.asarray(~np.isnan(innovation).any(axis=1))
        trusted = believable(innovation, reading.jacobian, predicted.P[:nv, :nv], self.noise_m, self.settings)
        tracked = bool(trusted.sum() >= self.settings.min_markers)
        markers = self._marker_information(innovation, reading.jacobian, trusted)
        total = _on_state(markers, nv) + self._rest_information(predicted)
        correction = correct(predicted.P, total)
        q = self.sensor.model.integrate(predicted.q, correction.step[:nv])
        posterior = FilterState(q, predicted.v + correction.step[nv:], correction.covariance)
        nis = correct(predicted.P[:nv, :nv], markers).nis
        return StepResult(
            posterior,
            seen & ~trusted,
            nis,
            markers.readings,
            tracked,
            self._velocity_step(state, posterior, phi, correction.gain_effect),
        )

    def _marker_information(self, innovation: Array, jacobian: Array, trusted: BoolArray) -> Information:
        sd = np.repeat(self.noise_m[trusted], 3)
        return information(
            innovation[trusted].ravel(), jacobian[trusted].reshape(len(sd), jacobian.shape[2]), sd
        )

    def _rest_information(self, state: FilterState) -> Information:
        """The weak pulls towards neutral posture and rest."""
        nv = self.sensor.model.nv
        prior = self.posture.reading(state.q)
        sd = self.settings.posture_scale * self.posture.sd[self._free]
        pull = information(-prior.deviation[self._free], prior.jacobian[self._free], sd)
        matrix = np.zeros((2 * nv, 2 * nv))
        vector = np.zeros(2 * nv)
        matrix[:nv, :nv], vector[:nv] = pull.matrix, pull.vector
        matrix[self._rest, self._rest] = self.settings.velocity_sd**-2
        vector[self._rest] = -state.v[self._rest - nv] * self.settings.velocity_sd**-2
        return Information(matrix, vector, 0.0, 0)

    def _velocity_step(
        self, before: FilterState, after: FilterState, phi: Array, gain_effect: Array
    ) -> Array:
        """Cov(v_k − v_{k−1}) = P_k + P_{k−1} − C − Cᵀ with C = (I − K H) Φ P_{k−1}."""
        nv = self.sensor.model.nv
        carried = phi @ before.P[:, nv:]
        cross = carried[nv:] - gain_effect[nv:] @ carried
        return after.P[nv:, nv:] + before.P[nv:, nv:] - cross - cross.T


def _on_state(positions: Information, nv: int) -> Information:
    """Information on positions only, as information on (q, v)."""
    matrix, vector = np.zeros((2 * nv, 2 * nv)), np.zeros(2 * nv)
    matrix[:nv, :nv], vector[:nv] = positions.matrix, positions.vector
    return Information(matrix, vector, positions.innovation, positions.readings)
