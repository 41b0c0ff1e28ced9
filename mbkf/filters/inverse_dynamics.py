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


def inverse_dynamics(model: HumanModel, track: Track, foot_wrench: Array) -> InverseDynamics:
    """B_dᵀ T_d = M a − Q_g − B_pᵀ p with the plates' wrenches p on the feet (eq. 3.12).

    Args:
        model: The body.
        track: The followed trial.
        foot_wrench: (T, 2, 6) force N and moment N m about the world's origin on right and left foot, world axes.
    """
    a = track.a
    tau = np.full_like(a, np.nan)
    force, moment = np.full((len(a), 3), np.nan), np.full((len(a), 3), np.nan)
    pelvis = model.joint("pelvis").joint_id
    supports = [model.supports[model.joint(segment).joint_id] for segment in FEET]
    for t in np.flatnonzero(~np.isnan(a).any(axis=1)):
        q = track.q[t]
        tau[t] = model.inverse_dynamics(q, track.v[t], a[t])
        rotations, _, jacobian = model.placements_and_jacobian(q)
        for moves, wrench in zip(supports, foot_wrench[t], strict=True):
            tau[t] -= np.where(moves, wrench @ jacobian, 0.0)
        force[t] = rotations[pelvis] @ tau[t, :3]
        moment[t] = rotations[pelvis] @ tau[t, 3:6]
    return InverseDynamics(tau, force, moment)
