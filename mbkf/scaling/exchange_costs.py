"""Costs of a standing frame under exchanged names, with the body fitted anew to each in one Gauss–Newton step.

At a state the cost of scaling is rᵀr and a prior, both quadratic: with A its matrix, g its gradient and J the markers'
derivatives, an exchange that changes the whitened errors by d costs

    c + 2 rᵀd + dᵀd − |L⁻¹ (g + Jᵀd)|²,   A = L Lᵀ

so that thousands of exchanges take milliseconds. For a set of pairs of which no two share a marker, d is the sum of the
pairs' own, and the cost a quadratic function of which pairs are exchanged.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular

from mbkf.conventions import Array
from mbkf.numerics.elimination import Indices
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingState

IMPROVES = 1e-6
"""Least decrease of the cost for which a set of pairs is changed."""

MOST_CHANGES = 4
"""Greatest number of changes of a set, for each of its pairs."""


class ExchangeCosts:
    """Costs of exchanges at one state of a problem of one frame."""

    def __init__(self, problem: ScalingProblem, state: ScalingState) -> None:
        """The equations at the state.

        Args:
            problem: A problem of one frame.
            state: The state.
        """
        shown, found = problem.shown(state), problem.linearise(state)
        count = len(problem.markers)
        axes = np.zeros((count, 3, 3 * count))
        for m in range(count):
            axes[m, :, 3 * m : 3 * m + 3] = shown.axes[0, m]
        self._jacobian = np.concatenate([shown.by_pose[0], shown.by_factors[0], axes], axis=2).reshape(
            3 * count, -1
        )
        border = found.border.terms[0]
        matrix = np.block([[found.frames[0], border], [border.T, found.corner]])
        self._root = np.linalg.cholesky(matrix)
        gradient = np.concatenate([found.frame_gradient[0], found.corner_gradient])
        self._errors = shown.errors[0].ravel()
        self._pull = solve_triangular(self._root, gradient, lower=True)
        self._measured = np.nan_to_num(problem.measured_m[0])
        self._per_noise = np.where(problem.seen[0], 1.0 / problem.noise_m, 0.0)[:, None]

    def changes(self, orders: Indices) -> Array:
        """(n,) change of the cost with the names in other orders.

        Args:
            orders: (n, M) number of the trajectory that each marker gets; only seen ones change.
        """
        moved = (self._measured - self._measured[orders]) * self._per_noise
        change = moved.reshape(len(orders), len(self._errors))
        eased = self._eased(change) + self._pull
        return np.asarray(
            2.0 * change @ self._errors
            + (change**2).sum(axis=1)
            - (eased**2).sum(axis=1)
            + self._pull @ self._pull
        )

    def likeliest_sets(self, pairs: Sequence[tuple[int, int]], starts: Sequence[Indices]) -> list[Indices]:
        """Orders (M,) with sets of pairs exchanged that no change of one or two pairs betters, the best first.

        Args:
            pairs: Pairs of markers, no marker in two of them.
            starts: Orders to start from; of each only the given pairs count.
        """
        count = len(self._measured)
        change = np.zeros((len(pairs), count, 3))
        for p, (a, b) in enumerate(pairs):
            change[p, a] = (self._measured[a] - self._measured[b]) * self._per_noise[a]
            change[p, b] = (self._measured[b] - self._measured[a]) * self._per_noise[b]
        flat = change.reshape(len(pairs), 3 * count)
        eased = self._eased(flat)
        linear = 2.0 * (flat @ self._errors - eased @ self._pull)
        square = flat @ flat.T - eased @ eased.T
        found: dict[bytes, tuple[float, Indices]] = {}
        for start in starts:
            chosen = _bettered(np.array([start[a] == b for a, b in pairs], dtype=np.float64), linear, square)
            order = np.arange(count)
            for (a, b), exchanged in zip(pairs, chosen, strict=True):
                if exchanged:
                    order[a], order[b] = b, a
            found[order.tobytes()] = (float(linear @ chosen + chosen @ square @ chosen), order)
        return [order for _, order in sorted(found.values(), key=lambda one: one[0])]

    def _eased(self, change: Array) -> Array:
        """(n, s) L⁻¹ Jᵀ d of changes (n, 3 M)."""
        return np.asarray(solve_triangular(self._root, (change @ self._jacobian).T, lower=True).T)


def _bettered(chosen: Array, linear: Array, square: Array) -> Array:
    """Choice (n,) of zeros and ones changed, one or two at a time, while linearᵀ s + sᵀ square s falls."""
    for _ in range(MOST_CHANGES * len(chosen)):
        turn = 1.0 - 2.0 * chosen
        one = turn * (linear + 2.0 * square @ chosen) + np.diag(square)
        two = one[:, None] + one + 2.0 * square * np.outer(turn, turn)
        np.fill_diagonal(two, one)
        i, j = np.unravel_index(int(two.argmin()), two.shape)
        if two[i, j] > -IMPROVES:
            break
        chosen[[i, j]] = 1.0 - chosen[[i, j]]
    return chosen
