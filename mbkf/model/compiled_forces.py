"""Forces on a body and its forward dynamics by the compiled kernel (``mass.c``, ``foot_loads.c``, ``torques.c``).

Wrenches on the feet are about the world's origin here, where a constant one does not change with the configuration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.tree import CompiledTree
from mbkf.model.body import Body
from mbkf.model.layout import FEET, FOOT

_ORIGIN = np.zeros((2, 3))


@dataclass(frozen=True)
class Given:
    """Q_g + Jᵀ w: ``force`` (nv,), its derivatives ``by_q``, ``by_v`` (nv, nv) and by wrench states (nv, 12)."""

    force: Array
    by_q: Array
    by_v: Array
    by_state: Array

    @classmethod
    def nothing(cls, nv: int) -> Given:
        """No force."""
        none = np.zeros((nv, nv))
        return cls(np.zeros(nv), none, none, np.zeros((nv, FEET)))


class Wrenches(NamedTuple):
    """(12,) wrenches of both feet in the world, derivatives by their states (12, 12) and the configuration (12, nv)."""

    wrench: Array
    by_state: Array
    by_q: Array


class CompiledForces:
    """Mass matrix, gravity and velocity terms, and the feet's wrenches of a body.

    The mass matrix of the latest configuration is kept: a frame's filter asks for it several times.
    """

    def __init__(
        self,
        trees: tuple[CompiledTree, CompiledTree],
        body: Body,
        moving: BoolArray,
        levers: Array,
        frame: str,
    ) -> None:
        """Keeps what does not change.

        Args:
            trees: The body's equations, with gravity and without.
            body: The body.
            moving: (nv,) dofs that forces move.
            levers: (2, 3) where a foot's force acts, in its axes, m.
            frame: Coordinates of the wrenches' states, one of :data:`mbkf.model.human_dynamics.WRENCH_FRAMES`, or
                "world": about the world's origin.
        """
        self._tree, self._weightless = trees
        self._moving, self._levers, self._own_axes = moving, np.ascontiguousarray(levers), frame == "foot"
        feet = [body.joint(name).joint_id for name in body.roles.feet]
        self._feet, self._moves = np.array(feet, dtype=np.int32), np.ascontiguousarray(body.supports[feet])
        self._still, self._unloaded = np.zeros(body.nv), np.zeros(FEET)
        self._in_world = frame == "world"
        self._kept: tuple[bytes, tuple[Array, Array]] | None = None

    @classmethod
    def where_built(cls, body: Body, moving: BoolArray, levers: Array, frame: str) -> Self | None:
        """The forces of a body, if the kernel is compiled and knows all of its joints; else None.

        Args:
            body: The body.
            moving: (nv,) dofs that forces move.
            levers: (2, 3) where a foot's force acts, in its axes, m.
            frame: Coordinates of the wrenches' states, one of :data:`mbkf.model.human_dynamics.WRENCH_FRAMES`, or
                "world": about the world's origin.
        """
        tree, weightless = body.tree, body.pin_model.copy()
        weightless.gravity.linear = np.zeros(3)
        second = None if tree is None else CompiledTree.where_built(weightless)
        return None if tree is None or second is None else cls((tree, second), body, moving, levers, frame)

    def mass(self, q: Array) -> tuple[Array, Array]:
        """(nv, nv) mass matrix, and the inverse of its part of the moving dofs.

        Raises:
            numpy.linalg.LinAlgError: It is not positive.
        """
        kept, numbers = self._kept, q.tobytes()
        if kept is None or kept[0] != numbers:
            kept = self._kept = numbers, self._tree.mass_inverse(q, self._moving)
        return kept[1]

    def wrenches(self, q: Array, state: Array, points_m: Array = _ORIGIN) -> Wrenches:
        """Wrenches of the feet.

        Args:
            q: (nq,) configuration.
            state: (12,) their states.
            points_m: (2, 3) points in the world about which moments are taken, m.
        """
        if self._in_world:
            return _shifted(state, points_m, len(self._still))
        return Wrenches(
            *self._tree.foot_wrenches(q, self._feet, self._levers, self._own_axes, state, points_m)
        )

    def force(self, q: Array, v: Array, state: Array) -> Array:
        """(nv,) Q_g + Jᵀ w alone.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            state: (12,) states of the wrenches.
        """
        return -self._tree.tau(q, v, self._still, self._moves, self.wrenches(q, state).wrench)

    def given(self, q: Array, v: Array, state: Array) -> Given:
        """Q_g + Jᵀ w with derivatives.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            state: (12,) states of the wrenches.
        """
        nv, load = len(self._still), self.wrenches(q, state)
        tau, by, _ = self._tree.torques(q, v, self._still, self._moves, load.wrench)
        by_wrench = by[:, 3 * nv :]
        by_q = -by[:, :nv] - by_wrench @ load.by_q
        return Given(-tau, by_q, -by[:, nv : 2 * nv], -by_wrench @ load.by_state)

    def pull(self, q: Array) -> Array:
        """(nv, 12) derivative of Q_g + Jᵀ w by the wrenches' states at a configuration q (nq,): the same for all w."""
        return self.given(q, self._still, self._unloaded).by_state

    def at_root(self, q: Array, v: Array, state: Array) -> Given:
        """The first six rows of :meth:`given`.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            state: (12,) states of the wrenches.
        """
        nv, load = len(self._still), self.wrenches(q, state)
        tau, by = self._tree.root(q, v, self._still, load.wrench[:FOOT] + load.wrench[FOOT:])
        by_wrench = by[:, 3 * nv :]
        by_q = -by[:, :nv] - by_wrench @ load.by_q
        return Given(-tau, by_q, -by[:, nv : 2 * nv], -by_wrench @ load.by_state)

    def inertia_slope(self, q: Array, a: Array) -> Array:
        """(nv, nv) ∂(M a)/∂q at a configuration q (nq,), for an acceleration a (nv,) that stays."""
        return self._weightless.torques(q, self._still, a, self._moves, self._unloaded)[1][:, : len(a)]


def _shifted(wrench: Array, points_m: Array, nv: int) -> Wrenches:
    """Wrenches (12,) about the world's origin, about points (2, 3) instead."""
    by_state = np.eye(FEET)
    for foot, (x, y, z) in enumerate(points_m):
        force = FOOT * foot
        by_state[force + 3 : force + FOOT, force : force + 3] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return Wrenches(by_state @ wrench, by_state, np.zeros((FEET, nv)))
