"""Prediction and update of a covariance by the compiled kernel (``covariance.c``), or by numpy where there is none."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.kernel.loading import Library, library
from mbkf.kernel.tree import CompiledTree
from mbkf.numerics import information_update


class CompiledPrediction:
    """P' = Φ P Φᵀ + Q of a state (q, v, a, rest) with Φ_q = [A, B Δt, B c₂, 0], as the Singer plant states it.

    ``None`` takes its place where there is no kernel: see :meth:`where_built`.
    """

    def __init__(self, kernel: Library, joints: Iterable[slice], singer: Array, noise: Array) -> None:
        """Keeps what does not change from step to step.

        Args:
            kernel: The compiled kernel.
            joints: Dofs of each joint: A and B are zero between joints.
            singer: (4,) Δt, c₁, c₂, ρ.
            noise: (3, 3) covariance of (q, v, a) for σ_a = 1.
        """
        self._kernel, self._singer, self._noise = kernel, np.ascontiguousarray(singer), noise
        self._joints = first_and_number(joints)

    @classmethod
    def where_built(cls, joints: Iterable[slice], singer: Array, noise: Array) -> CompiledPrediction | None:
        """One, or None where there is no compiled kernel.

        Args:
            joints: Dofs of each joint.
            singer: (4,) Δt, c₁, c₂, ρ.
            noise: (3, 3) covariance of (q, v, a) for σ_a = 1.
        """
        kernel = library()
        return None if kernel is None else cls(kernel, joints, singer, noise)

    def carried(self, P: Array, A: Array, B: Array, sd: Array) -> Array:
        """(N, N) covariance one step later, exactly symmetric.

        Args:
            P: (N, N) symmetric covariance.
            A: (nv, nv) derivative of the next configuration by this one.
            B: (nv, nv) by the step.
            sd: (nv,) σ_a of the step.
        """
        carried = np.empty(P.shape)
        A, B = np.ascontiguousarray(A), np.ascontiguousarray(B)
        self._kernel.carry(P, A, B, self._joints, self._singer, self._noise, sd, carried)
        return carried

    def predicted(
        self, tree: CompiledTree, P: Array, q: Array, v: Array, a: Array, sd: Array
    ) -> tuple[Array, Array, Array, Array]:
        """P (N, N), q (nq,), v and a (nv,) one step later, all in one call.

        Args:
            tree: The body.
            P: (N, N) symmetric covariance.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            sd: (nv,) σ_a of the step.
        """
        carried, further, faster, steeper = (
            np.empty(P.shape),
            np.empty(q.shape),
            np.empty(v.shape),
            np.empty(a.shape),
        )
        self._kernel.predict(
            tree.handle,
            P,
            q,
            v,
            a,
            self._joints,
            self._singer,
            self._noise,
            sd,
            carried,
            further,
            faster,
            steeper,
        )
        return carried, further, faster, steeper


class CompiledVelocityPrediction:
    """P' = Φ P Φᵀ + Q of a state (q, v) with Φ_q = [A, B Δt] and velocities that stay."""

    def __init__(self, kernel: Library, joints: Iterable[slice], dt_s: float, noise: Array) -> None:
        """Keeps what does not change from step to step.

        Args:
            kernel: The compiled kernel.
            joints: Dofs of each joint: A and B are zero between joints.
            dt_s: Δt.
            noise: (2, 2, nv) diagonals of the blocks of Q.
        """
        self._kernel, self._dt_s, self._noise = kernel, dt_s, np.ascontiguousarray(noise)
        self._joints = first_and_number(joints)

    @classmethod
    def where_built(
        cls, joints: Iterable[slice], dt_s: float, noise: Array
    ) -> CompiledVelocityPrediction | None:
        """One, or None where there is no compiled kernel.

        Args:
            joints: Dofs of each joint.
            dt_s: Δt.
            noise: (2, 2, nv) diagonals of the blocks of Q.
        """
        kernel = library()
        return None if kernel is None else cls(kernel, joints, dt_s, noise)

    def carried(self, P: Array, A: Array, B: Array) -> Array:
        """(2 nv, 2 nv) covariance one step later, exactly symmetric.

        Args:
            P: (2 nv, 2 nv) symmetric covariance.
            A: (nv, nv) derivative of the next configuration by this one.
            B: (nv, nv) by the step.
        """
        carried = np.empty(P.shape)
        A, B = np.ascontiguousarray(A), np.ascontiguousarray(B)
        self._kernel.carry_velocities(P, A, B, self._joints, self._dt_s, self._noise, carried)
        return carried


def first_and_number(joints: Iterable[slice]) -> NDArray[np.int32]:
    """(J, 2) first dof and number of dofs of each joint."""
    return np.array([(dofs.start, dofs.stop - dofs.start) for dofs in joints], dtype=np.int32)


def informed_with_rows(covariance: Array, matrix: Array, rows: Array, memory: Array | None = None) -> Array:
    """(N, N) as :func:`mbkf.numerics.information_update.informed_with_rows`, by the compiled kernel where there is one.

    What the kernel cannot factorise is the reference's, which knows what to do with it.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; their values do not enter.
        memory: (N, N) array that may be filled with the answer, so that none is made.
    """
    kernel = library()
    if kernel is not None:
        informed = np.empty(covariance.shape) if memory is None else memory
        if kernel.inform(covariance, matrix, np.ascontiguousarray(rows), informed) == 0:
            return informed.T
    return information_update.informed_with_rows(covariance, matrix, rows)


def informed_after_rows(covariance: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) as :func:`mbkf.numerics.information_update.informed_after_rows`, by the kernel where there is one.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; the values do not enter.
    """
    if library() is None:
        return information_update.informed_after_rows(covariance, matrix, rows)
    return informed_with_rows(covariance, matrix, rows)


def correction(covariance: Array, vector: Array, rows: Array, values: Array) -> Array:
    """(N,) P (λ + Hᵀ y): how far readings move a mean.

    Args:
        covariance: (N, N) posterior covariance P, symmetric.
        vector: (n,) λ on the first n components.
        rows: (m, N) H, whitened.
        values: (m,) y, their innovations.
    """
    kernel = library()
    if kernel is not None:
        step = np.empty(len(covariance))
        kernel.correction(covariance, vector, rows, values, step)
        return step
    total = values @ rows
    total[: len(vector)] += vector
    return np.asarray(covariance @ total)
