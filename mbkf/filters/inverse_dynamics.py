"""Joint torques of a followed trial: the wrenches on its body through Newton–Euler (with the plates', thesis: FCDI)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.record import Track
from mbkf.model.body import Body
from mbkf.model.motion_frames import motion_frames
from mbkf.model.newton_euler import NewtonEuler


@dataclass(frozen=True)
class InverseDynamics:
    """Generalised forces of a followed trial; NaN where it is not followed.

    Attributes:
        tau: (T, nv) generalised forces by thesis eq. 3.12; the first six are the pelvis residual in pelvis axes.
        residual_force_n: (T, 3) residual force, world axes.
        residual_moment_nm: (T, 3) residual moment about the pelvis origin, world axes.
    """

    tau: Array
    residual_force_n: Array
    residual_moment_nm: Array


def residual_in_world(model: Body, q: Array, tau: Array) -> tuple[Array, Array]:
    """Force (3,) and moment (3,) of the pelvis residual in world axes: the pelvis's own axes turn with it.

    Args:
        model: The body.
        q: (nq,) configuration.
        tau: (nv,) generalised forces; the first six are the residual in pelvis axes.
    """
    root = model.root.v
    R = model.spatial_jacobian(q)[:3, root][:, :3]
    return R @ tau[root][:3], R @ tau[root][3:]


def _residuals_in_world(model: Body, jacobians: Array, tau: Array) -> Array:
    """(T, 2, 3) forces and moments of :func:`residual_in_world` by (T, 6, nv) spatial Jacobians and (T, nv) forces."""
    root = model.root.v
    R = jacobians[:, :3, root][:, :, :3]
    return np.einsum("tij,tkj->tki", R, tau[:, root].reshape(-1, 2, 3))


def support_torques(model: Body, q: Array, support: Array) -> Array:
    """(nv,) Σ J_pᵀ w_p: what wrenches on parts of the body besides the feet add to the generalised forces.

    Args:
        model: The body.
        q: (nq,) configuration.
        support: (B, 6) wrenches about the world's origin on the parts ``description.bearings``; a part that is NaN
            bears nothing.
    """
    parts = model.description.bearings.values()
    moves = model.supports[[model.joint(part.segment).joint_id for part in parts]]
    return ((np.nan_to_num(support) @ model.spatial_jacobian(q)) * moves).sum(axis=0)


def inverse_dynamics(
    model: Body, track: Track, foot_wrench: Array, support: Array | None = None
) -> InverseDynamics:
    """Generalised forces and residual of every followed frame.

    Args:
        model: The body.
        track: The followed trial.
        foot_wrench: (T, 2, 6) wrenches p on right and left foot: force N and moment N m about the world's origin.
        support: (T, B, 6) the same on the parts that may bear load besides the feet (``description.bearings``), 0 or
            NaN on one that bears none; None where the feet alone bear.
    """
    a = track.a
    known = np.flatnonzero(~np.isnan(a).any(axis=1))
    tau, residual = np.full_like(a, np.nan), np.full((len(a), 2, 3), np.nan)
    tau[known] = NewtonEuler(model).motion_tau(
        track.q[known], track.v[known], a[known], foot_wrench[known].reshape(-1, 12)
    )
    if support is not None:
        bears = np.asarray(np.nan_to_num(support).any(axis=(1, 2)))
        for t in known[bears[known]]:
            tau[t] -= support_torques(model, track.q[t], support[t])
    residual[known] = _residuals_in_world(model, motion_frames(model, track.q[known])[1], tau[known])
    return InverseDynamics(tau, residual[:, 0], residual[:, 1])
