"""Joint torques after the kinematic filter: the plates' wrenches through Newton–Euler (SPEC §5, FCDI)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.tracking import Track
from mbkf.model.human import HumanModel
from mbkf.sensors.contacts import FEET


@dataclass(frozen=True)
class InverseDynamics:
    """Generalised forces of a followed trial; NaN where it is not followed.

    Attributes:
        tau: (T, nv) generalised forces by eq. 3.12; the first six are the pelvis residual in pelvis axes.
        residual_force_n: (T, 3) residual force, world axes.
        residual_moment_nm: (T, 3) residual moment about the pelvis origin, world axes.
    """

    tau: Array
    residual_force_n: Array
    residual_moment_nm: Array


class TorqueSolver:
    """Generalised forces of one instant: B_dᵀ T_d = M a − Q_g − B_pᵀ p (eq. 3.12)."""

    def __init__(self, model: HumanModel) -> None:
        self.model = model
        self._root = model.root.v
        self._moves = model.supports[[model.joint(segment).joint_id for segment in FEET]].astype(float)

    def torques(self, q: Array, v: Array, a: Array, foot_wrench: Array) -> Array:
        """(nv,) forces for q (nq,), v (nv,), a (nv,) and the wrenches p (2, 6) on right and left foot.

        Wrenches are force N and moment N m about the world's origin, world axes.
        """
        tau = self.model.inverse_dynamics(q, v, a)
        tau -= np.einsum("fk,fk->k", self._moves, foot_wrench @ self.model.spatial_jacobian(q))
        return tau

    def residual(self, q: Array, tau: Array) -> tuple[Array, Array]:
        """Force (3,) and moment (3,) of the pelvis residual in world axes: the pelvis's own axes turn with it."""
        R = self.model.spatial_jacobian(q)[:3, self._root][:, :3]
        return R @ tau[self._root][:3], R @ tau[self._root][3:]


def inverse_dynamics(model: HumanModel, track: Track, foot_wrench: Array) -> InverseDynamics:
    """Generalised forces and residual of every followed frame.

    Args:
        model: The body.
        track: The followed trial.
        foot_wrench: (T, 2, 6) wrenches p as :class:`TorqueSolver` takes them.
    """
    a, solver = track.a, TorqueSolver(model)
    tau = np.full_like(a, np.nan)
    force, moment = np.full((len(a), 3), np.nan), np.full((len(a), 3), np.nan)
    for t in np.flatnonzero(~np.isnan(a).any(axis=1)):
        tau[t] = solver.torques(track.q[t], track.v[t], a[t], foot_wrench[t])
        force[t], moment[t] = solver.residual(track.q[t], tau[t])
    return InverseDynamics(tau, force, moment)
