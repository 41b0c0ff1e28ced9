"""Elimination of the frames from normal equations shaped as an arrow, without the products that are zero.

A frame's matrix H = L Lᵀ is factorised with its unknowns in reverse order: those of a tree's leaves come first, so L
hardly fills in (Featherstone 2005). A row of L⁻¹ [border, gradient] is non-zero only for shared unknowns that act
beyond its joint; the root's rows alone are full. The Schur complement is the sum of products of such rows over frames.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array, BoolArray

Indices = NDArray[np.intp]

MOST = 0.8
"""Share of non-zero columns beyond which picking them costs more than the zeros do."""


class Border(NamedTuple):
    """Terms between own and shared unknowns: those of s columns are b columns, each by a factor that frames have.

    Attributes:
        columns: (N, n, b) the columns.
        of: (s,) the column of each shared unknown.
        factors: (N, s) its factor; None where all are 1.
    """

    columns: Array
    of: Indices
    factors: Array | None = None

    @classmethod
    def plain(cls, terms: Array) -> Border:
        """Terms (N, n, s) of which each is a column by itself."""
        return cls(terms, np.arange(terms.shape[2]))

    @property
    def terms(self) -> Array:
        """(N, n, s) all terms."""
        return self.spread(self.columns, np.arange(len(self.of)))

    def spread(self, columns: Array, shared: Indices) -> Array:
        """(N, r, c) terms of some shared unknowns (c,), of rows (N, r, b) of all columns."""
        if self.factors is None and len(shared) == columns.shape[2]:
            return columns
        found = columns.take(self.of[shared], axis=2)
        if self.factors is not None:
            found *= self.factors[:, None, shared]
        return found

    @property
    def acting(self) -> BoolArray:
        """(n, s) True where a term is not zero in all frames."""
        found = (self.columns != 0.0).any(axis=0)[:, self.of]
        return np.asarray(found if self.factors is None else found & (self.factors != 0.0).any(axis=0))


class RowBlock(NamedTuple):
    """Neighbouring own unknowns whose rows of L⁻¹ border are non-zero in the same columns.

    Attributes:
        rows: Their numbers in reverse order.
        columns: (c,) shared unknowns with non-zero elements; all s where only a few are zero.
    """

    rows: slice
    columns: Indices


class Eliminated(NamedTuple):
    """Frames eliminated from an arrow.

    Attributes:
        inverses: (N, n, n) L⁻¹ of the frames, unknowns in reverse order.
        blocks: The blocks of rows.
        halves: (N, r, c) rows of L⁻¹ border of each block.
        gradient: (N, n) L⁻¹ g of the frames.
        complement: (s, s) Σ borderᵀ H⁻¹ border.
        pull: (s,) Σ borderᵀ H⁻¹ g.
    """

    inverses: Array
    blocks: list[RowBlock]
    halves: list[Array]
    gradient: Array
    complement: Array
    pull: Array

    def own_step(self, shared: Array) -> Array:
        """(N, n) H⁻¹ (border shared + g) of the frames, for a step (s,) of the shared unknowns."""
        rows = self.gradient.copy()
        for block, half in zip(self.blocks, self.halves, strict=True):
            rows[:, block.rows] += half @ shared[block.columns]
        back = (self.inverses.swapaxes(1, 2) @ rows[:, :, None])[:, :, 0]
        return np.ascontiguousarray(back[:, ::-1])


def eliminate(frames: Array, border: Border, frame_gradient: Array, blocks: list[RowBlock]) -> Eliminated:
    """Eliminates the frames.

    Args:
        frames: (N, n, n) matrices, positive definite.
        border: Terms between own and shared unknowns.
        frame_gradient: (N, n) gradient.
        blocks: What :func:`row_blocks` found for the frames and the border.

    Raises:
        numpy.linalg.LinAlgError: A frame's matrix is not positive definite, or not finite.
    """
    roots = np.linalg.cholesky(np.ascontiguousarray(frames[:, ::-1, ::-1]))
    inverses = np.array([lapack.dtrtri(root.T)[0].T for root in roots])
    gradient = (inverses @ frame_gradient[:, ::-1, None])[:, :, 0]
    every, size = np.ascontiguousarray(inverses[:, :, ::-1]) @ border.columns, len(border.of)
    complement, pull, halves = np.zeros((size, size)), np.zeros(size), []
    for rows, columns in blocks:
        half = border.spread(every[:, rows], columns)
        flat = half.reshape(-1, len(columns))
        pull[columns] += gradient[:, rows].reshape(-1) @ flat
        if len(columns) == size:
            complement += flat.T @ flat
        else:
            complement[columns[:, None], columns] += flat.T @ flat
        halves.append(half)
    return Eliminated(inverses, blocks, halves, gradient, complement, pull)


def row_blocks(frames: Array, border: Border) -> list[RowBlock]:
    """Blocks of rows of L⁻¹ border that are non-zero in the same columns.

    Args:
        frames: (N, n, n) matrices of the frames.
        border: Terms between own and shared unknowns.
    """
    matrix, acting = (frames != 0.0).any(axis=0), border.acting
    return list(_blocks(matrix.tobytes(), acting.tobytes(), *acting.shape))


@lru_cache(maxsize=32)
def _blocks(matrix: bytes, acting: bytes, own: int, shared: int) -> tuple[RowBlock, ...]:
    """The blocks by the patterns (n, n) of the frames and (n, s) of the border, the same in most steps of a search."""
    inverse = _inverse_pattern(np.frombuffer(matrix, dtype=bool).reshape(own, own)[::-1, ::-1])
    pattern = inverse @ np.frombuffer(acting, dtype=bool).reshape(own, shared)[::-1]
    starts = np.flatnonzero(np.append(True, (pattern[1:] != pattern[:-1]).any(axis=1)))
    blocks = []
    for start, end in zip(starts, [*starts[1:], len(pattern)], strict=True):
        columns = np.flatnonzero(pattern[start])
        if len(columns) > MOST * shared:
            columns = np.arange(shared)
        if len(columns):
            blocks.append(RowBlock(slice(int(start), int(end)), columns))
    return tuple(blocks)


def _inverse_pattern(matrix: BoolArray) -> BoolArray:
    """(n, n) elements of L⁻¹ that may be non-zero, for a symmetric pattern (n, n) of L Lᵀ."""
    filled, inverse = matrix.copy(), np.eye(len(matrix), dtype=bool)
    for i in range(len(matrix)):
        below = i + 1 + np.flatnonzero(filled[i + 1 :, i])
        filled[below[:, None], below] = True
        inverse[below] |= inverse[i]
    return inverse
