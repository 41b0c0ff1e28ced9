"""All that a frame's blocks say, added up: Λ = Σ HᵀR⁻¹H and λ = Σ HᵀR⁻¹y, and what of it NIS counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.layout import Layout
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import AnyBlock, Rows, Statement


class Readings(NamedTuple):
    """A frame's readings linearised at a state: information on its first components, and whitened rows.

    Attributes:
        instruments: Information of instruments and laws alone.
        matrix: (n, n) information on the first n components, priors included.
        vector: (n,) its vector.
        rows: (k, N) R^(-1/2) H of all else.
        values: (k,) their innovations R^(-1/2) y.
        parts: The rows as their blocks gave them.
        added: (N,) Hᵀ R⁻¹ y of rows whose block gave it, None for none; their ``values`` are 0.
    """

    instruments: Information
    matrix: Array
    vector: Array
    rows: Array
    values: Array
    parts: Sequence[Sequence[Rows]]
    added: Array | None = None

    @property
    def whole_matrix(self) -> Array:
        """(N, N) Hᵀ R⁻¹ H of all readings."""
        total = self.rows.T @ self.rows
        n = len(self.vector)
        total[:n, :n] += self.matrix
        return total

    @property
    def whole_vector(self) -> Array:
        """(N,) Hᵀ R⁻¹ y of all readings."""
        total = self.values @ self.rows if len(self.values) else np.zeros(self.rows.shape[1])
        total[: len(self.vector)] += self.vector
        return total if self.added is None else total + self.added

    @property
    def counted(self) -> tuple[Array, Array]:
        """(m, N) rows and (m,) innovations of instruments and laws: those that NIS and likelihood count."""
        kept: list[int] = []
        first = 0
        for part in (one for parts in self.parts for one in parts):
            kept += range(first, first + part.readings)
            first += len(part.innovation)
        return self.rows[kept], self.values[kept]


def summed(blocks: Sequence[AnyBlock], said: Sequence[Statement], layout: Layout) -> Readings:
    """All statements of a frame together: information of instruments first, then of priors, then rows in order.

    Args:
        blocks: The blocks.
        said: What each of them says.
        layout: Slices of the tangent state.
    """
    known: list[Information] = []
    priors: list[Information] = []
    parts: list[Sequence[Rows]] = []
    for block, one in zip(blocks, said, strict=True):
        kind = type(one)
        if kind is Information:
            (priors if block.prior else known).append(one)  # type: ignore[arg-type]
            parts.append(())
        elif one is None:
            parts.append(())
        else:
            parts.append((one,) if kind is Rows else one)  # type: ignore[arg-type]
    instruments = _sum(known, layout.nv)
    matrix, vector = instruments.matrix, instruments.vector
    if priors:
        prior = _sum(priors, layout.nv)
        matrix, vector = _added(matrix, vector, prior)
    rows, values, added = _stacked(parts, layout.size)
    return Readings(instruments, matrix, vector, rows, values, parts, added)


def _stacked(parts: Sequence[Sequence[Rows]], size: int) -> tuple[Array, Array, Array | None]:
    """(k, N) rows on the whole state, (k,) innovations, and what :attr:`Readings.added` says."""
    flat = [one for part in parts for one in part]
    if not flat:
        return np.zeros((0, size)), np.zeros(0), None
    total = sum([len(one.innovation) for one in flat])
    rows, values, at = np.zeros((total, size)), np.empty(total), 0
    added: Array | None = None
    for jacobian, innovation, first, _, vector in flat:
        end = at + len(innovation)
        rows[at:end, first : first + jacobian.shape[1]] = jacobian
        if vector is None:
            values[at:end] = innovation
        else:
            values[at:end] = 0.0
            added = np.zeros(size) if added is None else added
            added[first : first + len(vector)] += vector
        at = end
    return rows, values, added


def _sum(parts: Sequence[Information], nv: int) -> Information:
    """All of them, on as many components as the longest; nothing about the first ``nv`` where there are none."""
    if not parts:
        return Information(np.zeros((nv, nv)), np.zeros(nv), 0.0, 0)
    total = parts[0]
    for one in parts[1:]:
        matrix, vector = _added(total.matrix, total.vector, one)
        total = Information(matrix, vector, total.innovation + one.innovation, total.readings + one.readings)
    return total


def _added(matrix: Array, vector: Array, other: Information) -> tuple[Array, Array]:
    """New arrays: a matrix (n, n) and vector (n,) with another information, on as many components as the longer."""
    n, m = len(vector), len(other.vector)
    if n == m:
        return matrix + other.matrix, vector + other.vector
    larger, longer = np.zeros((max(n, m), max(n, m))), np.zeros(max(n, m))
    larger[:n, :n], longer[:n] = matrix, vector
    larger[:m, :m] += other.matrix
    longer[:m] += other.vector
    return larger, longer
