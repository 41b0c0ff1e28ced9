"""Error of an estimate caused by errors of the sensors' mounts: the part that repeats.

A sensor's mount is wrong by a small turn θ_k about its segment's axes. Its own orientation is what it measures, so that
the segment is put wrong by −R_k θ_k in the world. With J_k the derivative of a segment's turn by the configuration,

    δq = W θ,   W = −(Σ J_kᵀ J_k + Π)⁻¹ [J_kᵀ R_k]

The filter narrows these turns as if what speaks of them erred anew in every frame; it does not. As the body's scale
factors (:mod:`mbkf.filters.body_errors`) they are carried along as consider parameters (S. F. Schmidt 1966).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.inertia_errors import InertiaErrors
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import JointTorques, NewtonEuler

LOOSE = 1e-4
"""Information on every dof besides the sensors: what none of them tells of does not err by their mounts."""


class MountErrors(BodyErrors):
    """Errors by the mounts of sensors that alone show a body."""

    def __init__(self, model: HumanModel, segments: Sequence[str], turn_sd_rad: Array) -> None:
        """Makes it.

        Args:
            model: The body.
            segments: S segments that carry sensors.
            turn_sd_rad: (S, 3) spread of each mount's turn about its segment's axes.
        """
        self._model, self._balance, self._inertia = model, NewtonEuler(model), InertiaErrors(model)
        self._joints = [model.joint(name).joint_id for name in segments]
        self._turns = np.asarray(turn_sd_rad)
        self._varied, self._along = [], np.zeros((0, self._turns.size))  # sizes are taken as known

    def pose_roots(self, poses: Array) -> list[Array]:
        """W L (nv, 3 S) at each of the configurations (N, nq), L the spreads of the turns."""
        return [self._root(q) for q in poses]

    def _root(self, q: Array) -> Array:
        """(nv, 3 S) W L at a configuration q (nq,)."""
        model, count = self._model, len(self._joints)
        rotations, _ = model.placements(q)
        _, spatial = model.frames_and_jacobian(q)
        by_q = np.array([spatial[3:] * model.supports[joint] for joint in self._joints])
        turned = np.zeros((count, 3, count, 3))
        for k, joint in enumerate(self._joints):
            turned[k, :, k] = rotations[joint] * self._turns[k]
        by_q, moved = by_q.reshape(3 * count, -1), turned.reshape(3 * count, 3 * count)
        information = by_q.T @ by_q + LOOSE * np.eye(model.nv)
        return -np.asarray(np.linalg.solve(information, by_q.T @ moved))

    def _own_torques(self, q: Array, v: Array, a: Array, loads: Array, balance: JointTorques) -> Array:
        """Mounts change no torque of a motion that is known."""
        del q, a, loads, balance
        return np.zeros((len(v), 3 * len(self._joints)))
