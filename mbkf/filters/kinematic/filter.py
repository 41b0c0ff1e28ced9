"""The kinematic filter: markers through a white-acceleration plant; torques follow afterwards by inverse dynamics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.filter import Decisions, Filter, Memory, Prior, Step
from mbkf.filters.kinematic.one_call import OneCall
from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.readings import Readings
from mbkf.sensors.block import NO_DOFS, AnyBlock, Frame, Notes, OperatingPoint
from mbkf.sensors.holes import beside_holes, posture_scales
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import MarkerDecision, Markers, MarkerSettings
from mbkf.sensors.pose_fit import PoseFit, fit_most_markers, segment_by_segment
from mbkf.sensors.posture import PosturePrior, PostureSettings
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.unobserved import UnobservedJoints

_COMMON, _NO_VALUES = 3, np.zeros(0)
"""Number of blocks of a body without holes among its segments' markers; values of rows where there are not any."""

START_SPEED_SD_M_S = 2.0
START_SPEED_SD_RAD_S = 5.0
"""Spread of the velocity at a start that knows only the pose."""


def kinematic_blocks(
    sensor: MarkerSensor, noise_m: Array, dt_s: float, unobservable: BoolArray, settings: KinematicSettings
) -> list[AnyBlock]:
    """The standard blocks: markers, damping of joints that nothing observes, posture prior, limits.

    Joints beside a segment without markers are known by their usual posture and their limits, too: a straight knee
    under an unmarked thigh bends backwards as well as forwards.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        dt_s: Time between frames.
        unobservable: (nv,) dofs that no marker of the capture moves with.
        settings: Settings of every block.
    """
    s, model = settings, sensor.model
    markers = MarkerSettings(
        marker_noise_scale=s.marker_noise_scale,
        innovation_share=0.0,
        gate=s.gate,
        gate_radius_m=s.gate_radius_m,
        min_markers=s.min_markers,
    )
    holes = beside_holes(sensor, unobservable)
    posture = PostureSensor(model)
    return [
        Markers(sensor, s.noise(noise_m), dt_s, unobservable, markers, inflate=False),
        UnobservedJoints(np.full(model.nv, s.velocity_sd)),
        PosturePrior(
            posture,
            unobservable,
            PostureSettings(s.posture_scale),
            posture_scales(sensor, unobservable, s.posture_scale) / s.posture_scale,
        ),
        *([JointLimits(posture, ~holes)] if holes.any() else []),
    ]


