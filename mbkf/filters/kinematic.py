"""The kinematic filter: markers through a white-acceleration plant (SPEC §5), one pure step per frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.dwna import WhiteAccelerationPlant
from mbkf.filters.estimate import Foresight
from mbkf.filters.gate import Sight, judged
from mbkf.filters.settings import KinematicSettings
from mbkf.filters.state import FilterState
from mbkf.numerics.kalman import Information, correct, informed, read_directly
from mbkf.sensors.expectation import MarkerExpectation
from mbkf.sensors.markers import MarkerInformation, MarkerSensor
from mbkf.sensors.pose_fit import PoseFit, fit_most_markers, segment_by_segment
from mbkf.sensors.posture import PostureSensor, pull

START_SPEED_SD_M_S = 2.0
START_SPEED_SD_RAD_S = 5.0
"""How fast a body may move when the filter starts knowing only its pose."""


@dataclass(frozen=True)
class Evidence:
    """What a step went through, kept for what only a report needs.

    Attributes:
        before, predicted: State of the frame before, and what the plant made of it.
        plant: The plant.
        markers: Information of the believed markers on the configuration.
        position_matrix: (nv, nv) all information on the configuration.
        velocity_matrix: (nv,) diagonal of that on velocities; 0 but for dofs of segments out of sight.
        vector: (2 nv,) Hᵀ R⁻¹ y of all of it.
    """

    before: FilterState
    predicted: FilterState
    plant: WhiteAccelerationPlant
    markers: Information
    position_matrix: Array
    velocity_matrix: Array
    vector: Array


@dataclass(frozen=True)
class StepResult:
    """One step of the filter.

    Attributes:
        state: Posterior.
        refused: (M,) markers seen but not believed.
        readings: How many coordinates of markers were believed.
        tracked: Whether enough markers were believed, and the state was not far from most of them.
        evidence: What ``nis`` and ``velocity_step_covariance`` are worked out from when asked for.
    """

    state: FilterState
    refused: BoolArray
    readings: int
    tracked: bool
    evidence: Evidence

    @cached_property
    def nis(self) -> float:
        """Normalised innovation squared of the believed markers."""
        nv = len(self.state.v)
        return correct(self.evidence.predicted.P[:nv, :nv], self.evidence.markers).nis

    @cached_property
    def velocity_step_covariance(self) -> Array:
        """(nv, nv) covariance of v_k − v_{k−1}, for accelerations by eq. 3.7.

        P_k + P_{k−1} − C − Cᵀ, velocities' blocks, with C = (I − K H) Φ P_{k−1} and K H = P_k Λ. Since velocities are
        predicted to stay, the columns of Φ P_{k−1} for velocities are those of the prediction without its noise.
        """
        nv, P, known = len(self.state.v), self.state.P, self.evidence
        carried = known.predicted.P[:, nv:].copy()
        np.einsum("ii->i", carried[:nv])[:] -= known.plant.cross_noise
        np.einsum("ii->i", carried[nv:])[:] -= known.plant.velocity_noise
        learnt = P[nv:, :nv] @ (known.position_matrix @ carried[:nv])
        learnt += P[nv:, nv:] @ (known.velocity_matrix[:, None] * carried[nv:])
        cross = carried[nv:] - learnt
        return P[nv:, nv:] + known.before.P[nv:, nv:] - cross - cross.T


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
        self._markers = MarkerInformation(sensor, self.noise_m)
        self._lean = self.posture.weights(settings.posture_scale, held)
        self._sight = Sight(sensor, held)

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
        fits = [fit_most_markers(self.sensor, self.posture, measured_m, self.noise_m, q) for q in guesses]
        best = min(fits, key=lambda one: one.rms_m)
        return best if best.rms_m <= self.settings.restart_rms_m else None

    def expect(self, state: FilterState) -> Foresight:
        """The prediction alone."""
        predicted, nv = self.plant.predict(state), self.sensor.model.nv
        reading = self.sensor.reading(predicted.q)
        return Foresight(predicted.q, MarkerExpectation(reading, predicted.P[:nv, :nv]), predicted)

    def step(self, state: FilterState, measured_m: Array, foresight: Foresight | None = None) -> StepResult:
        """Prediction and correction by one frame of markers (M, 3), NaN where missing."""
        q, expected, predicted = foresight or self.expect(state)
        reading, v, nv = expected.reading, predicted.v, self.sensor.model.nv
        innovation = measured_m - reading.positions_m
        seen, trusted, _, strayed = judged(
            innovation, reading, predicted.P[:nv, :nv], self.noise_m, self.settings
        )
        markers = self._markers.at(q, reading, innovation, trusted)
        lean = pull(*self.posture.deviation(q), self._lean)
        matrix, vector, rest = markers.matrix + lean.matrix, np.zeros(2 * nv), np.zeros(nv)
        vector[:nv] = markers.vector + lean.vector
        P, unseen = predicted.P, self._sight.unseen(trusted)
        if len(unseen):
            certainty = np.full(len(unseen), 1.0 / self.settings.velocity_sd)
            P = read_directly(P, nv + unseen, certainty)
            rest[unseen] = certainty**2
            vector[nv:] = -rest * v
        P = informed(P, matrix)
        step = P @ vector
        posterior = FilterState(self.sensor.model.integrate(q, step[:nv]), v + step[nv:], P)
        tracked = markers.readings >= 3 * self.settings.min_markers and not strayed
        evidence = Evidence(state, predicted, self.plant, markers, matrix, rest, vector)
        return StepResult(posterior, seen & ~trusted, markers.readings, tracked, evidence)
