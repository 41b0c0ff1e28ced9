"""Directions of a covariance's root in which nearly all of its variance lies (principal components).

With rows X (m, c) of a root, the eigenvectors of Xᵀ X are the directions, and its eigenvalues the variance along them.
Where there are fewer rows than columns those of X Xᵀ, which is smaller, give them: Xᵀ u / √λ.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array

RANK = 1e-12
"""Share of the largest variance below which a direction has none but rounding's."""

TINY = np.finfo(float).tiny

LEAST_ROW = 1e-9
"""Share of the longest row below which a row has no length but rounding's."""


def principal_directions(rows: Array, share: float) -> Array:
    """(c, n) orthonormal directions, those of the greatest variance first; one at least, 0 where nothing varies.

    Args:
        rows: (m, c) rows of a root, m > 0.
        share: Share of the summed variance that they hold together.
    """
    few = len(rows) < rows.shape[1]
    squares, vectors = np.linalg.eigh(rows @ rows.T if few else rows.T @ rows)
    squares, vectors = np.maximum(squares[::-1], 0.0), vectors[:, ::-1]
    held = np.cumsum(squares)
    kept = 1 + int(np.searchsorted(held, share * held[-1]))
    kept = min(kept, max(1, int(np.count_nonzero(squares > RANK * squares[0]))))
    if not few:
        return np.asarray(vectors[:, :kept])
    return np.asarray(rows.T @ (vectors[:, :kept] / np.sqrt(np.maximum(squares[:kept], TINY))))


def of_unit_length(rows: Array) -> Array:
    """Rows (m, c) scaled to length 1, so that each quantity counts alike; rows of no length are left out."""
    size = np.linalg.norm(rows, axis=1)
    known = size > LEAST_ROW * size.max(initial=0.0)
    return np.asarray(rows[known] / size[known, None])