class KinematicFilter(Filter[KinematicState]):
    """A :class:`mbkf.filters.filter.Filter` on positions and velocities.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        unobservable: (nv,) dofs that no marker of the capture moves with; they keep the neutral posture.
        settings: Settings of plant and blocks.
        model: The body.
        posture: Deviation from the neutral posture.
    """

    plant: WhiteAccelerationPlant

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        dt_s: float,
        unobservable: BoolArray,
        settings: KinematicSettings,
    ) -> None:
        """Makes the filter with its standard blocks.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) their noise, m.
            dt_s: Time between frames.
            unobservable: (nv,) dofs that no marker of the capture moves with.
            settings: Settings of plant and blocks.
        """
        model = sensor.model
        acceleration = np.where(unobservable, 0.0, settings.acceleration_scale * model.acceleration_sd)
        super().__init__(
            WhiteAccelerationPlant(model, dt_s, acceleration),
            kinematic_blocks(sensor, noise_m, dt_s, unobservable, settings),
        )
        self.sensor, self.settings, self.unobservable = sensor, settings, unobservable
        self.noise_m, self.model = settings.noise(noise_m) * settings.marker_noise_scale, model
        self.posture = PostureSensor(model)
        self._no_rows, self._one_call = np.zeros((0, self.layout.size)), None
        markers, posture = self.blocks[0], self.blocks[-1]
        common = len(self.blocks) == _COMMON
        if common and isinstance(markers, Markers) and isinstance(posture, PosturePrior):
            self._one_call = OneCall.where_possible(self.plant, markers, posture)

    def step(
        self,
        state: KinematicState,
        memory: Memory,
        frame: Frame,
        prior: Prior[KinematicState] | None = None,
    ) -> Step[KinematicState]:
        """As :meth:`Filter.step`, by one call of the kernel where nothing is to be decided."""
        if prior is not None or self._one_call is None:
            return super().step(state, memory, frame, prior)
        noise, found = self.plant.noise(None), self._one_call(state, frame.markers_m)
        if isinstance(found, KinematicState):
            return self.correct(self.prepared(found, noise, memory), memory, frame)
        notes = Notes(seen=found.seen, trusted=found.seen, observed=True, squared_m2=found.squared_m2)
        markers = MarkerDecision(
            frame.markers_m, found.innovation_m, found.squared_m2, found.seen, 1.0, NO_DOFS, None
        )
        readings = Readings(
            found.markers, found.matrix, found.vector, self._no_rows, _NO_VALUES, ((),) * _COMMON
        )
        statements = found.markers, None, None
        decisions = Decisions(noise, [markers, notes, notes], notes)
        prior = Prior(found.prior, noise, (OperatingPoint(found.prior, None),) * _COMMON)
        return self._step(found.posterior, prior, decisions, readings, statements, memory)

    def start(self, measured_m: Array, guess: Array | None = None) -> KinematicState | None:
        """A state at rest from one frame of markers (M, 3), or None where they do not fit the body.

        Args:
            measured_m: Positions, NaN where missing.
            guess: (nq,) configuration to start the fit from besides the segment-by-segment one.
        """
        fit = self._fit(measured_m, guess)
        if fit is None:
            return None
        nv, q, v = self.model.nv, self.layout.q, self.layout.v
        speed = np.where(np.arange(nv) < 3, START_SPEED_SD_M_S, START_SPEED_SD_RAD_S)
        P = np.zeros((self.layout.size, self.layout.size))
        P[q, q] = fit.covariance
        P[v, v] = np.diag(np.where(self.unobservable, 1e-6, speed) ** 2)
        return KinematicState(fit.q, np.zeros(nv), P)

    def _fit(self, measured_m: Array, guess: Array | None) -> PoseFit | None:
        if (~np.isnan(measured_m).any(axis=1)).sum() < self.settings.min_markers:
            return None
        guesses = [segment_by_segment(self.sensor, measured_m)] + ([] if guess is None else [guess])
        fits = [fit_most_markers(self.sensor, self.posture, measured_m, self.noise_m, q) for q in guesses]
        best = min(fits, key=lambda one: one.rms_m)
        return best if best.rms_m <= self.settings.restart_rms_m else None


@dataclass(frozen=True)
class VelocityStep:
    """Covariance of v_k − v_{k−1}, for accelerations by differences.

    P_k + P_{k−1} − C − Cᵀ, velocities' blocks, with C = (I − K H) Φ P_{k−1} and K H = P_k Λ. Since velocities are
    predicted to stay, the columns of Φ P_{k−1} for velocities are those of the prediction without its noise.

    Attributes:
        before: Posterior of the frame before.
        step: The step from it.
        plant: The plant.
    """

    before: KinematicState
    step: Step[KinematicState]
    plant: WhiteAccelerationPlant

    @property
    def covariance(self) -> Array:
        """(nv, nv)."""
        P, nv, readings = self.step.state.P, len(self.step.state.v), self.step.readings
        carried = self.step.prior.state.P[:, nv:].copy()
        np.einsum("ii->i", carried[:nv])[:] -= self.plant.cross_noise
        np.einsum("ii->i", carried[nv:])[:] -= self.plant.velocity_noise
        learnt = P[nv:, :nv] @ (readings.matrix @ carried[:nv])
        if len(readings.values):
            rows = readings.rows[:, nv:]
            learnt += P[nv:, nv:] @ (rows.T @ (rows @ carried[nv:]))
        cross = carried[nv:] - learnt
        return P[nv:, nv:] + self.before.P[nv:, nv:] - cross - cross.T
