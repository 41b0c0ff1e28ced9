"""The thesis's dynamic filter: markers and plates through forward dynamics, one pure step per frame (SPEC §6).

State: positions, velocities, pelvis residual, joint torques and foot wrenches, 166 for the reference body; in which
coordinates of the forces, :data:`mbkf.model.human_dynamics.FORCE_STATES` says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.noise import ForceNoise, condition, load_variance, residual_variance
from mbkf.filters.torque.plant import ForcedPrediction, ForcedState, TorquePlant, on_state, update
from mbkf.filters.torque.settings import MASS_OF_TABLE_KG, TorqueSettings
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.numerics.kalman import Information, correct, information
from mbkf.sensors.foot_wrench import FootWrenchSensor
from mbkf.sensors.gating import gated
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.posture import PostureSensor


@dataclass(frozen=True)
class TorqueState:
    """One instant of the filtered motion.

    Attributes:
        q: (nq,) configuration.
        v: (nv,) velocity.
        a: (nv,) acceleration by Newton's law.
        tau: (nv,) generalised forces; the first six are the pelvis residual in pelvis axes.
        foot_wrench: (2, 6) force N and moment N m about the world's origin, world axes, on right and left foot.
        tau_sd: (nv,) standard deviations of ``tau``; NaN for dofs whose torque is no state.
        foot_wrench_sd: (2, 6) standard deviations of ``foot_wrench``.
        filtered: The filter's own mean and covariance (n, n).
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    foot_wrench: Array
    tau_sd: Array
    foot_wrench_sd: Array
    filtered: ForcedState


@dataclass(frozen=True)
class TorqueStep:
    """One step of the filter.

    Attributes:
        state: Posterior.
        prediction: Prior and transition, for a backward smoother.
        refused: (M,) markers seen but not believed.
        nis: Normalised innovation squared of believed markers and plates.
        readings: How many numbers those are.
        tracked: Whether enough markers were believed.
        evidence: All information that corrected the prior, for a backward smoother; None where nothing did.
    """

    state: TorqueState
    prediction: ForcedPrediction
    refused: BoolArray
    nis: float
    readings: int
    tracked: bool
    evidence: Information | None


@dataclass(frozen=True)
class FootReading:
    """What is known of the ground's reactions in a frame.

    Attributes:
        wrench: (2, 6) force N and moment N m about the world's origin, world axes, on right and left foot.
        measured: (2,) feet whose wrench a plate measures.
        airborne: (2,) feet that touch nothing: their wrench is 0.
    """

    wrench: Array
    measured: BoolArray
    airborne: BoolArray

    @classmethod
    def of(cls, wrench: Array, measured: BoolArray, airborne: BoolArray | None = None) -> FootReading:
        """By default a foot whose measured wrench is exactly zero is taken to be in the air."""
        if airborne is None:
            airborne = measured & (wrench == 0.0).all(axis=1)
        return cls(np.where(airborne[:, None], 0.0, wrench), measured | airborne, airborne)


