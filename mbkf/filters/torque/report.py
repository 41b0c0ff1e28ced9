"""Report of the torque-state filter: motion and forces with standard deviations from (q, v, u) and its covariance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.estimate import Posterior, Prediction, Record
from mbkf.filters.filter import Memory
from mbkf.filters.report import FirstMotion, StateReport
from mbkf.filters.spread import Spread, root
from mbkf.filters.torque.filter import TorqueFilter, TorqueStep
from mbkf.filters.torque.plant import ForcedState
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.layout import FEET
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.records import ContactDecision
from mbkf.sensors.foot_wrench import FootWrenchSensor
from mbkf.sensors.marker_sensor import MarkerPrediction, MarkerSensor


@dataclass(frozen=True)
class TorqueState:
    """One instant of the filtered motion.

    Attributes:
        q: (nq,) configuration.
        v: (nv,) velocity.
        a: (nv,) acceleration by Newton's law.
        tau: (nv,) generalised forces; the first six are the pelvis residual in pelvis axes.
        foot_wrench: (2, 6) force N and moment N m about the world's origin, world axes, on right and left foot.
        tau_sd: (nv,) standard deviations of ``tau``; NaN for dofs whose torque does not belong to the state, and for
            all while a foot of unknown wrench stands and wrenches are known inputs.
        foot_wrench_sd: (2, 6) standard deviations of ``foot_wrench``; of known inputs 0, or NaN for an unknown one.
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    foot_wrench: Array
    tau_sd: Array
    foot_wrench_sd: Array

    @property
    def finite(self) -> bool:
        """True where all of motion and torques could be computed."""
        return bool(np.isfinite(self.q).all() and np.isfinite(self.tau).all())

    @classmethod
    def of(cls, body: HumanDynamics, wrenches: FootWrenchSensor, state: ForcedState) -> TorqueState:
        """Motion, torques and wrenches of a state.

        Args:
            body: The forced body.
            wrenches: Its wrench states carried to points in the world.
            state: Mean and covariance.
        """
        q, v, u, P, nv = state.q, state.v, state.forces, state.P, body.nv
        feet = 0 if body.loads_given else FEET
        a, torque = body.acceleration(q, v, u), body.joint_forces(q, v, u)
        tau = body.generalised(q, v, a, u)
        at_origin = wrenches.reading(q, u[-FEET:], np.zeros((2, 3)))
        dofs = len(body.torque_dofs)
        T = np.zeros((dofs + feet, len(P)))
        T[:dofs] = np.concatenate([torque.by_q, torque.by_v, torque.by_u], axis=1)
        if feet:
            T[dofs:, :nv], T[dofs:, -FEET:] = at_origin.by_q, at_origin.by_state
        sd, tau_sd = root(np.einsum("ij,ij->i", T @ P, T)), np.full(nv, np.nan)
        unknown = np.isnan(state.given)
        if not unknown.any():
            tau_sd[body.torque_dofs] = sd[:dofs]
            tau_sd[body.fixed] = np.nan
        wrench_sd = sd[dofs:] if feet else np.where(unknown, np.nan, 0.0)
        return cls(q, v, a, tau, at_origin.wrench.reshape(2, 6), tau_sd, wrench_sd.reshape(2, 6))


