"""Newton–Euler on the whole body: the generalised forces of a motion under two foot wrenches.

τ = ID(q, v, a) − Σ J_fᵀ w_f. Its first six rows are the residual at the root, zero for a body that obeys Newton's
law; the others are the joint torques. Wrenches are about the world's origin in world axes, so that a constant one
does not change with q by itself. Departs from thesis eq. 3.9: a torque is in the axes of the joint's own segment, those
of v, where the thesis has the axes of the segment before it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.kernel.tree import SectionTable
from mbkf.model.body import Body
from mbkf.model.layout import FOOT, Layout

ROOT = 6


@dataclass(frozen=True)
class RootBalance:
    """The pelvis's six equations, in pelvis axes; force N, moment N m.

    Attributes:
        residual: (6,) ID(q, v, a) − Σ J_fᵀ w_f.
        by_state: (6, N) its derivatives by q (in the tangent space), v, a and the feet's wrenches.
    """

    residual: Array
    by_state: Array


@dataclass(frozen=True)
class JointTorques:
    """All generalised forces.

    Attributes:
        tau: (nv,) the forces.
        by_state: (nv, N) their derivatives by q (in the tangent space), v, a and the feet's wrenches.
        columns: Slices of these derivatives, N columns.
    """

    tau: Array
    by_state: Array
    columns: Layout

    @property
    def by_q(self) -> Array:
        """(nv, nv) by the configuration."""
        return self.by_state[:, self.columns.q]

    @property
    def by_v(self) -> Array:
        """(nv, nv) by the velocity."""
        return self.by_state[:, self.columns.v]

    @property
    def by_a(self) -> Array:
        """(nv, nv) by the acceleration."""
        return self.by_state[:, self.columns.a]

    @property
    def by_wrench(self) -> Array:
        """(nv, 12) by the wrenches of right and left foot."""
        return self.by_state[:, self.columns.wrench]


class NewtonEuler:
    """Newton–Euler equations of a body with its two feet's wrenches."""

    def __init__(self, model: Body) -> None:
        self.model = model
        self._pin = model.pin_model
        ids = [model.joint(segment).joint_id for segment in model.roles.feet]
        self._chains = [np.flatnonzero(model.supports[j]) for j in ids]
        self._moves = [model.supports[j].astype(float) for j in ids]
        self._after = [_moved_by(model, chain) for chain in self._chains]
        self._tree = model.tree
        self._others: dict[int, tuple[NDArray[np.intp], Array]] = {}
        self._columns = Layout.dynamic(model.nv)
        self._J = np.zeros((ROOT, model.nv))
        self._moves_feet = np.array(self._moves, dtype=bool)

    @cached_property
    def _data(self) -> pin.Data:
        """Pinocchio's working memory, 5 MB: made where no compiled kernel does the work."""
        return pin.Data(self._pin)

    def root(self, q: Array, v: Array, a: Array, wrenches: Array) -> RootBalance:
        """The pelvis's equations for the feet's wrenches (12,).

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrenches: (12,) right and left foot's wrenches: force N and moment N m about the world's origin.
        """
        wrench = wrenches[:ROOT] + wrenches[ROOT:]
        if self._tree is not None:
            return RootBalance(*self._tree.root(q, v, a, wrench))
        by_q, by_v, by_a = self._inverse_dynamics(q, v, a)
        data = self._data
        by_state = np.empty((ROOT, self._columns.size))
        by_wrench = -data.J[:, :ROOT].T
        # A wrench that is constant in the world turns in the pelvis's axes when these turn.
        own = by_wrench @ wrench
        np.concatenate([by_q[:ROOT], by_v[:ROOT], by_a[:ROOT], by_wrench, by_wrench], axis=1, out=by_state)
        by_state[:, :ROOT] += _turned_wrench(own)
        return RootBalance(data.tau[:ROOT] + own, by_state)

    def law(
        self, q: Array, v: Array, a: Array, wrenches: Array, extra: Array, by_extra: Array, sharp: Array
    ) -> tuple[Array, Array]:
        """The pelvis's equations as whitened readings of zero: (6, N + m) rows and (6,) innovations.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrenches: (12,) right and left foot's wrenches: force N and moment N m about the world's origin.
            extra: (m,) further states that act at the root.
            by_extra: (6, m) whitened rows on them.
            sharp: (6,) 1/sd of each equation.
        """
        if self._tree is not None:
            return self._tree.law(q, v, a, wrenches, extra, by_extra, sharp)
        root = self.root(q, v, a, wrenches)
        rows = np.concatenate([root.by_state * sharp[:, None], by_extra], axis=1)
        return rows, -root.residual * sharp - by_extra @ extra

    def torques(self, q: Array, v: Array, a: Array, wrenches: Array) -> JointTorques:
        """All generalised forces with derivatives, for the feet's wrenches (12,).

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrenches: (12,) right and left foot's wrenches: force N and moment N m about the world's origin.
        """
        if self._tree is not None:
            tau, by_state, self._J = self._tree.torques(q, v, a, self._moves_feet, wrenches)
            return JointTorques(tau, by_state, self._columns)
        nv = self.model.nv
        by_state = np.empty((nv, self._columns.size), order="F")
        found = JointTorques(np.empty(nv), by_state, self._columns)
        found.by_q[:], found.by_v[:], found.by_a[:] = self._inverse_dynamics(q, v, a)
        found.tau[:], J = self._data.tau, self._data.J
        self._J = J
        for foot, (chain, moves, after) in enumerate(
            zip(self._chains, self._moves, self._after, strict=True)
        ):
            mine = slice(FOOT * foot, FOOT * foot + FOOT)
            wrench, block = wrenches[mine], found.by_wrench[:, mine]
            np.multiply(J.T, -moves[:, None], out=block)
            found.tau[:] += block @ wrench
            own = J[:, chain]
            by_state[chain[:, None], chain] -= after * (own.T @ _turned_wrench(wrench) @ own)
        return found

    def compiled_loads(
        self, q: Array, v: Array, a: Array, wrenches: Array, sections: SectionTable
    ) -> Array | None:
        """(6 L + nv, N) derivatives of moments at L sections and of :meth:`torques`; None without a compiled kernel.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrenches: (12,) right and left foot's wrenches.
            sections: The sections.
        """
        if self._tree is None:
            return None
        return self._tree.loads(q, v, a, self._moves_feet, wrenches, sections)[1]

    def loaded(self, found: JointTorques, loads: Mapping[int, Array]) -> None:
        """Adds further loads to the last result of :meth:`torques`, in place: τ −= Σ Jᵀ w.

        Args:
            found: The last result of :meth:`torques`.
            loads: (6,) wrench about the world's origin by the index of the joint whose segment bears it.
        """
        J = self._J
        for joint, wrench in loads.items():
            if joint not in self._others:
                chain = np.flatnonzero(self.model.supports[joint])
                self._others[joint] = chain, _moved_by(self.model, chain)
            chain, after = self._others[joint]
            own = J[:, chain]
            found.tau[chain] -= own.T @ wrench
            found.by_state[chain[:, None], chain] -= after * (own.T @ _turned_wrench(wrench) @ own)

    def jacobian(self, joint: int) -> Array:
        """(6, nv) velocity at the world's origin of a joint's segment, at the motion of the last :meth:`torques`."""
        return np.where(self.model.supports[joint], self._J, 0.0)

    def tau(self, q: Array, v: Array, a: Array, wrenches: Array) -> Array:
        """(nv,) generalised forces alone.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrenches: (12,) right and left foot's wrenches: force N and moment N m about the world's origin.
        """
        if self._tree is not None:
            return self._tree.tau(q, v, a, self._moves_feet, wrenches)
        tau = pin.rnea(self._pin, self._data, q, v, a)
        J = pin.computeJointJacobians(self._pin, self._data, q)
        for foot, moves in enumerate(self._moves):
            tau -= (wrenches[6 * foot : 6 * foot + 6] @ J) * moves
        return tau

    def motion_tau(self, q: Array, v: Array, a: Array, wrenches: Array) -> Array:
        """(T, nv) :meth:`tau` of the frames of a motion.

        Args:
            q: (T, nq) configurations.
            v: (T, nv) velocities in the tangent space.
            a: (T, nv) accelerations.
            wrenches: (T, 12) wrenches of right and left foot.
        """
        if self._tree is not None:
            return self._tree.motion_tau(q, v, a, self._moves_feet, wrenches)
        found = [self.tau(*one).copy() for one in zip(q, v, a, wrenches, strict=True)]
        return np.array(found).reshape(len(q), self.model.nv)

    def _inverse_dynamics(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        """(nv, nv) derivatives of inverse dynamics by q, v and a; torques and Jacobian stay in Pinocchio's data."""
        return pin.computeRNEADerivatives(self._pin, self._data, q, v, a)


def _moved_by(model: Body, chain: NDArray[np.intp]) -> Array:
    """(n, n) 1 where the axis of a chain's dof (row) turns with a dof (column): the same joint's or one before it."""
    mine = np.repeat(np.arange(model.pin_model.njoints), model.pin_model.nvs)[chain]
    return (mine[:, None] >= mine[None, :]).astype(float)


def _turned_wrench(wrench: Array) -> Array:
    """(6, 6) X with (J_k × J_i) · w = J_iᵀ X J_k: effect on axis i of a turn by dof k."""
    turned = np.zeros((6, 6))
    turned[:3, 3:] = turned[3:, :3] = pin.skew(wrench[:3])
    turned[3:, 3:] = pin.skew(wrench[3:])
    return turned