class TorqueFilter:
    """Extended Kalman filter with forward dynamics as its plant.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) marker noise.
        held: (nv,) dofs that no marker of the capture moves with.
        settings: What it believes.
        body: The forced body.
        plant: Its discretised dynamics.
    """

    def __init__(
        self, sensor: MarkerSensor, noise_m: Array, dt_s: float, held: BoolArray, settings: TorqueSettings
    ) -> None:
        self.sensor, self.held, self.settings = sensor, held, settings
        self.noise_m = noise_m * settings.tracking.marker_noise_scale
        self.body = HumanDynamics(sensor.model, held, settings.wrench_frame, settings.force_state)
        self.plant = TorquePlant(self.body, dt_s, ForceNoise(self.body, dt_s, settings), settings.scheme)
        self.plates = FootWrenchSensor(self.body)
        self.posture = PostureSensor(sensor.model)
        spread = [settings.residual_spread_force_n, settings.residual_spread_moment_nm]
        self._scale = sensor.model.mass_kg / MASS_OF_TABLE_KG
        self._residual_sd = np.repeat(spread, 3) * self._scale
        self._rest = np.flatnonzero(~held)
        self._free = np.flatnonzero(~held[self.posture.dofs])

    # Start.

    def start(
        self,
        motion: KinematicState,
        acceleration: Array,
        foot_wrench: Array,
        measured: BoolArray,
        airborne: BoolArray | None = None,
    ) -> TorqueState:
        """A state from the kinematic filter's, its acceleration estimate (nv,) and the reactions in the frame.

        Torques follow by inverse dynamics under the reactions (eq. 3.12), and so does their covariance. With
        consistent noise, motion and reactions are first made to agree on a small residual.
        """
        feet = FootReading.of(foot_wrench, measured, airborne)
        a = np.where(self.body.kinematic, 0.0, acceleration)
        q, v = motion.q, motion.v
        u = self.body.forces(q, v, a, feet.wrench)
        if self.settings.noise == "independent":
            return self.report(ForcedState(q, v, u, self._plain_covariance(motion.P)))
        nv, torque = self.body.nv, self.body.joint_forces(q, v, u)
        linear = self.body.linearise(q, v, u)
        mass = self.body.model.mass_matrix(q)[self.body.torque_dofs]
        rows = np.zeros((self.body.nu, 3 * nv + 12))
        rows[: len(mass), : 2 * nv] = -mass @ np.hstack([linear.by_q, linear.by_v])
        rows[:, 2 * nv :] = self.body.force_rows(q)
        residual = torque.by_u[:6] @ rows
        residual[:, : 2 * nv] += np.hstack([torque.by_q, torque.by_v])[:6]
        spread = np.where(self.body.kinematic, 0.0, self.sensor.model.acceleration_sd)
        free = scipy.linalg.block_diag(motion.P, np.diag(spread**2), np.diag(self._plate_sd(feet) ** 2))
        walk = residual_variance(self.settings, self.body.model.mass_kg)
        allowed = np.where(np.isfinite(self._residual_sd), self._residual_sd**2, walk)
        bound = condition(free, residual, allowed, -torque.torque[:6])
        whole = np.vstack([np.eye(2 * nv, 3 * nv + 12), rows])
        shift = whole @ bound.shift
        prior = ForcedState(
            self.body.integrate(q, shift[:nv]),
            v + shift[nv : 2 * nv],
            u + shift[2 * nv :],
            whole @ bound.covariance @ whole.T,
        )
        return self.report(prior)

    def _plain_covariance(self, P: Array) -> Array:
        """Forces known as well as a second of their own noise leaves them."""
        own = np.diag(self.plant.density(ForcedState(np.zeros(0), np.zeros(0), np.zeros(0), P)))
        return scipy.linalg.block_diag(P, np.diag(own[2 * self.body.nv :]))

    # Step.

    def step(
        self,
        state: TorqueState,
        measured_m: Array,
        foot_wrench: Array,
        measured: BoolArray,
        airborne: BoolArray | None = None,
    ) -> TorqueStep:
        """ForcedPrediction and correction by one frame.

        A filter that has diverged until nothing can be computed keeps its state and is untracked.

        Args:
            state: Posterior of the frame before.
            measured_m: (M, 3) markers, NaN where missing.
            foot_wrench: (2, 6) about the world's origin, world axes, on right and left foot.
            measured: (2,) feet whose wrench is known; the others' stays free.
            airborne: (2,) feet that touch nothing; see :meth:`FootReading.of`.
        """
        feet = FootReading.of(foot_wrench, measured, airborne)
        try:
            found = self._step(state.filtered, measured_m, feet)
        except (np.linalg.LinAlgError, ValueError):
            found = None
        if found is not None and np.isfinite(found.state.q).all() and np.isfinite(found.state.tau).all():
            return found
        nothing = np.zeros(len(measured_m), dtype=bool)
        stay = ForcedPrediction(state.filtered, np.eye(len(state.filtered.P)))
        return TorqueStep(state, stay, nothing, np.nan, 0, tracked=False, evidence=None)

    def _step(self, state: ForcedState, measured_m: Array, feet: FootReading) -> TorqueStep:
        prediction = self.plant.predict(state)
        prior, nv = prediction.state, self.body.nv
        reading = self.sensor.reading(prior.q)
        innovation = measured_m - reading.positions_m
        P, settings = prior.P[:nv, :nv], self.settings.tracking
        seen, trusted, *_ = gated(innovation, reading, P, self.noise_m, settings.gate, settings.gate_radius_m)
        sd = np.repeat(self.noise_m[trusted], 3)
        markers = information(innovation[trusted].ravel(), reading.jacobian[trusted].reshape(-1, nv), sd)
        columns, sensed = self._sensed(prior, markers, feet)
        total = on_state(len(prior.P), columns, sensed) + self._pulls(prior)
        updated = update(self.body, prior, total)
        nis = correct(prior.P[np.ix_(columns, columns)], sensed).nis
        tracked = bool(trusted.sum() >= self.settings.tracking.min_markers)
        return TorqueStep(
            self.report(updated.state), prediction, seen & ~trusted, nis, sensed.readings, tracked, total
        )

    def _sensed(
        self, prior: ForcedState, markers: Information, feet: FootReading
    ) -> tuple[NDArray[np.int64], Information]:
        """Markers and plates as information on positions and foot wrenches, and those columns of the state."""
        nv, n = self.body.nv, len(prior.P)
        columns = np.concatenate([np.arange(nv), np.arange(n - 12, n)])
        _, ankles = self.sensor.model.placements(prior.q)
        points = ankles[self.plates.ids]
        plates = self.plates.reading(prior.q, prior.u[-12:], points)
        target = feet.wrench.copy()
        target[:, 3:] -= np.cross(points, feet.wrench[:, :3])
        read = np.repeat(feet.measured, 6)
        H = np.hstack([plates.by_q, plates.by_state])[read]
        loads = information((target.ravel() - plates.wrench)[read], H, self._plate_sd(feet)[read])
        return columns, on_state(nv + 12, np.arange(nv), markers) + loads

    def _plate_sd(self, feet: FootReading) -> Array:
        """(12,) of the reactions' readings; of a foot that nothing measures, what it may carry."""
        settings, scale = self.settings, self._scale
        read = np.repeat([settings.plate_force_n, settings.plate_moment_nm], 3) * scale
        none = np.repeat([settings.unloaded_force_n, settings.unloaded_moment_nm], 3) * scale
        unknown = np.sqrt(load_variance(settings, self.body.model.mass_kg)[:6])
        sds = [
            none if airborne else read if measured else unknown
            for airborne, measured in zip(feet.airborne, feet.measured, strict=True)
        ]
        return np.concatenate(sds)

    def _pulls(self, prior: ForcedState) -> Information:
        """Weak pulls towards neutral posture and rest, and the residual towards zero."""
        nv, n, settings = self.body.nv, len(prior.P), self.settings
        lean = self.posture.reading(prior.q)
        sd = settings.tracking.posture_scale * self.posture.sd[self._free]
        pull = information(-lean.deviation[self._free], lean.jacobian[self._free], sd)
        matrix, vector = np.zeros((n, n)), np.zeros(n)
        matrix[:nv, :nv], vector[:nv] = pull.matrix, pull.vector
        rest = nv + self._rest
        matrix[rest, rest] = settings.tracking.velocity_sd**-2
        vector[rest] = -prior.v[self._rest] * settings.tracking.velocity_sd**-2
        torque = self.body.joint_forces(prior.q, prior.v, prior.u)
        H = np.hstack([torque.by_q, torque.by_v, torque.by_u])[:6]
        zero = information(-torque.torque[:6], H, self._residual_sd)
        return Information(matrix + zero.matrix, vector + zero.vector, 0.0, 0)

    # Report.

    def report(self, state: ForcedState) -> TorqueState:
        """What a mean and covariance of (q, v, u) say of motion and forces."""
        body, nv = self.body, self.body.nv
        a = body.acceleration(state.q, state.v, state.u)
        tau = body.generalised(state.q, state.v, a, state.u)
        at_origin = self.plates.reading(state.q, state.u[-12:], np.zeros((2, 3)))
        columns = np.concatenate([np.arange(nv), np.arange(len(state.P) - 12, len(state.P))])
        H = np.hstack([at_origin.by_q, at_origin.by_state])
        spread = ((H @ state.P[np.ix_(columns, columns)]) * H).sum(axis=1)
        tau_sd = np.full(nv, np.nan)
        torque = body.joint_forces(state.q, state.v, state.u)
        T = np.hstack([torque.by_q, torque.by_v, torque.by_u])
        tau_sd[body.torque_dofs] = np.sqrt(np.maximum(((T @ state.P) * T).sum(axis=1), 0.0))
        tau_sd[self.held] = np.nan
        return TorqueState(
            state.q,
            state.v,
            a,
            tau,
            at_origin.wrench.reshape(2, 6),
            tau_sd,
            np.sqrt(np.maximum(spread, 0.0)).reshape(2, 6),
            state,
        )
