"""Levenberg–Marquardt for many frames that share parameters (the arrow structure of thesis eq. 4.1).

The normal equations of N frames with n own unknowns each and s shared ones are an arrow: one n×n block per frame, a
border to the shared unknowns, one s×s corner. Eliminating the frames leaves a dense s×s system (Schur complement), so
the cost grows linearly with the number of frames.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from mbkf.conventions import Array

State = TypeVar("State")


@dataclass(frozen=True)
class ArrowEquations:
    """Gauss–Newton equations of Σ r² at one point: H δ = −g.

    Attributes:
        frames: (N, n, n) JᵀJ of each frame's own unknowns.
        border: (N, n, s) JᵀJ between a frame's and the shared unknowns.
        corner: (s, s) JᵀJ of the shared unknowns.
        frame_gradient: (N, n) Jᵀr of the frames.
        corner_gradient: (s,) Jᵀr of the shared unknowns.
        cost: Sum of squared residuals.
    """

    frames: Array
    border: Array
    corner: Array
    frame_gradient: Array
    corner_gradient: Array
    cost: float

    def schur_complement(self) -> Array:
        """(s, s) information of the shared unknowns once the frames are eliminated."""
        eliminated = np.linalg.solve(self.frames, self.border)
        return self.corner - np.einsum("tni,tnj->ij", self.border, eliminated, optimize=True)

    def step(self, damping: float) -> tuple[Array, Array]:
        """Damped step: (N, n) of the frames and (s,) of the shared unknowns (Marquardt's diagonal scaling)."""
        frames, corner = self.frames.copy(), self.corner.copy()
        diagonal = np.arange(frames.shape[1])
        frames[:, diagonal, diagonal] *= 1.0 + damping
        corner[np.diag_indices_from(corner)] *= 1.0 + damping
        count = self.border.shape[2]
        right = np.concatenate([self.border, self.frame_gradient[:, :, None]], axis=2)
        eliminated: Array = np.linalg.solve(frames, right)
        flat = self.border.reshape(frames.shape[0] * frames.shape[1], count)
        reduced = corner - flat.T @ eliminated[:, :, :-1].reshape(flat.shape)
        gradient = self.corner_gradient - flat.T @ eliminated[:, :, -1].reshape(-1)
        shared = np.asarray(np.linalg.solve(reduced, -gradient), dtype=np.float64) if count else np.zeros(0)
        return -eliminated[:, :, -1] - eliminated[:, :, :-1] @ shared, shared


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
    for iteration in range(1, max_iterations + 1):
        while True:
            own, shared = equations.step(damping)
            candidate = move(state, own, shared)
            gain = equations.cost - cost(candidate)
            if gain > 0:
                break
            damping, growth = damping * growth, growth * 2.0
            if damping > 1e10:
                return Solution(state, equations, iteration, True)
        before = equations.cost
        state, damping, growth = candidate, max(damping / 3.0, 1e-10), 2.0
        equations = linearise(state)
        if on_iteration is not None:
            on_iteration(iteration)
        if gain <= tolerance * before:
            return Solution(state, equations, iteration, True)
    return Solution(state, equations, max_iterations, False)