class TorqueReport(StateReport[ForcedState]):
    """Reads a :class:`TorqueFilter`."""

    kalman: TorqueFilter

    def first(self, motion: FirstMotion, frame: Frame) -> Posterior:
        """The motion with torques by inverse dynamics under the frame's plates."""
        first = self.kalman.first(motion.state, motion.accelerations.mean(axis=0), frame)
        read = self._read(first.state)
        found = self._without_step(first.state, read, first.memory, first.contact, frame)
        return found._replace(tracked=True, started=True)

    def posterior(self, step: TorqueStep, before: Posterior, frame: Frame) -> Posterior:
        """The estimate that a step led to.

        Raises:
            numpy.linalg.LinAlgError: The filter has diverged so far that motion or torques are not finite.
        """
        read, contact = self._read(step.state), step.decisions.notes.contact
        if not read.finite:
            raise np.linalg.LinAlgError("motion or torques are not finite")
        feet = None if contact is None else contact.contacts
        record, seen = Record(step.state, step, None, read), (step.refused, step.tracked, False)
        return Posterior(read.q, read.v, read.a, read.foot_wrench, feet, *seen, record)

    def unsolved(self, error: Exception, before: Posterior, frame: Frame) -> Posterior:
        """The state before, untracked: the thesis's filter may diverge until no step can be computed.

        Args:
            error: The numerical error.
            before: Estimate of the frame before.
            frame: The readings, of which contact is decided.
        """
        was = before.record
        stayed = self.kalman.stayed(was.state, was.memory, frame)
        return self._without_step(was.state, _read(before), stayed.memory, stayed.contact, frame)

    def _without_step(
        self, state: ForcedState, read: TorqueState, memory: Memory, contact: ContactDecision, frame: Frame
    ) -> Posterior:
        """A posterior that no step led to.

        Args:
            state: The filter's state.
            read: Motion and forces there.
            memory: For the next step.
            contact: Support of the feet.
            frame: The readings.
        """
        record, refused = Record(state, None, memory, read), np.zeros(len(frame.markers_m), dtype=bool)
        seen = contact.contacts, refused, False, False
        return Posterior(read.q, read.v, read.a, read.foot_wrench, *seen, record)

    def moved(self, estimate: Posterior, state: ForcedState, before: ForcedState | None) -> Posterior:
        """An estimate whose state later frames have corrected."""
        if state is estimate.record.state:
            return estimate
        read = self._read(state)
        record = estimate.record._replace(state=state, detail=read)
        return estimate._replace(q=read.q, v=read.v, a=read.a, wrench=read.foot_wrench, record=record)

    def spread(
        self,
        estimate: Posterior,
        torques: bool = True,
        levels: bool = False,
        body: BodyErrorRoots | None = None,
    ) -> Spread:
        """Standard deviations; torques are states of this filter."""
        P, layout, read = estimate.record.state.P, self.kalman.layout, _read(estimate)
        variance, q = np.diagonal(P), layout.q
        parts = partial(self.reader.parts, read.q, P[q, q])
        loads = read.tau_sd**2, parts, body, read.foot_wrench_sd.ravel() ** 2
        return Spread(self.reader, read.q, variance[q], variance[layout.v], *loads)

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) of the state's wrenches, carried to the world's origin."""
        return _read(estimate).foot_wrench_sd

    def predict(self, before: Posterior) -> Prediction:
        """By steady motion: the filter's own plant waits for the plates, which show how the torques change."""
        return steady_motion(before, self.covariance(before), self.kalman.sensor, self.kalman.plant.dt_s)

    def _read(self, state: ForcedState) -> TorqueState:
        return TorqueState.of(self.kalman.body, self.kalman.plates.sensor, state)


def _read(estimate: Posterior) -> TorqueState:
    return cast("TorqueState", estimate.record.detail)


def steady_motion(estimate: Posterior, covariance: Array, sensor: MarkerSensor, dt_s: float) -> Prediction:
    """The frame after an estimate by steady velocity (thesis eqs. 3.1–3.3).

    P⁻ = P_qq + Δt (P_qv + P_vq) + Δt² P_vv + Δt⁴/4 σ_a², with the body's own table of accelerations.

    Args:
        estimate: A posterior.
        covariance: (2 nv, 2 nv) its covariance P of (q, v).
        sensor: The markers on the body.
        dt_s: Time step Δt.
    """
    model, P = sensor.model, covariance
    nv = model.nv
    cross = dt_s * P[:nv, nv:]
    predicted: Array = P[:nv, :nv] + cross + cross.T + dt_s**2 * P[nv:, nv:]
    predicted[np.arange(nv), np.arange(nv)] += 0.25 * dt_s**4 * model.acceleration_sd**2
    q = model.integrate(estimate.q, dt_s * estimate.v)
    return Prediction(q, MarkerPrediction(sensor.reading(q), predicted), None)
