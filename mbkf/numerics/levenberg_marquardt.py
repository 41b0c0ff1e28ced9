"""Levenberg–Marquardt for many frames that share parameters (the arrow structure of thesis eq. 4.1).

The normal equations of N frames with n own unknowns each and s shared ones are an arrow: one n×n block per frame, a
border to the shared unknowns, one s×s corner. Eliminating the frames leaves a dense s×s system (Schur complement), so
the cost grows linearly with the number of frames.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np
from scipy.linalg import lapack

from mbkf.conventions import Array
from mbkf.numerics.elimination import Border, RowBlock, eliminate, row_blocks

State = TypeVar("State")


@dataclass(frozen=True)
class ArrowEquations:
    """Gauss–Newton equations of Σ r² at one point: H δ = −g.

    Attributes:
        frames: (N, n, n) JᵀJ of each frame's own unknowns.
        border: JᵀJ between a frame's n and the s shared unknowns.
        corner: (s, s) JᵀJ of the shared unknowns.
        frame_gradient: (N, n) Jᵀr of the frames.
        corner_gradient: (s,) Jᵀr of the shared unknowns.
        cost: Sum of squared residuals.
    """

    frames: Array
    border: Border
    corner: Array
    frame_gradient: Array
    corner_gradient: Array
    cost: float

    def schur_complement(self) -> Array:
        """(s, s) information of the shared unknowns once the frames are eliminated."""
        return self.corner - eliminate(self.frames, self.border, self.frame_gradient, self._blocks).complement

    def reduced(self) -> tuple[Array, Array]:
        """(s, s) information of the shared unknowns once the frames are eliminated, and their (s,) gradient."""
        eliminated = eliminate(self.frames, self.border, self.frame_gradient, self._blocks)
        return self.corner - eliminated.complement, self.corner_gradient - eliminated.pull

    @cached_property
    def _blocks(self) -> list[RowBlock]:
        return row_blocks(self.frames, self.border)

    def step(self, damping: float) -> tuple[Array, Array]:
        """Damped step: (N, n) of the frames and (s,) of the shared unknowns (Marquardt's diagonal scaling).

        Raises:
            numpy.linalg.LinAlgError: The damped matrix is not positive definite, or not finite.
        """
        if not len(self.corner):
            damped = zip(_damped(self.frames, damping), self.frame_gradient, strict=True)
            return -np.array([_solved(*one) for one in damped]), np.zeros(0)
        eliminated = eliminate(_damped(self.frames, damping), self.border, self.frame_gradient, self._blocks)
        reduced = _damped(self.corner, damping) - eliminated.complement
        shared = -_solved(reduced, self.corner_gradient - eliminated.pull)
        return -eliminated.own_step(shared), shared


def _solved(matrix: Array, right: Array) -> Array:
    """(n,) solution of a symmetric positive definite system."""
    _, found, failed = lapack.dposv(matrix.T, right)
    if failed:
        raise np.linalg.LinAlgError("the matrix is not positive definite")
    return np.asarray(found)


def _damped(matrices: Array, damping: float) -> Array:
    """Matrices (…, n, n) with their diagonals enlarged by a share."""
    damped = matrices.copy()
    diagonal = np.arange(matrices.shape[-1])
    damped[..., diagonal, diagonal] *= 1.0 + damping
    return damped


@dataclass(frozen=True)
class Solution(Generic[State]):
    """Where Levenberg–Marquardt ended: the state, its equations, iterations and whether it converged."""

    state: State
    equations: ArrowEquations
    iterations: int
    converged: bool


def minimise(
    start: State,
    linearise: Callable[[State], ArrowEquations],
    cost: Callable[[State], float],
    move: Callable[[State, Array, Array], State],
    *,
    tolerance: float = 1e-5,
    max_iterations: int = 50,
    on_iteration: Callable[[int], None] | None = None,
) -> Solution[State]:
    """Minimises a sum of squares over frames and shared unknowns (Marquardt 1963, with Nielsen's damping rule).

    A step to a cost that is not finite is rejected. A search that starts at one, or whose shortest step ends at one,
    has not converged.

    Args:
        start: First state.
        linearise: Gauss–Newton equations at a state.
        cost: Sum of squared residuals at a state.
        move: The state after a step of the frames (N, n) and the shared unknowns (s,).
        tolerance: Ends when an accepted step lowers the cost by less than this fraction.
        max_iterations: Most accepted steps.
        on_iteration: Called with the number of accepted steps.
    """
    state, damping, growth = start, 1e-4, 2.0
    equations = linearise(state)
    if not math.isfinite(equations.cost):
        return Solution(state, equations, 0, False)
    for iteration in range(1, max_iterations + 1):
        while True:
            candidate, found = _moved(state, equations, damping, cost, move)
            gain = equations.cost - found
            if gain > 0:
                break
            damping, growth = damping * growth, growth * 2.0
            if damping > 1e10:
                return Solution(state, equations, iteration, math.isfinite(found))
        before = equations.cost
        state, damping, growth = candidate, max(damping / 3.0, 1e-10), 2.0
        equations = linearise(state)
        if on_iteration is not None:
            on_iteration(iteration)
        if gain <= tolerance * before:
            return Solution(state, equations, iteration, True)
    return Solution(state, equations, max_iterations, False)


def _moved(
    state: State,
    equations: ArrowEquations,
    damping: float,
    cost: Callable[[State], float],
    move: Callable[[State, Array, Array], State],
) -> tuple[State, float]:
    """The state after a damped step and its cost, NaN where the equations have no solution."""
    try:
        candidate = move(state, *equations.step(damping))
    except np.linalg.LinAlgError:
        return state, math.nan
    return candidate, cost(candidate)
