"""What a mean and covariance of (q, v, u) say of motion and forces, with standard deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.torque.plant import ForcedState
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.foot_wrench import FootWrenchSensor


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

    @property
    def finite(self) -> bool:
        """Whether all of motion and torques could be computed."""
        return bool(np.isfinite(self.q).all() and np.isfinite(self.tau).all())


def reported(body: HumanDynamics, wrenches: FootWrenchSensor, state: ForcedState) -> TorqueState:
    """Motion, torques and wrenches of a state.

    Args:
        body: The forced body.
        wrenches: Its wrench states carried to points in the world.
        state: Mean and covariance.
    """
    nv = body.nv
    a = body.acceleration(state.q, state.v, state.u)
    tau = body.generalised(state.q, state.v, a, state.u)
    at_origin = wrenches.reading(state.q, state.u[-12:], np.zeros((2, 3)))
    columns = np.concatenate([np.arange(nv), np.arange(len(state.P) - 12, len(state.P))])
    H = np.hstack([at_origin.by_q, at_origin.by_state])
    spread = ((H @ state.P[np.ix_(columns, columns)]) * H).sum(axis=1)
    tau_sd = np.full(nv, np.nan)
    torque = body.joint_forces(state.q, state.v, state.u)
    T = np.hstack([torque.by_q, torque.by_v, torque.by_u])
    tau_sd[body.torque_dofs] = np.sqrt(np.maximum(((T @ state.P) * T).sum(axis=1), 0.0))
    tau_sd[body.fixed] = np.nan
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
