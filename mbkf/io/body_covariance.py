"""Uncertainty that scaling leaves in a person's body: the covariance of scale factors and marker places."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import ShapeError
from mbkf.io import fields
from mbkf.io.toml import Entries

MOST_SPREAD = 2.0
"""Largest standard deviation of a scale factor, and of a marker's place in m."""

DIGITS = 6
"""Significant digits of a number in a subject file."""


class CovarianceTable(TypedDict):
    """The table ``[covariance]`` of a subject file: names, and the rows of L's lower triangle."""

    factors: list[str]
    markers: list[str]
    root: list[list[float]]


@dataclass(frozen=True)
class BodyCovariance:
    """Covariance Σ = L Lᵀ of p, the K scale factors and then the places of M markers in their segments' frames.

    Attributes:
        factors: (K,) names of the scale factors.
        markers: (M,) names of the markers.
        root: (K + 3 M, K + 3 M) L, lower triangular; rows of factors are pure numbers, of markers m.
    """

    factors: tuple[str, ...]
    markers: tuple[str, ...]
    root: Array

    def __post_init__(self) -> None:
        """Raises: ShapeError: the root does not have the size of the names' parameters."""
        size = len(self.factors) + 3 * len(self.markers)
        object.__setattr__(self, "root", read_only(self.root))
        if self.root.shape != (size, size):
            raise ShapeError("root", f"({size}, {size})", self.root.shape)

    @classmethod
    def of(cls, factors: tuple[str, ...], markers: tuple[str, ...], covariance: Array) -> BodyCovariance:
        """From Σ itself, which may be singular.

        Args:
            factors: (K,) names of the scale factors.
            markers: (M,) names of the markers.
            covariance: (K + 3 M, K + 3 M) Σ.
        """
        values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
        wide = vectors * np.sqrt(np.maximum(values, 0.0))
        lower = np.asarray(np.linalg.qr(wide.T, mode="r")).T
        return cls(factors, markers, lower * np.where(np.diag(lower) < 0.0, -1.0, 1.0))

    @property
    def covariance(self) -> Array:
        """(K + 3 M, K + 3 M) Σ."""
        return self.root @ self.root.T

    def rows(self, markers: Sequence[str], unseen_sd_m: Mapping[str, float]) -> Array:
        """(K + 3 n, r) a root of the covariance of factors and the places of n markers.

        Args:
            markers: (n,) their names.
            unseen_sd_m: Standard deviation of the place of a marker that scaling did not see, per coordinate, m.
        """
        count, known = len(self.factors), {name: n for n, name in enumerate(self.markers)}
        unseen = [name for name in markers if name not in known]
        rows = np.zeros((count + 3 * len(markers), len(self.root) + 3 * len(unseen)))
        width = len(self.root)
        rows[:count, :width] = self.root[:count]
        for n, name in enumerate(markers):
            mine = slice(count + 3 * n, count + 3 * n + 3)
            if name in known:
                first = count + 3 * known[name]
                rows[mine, :width] = self.root[first : first + 3]
            else:
                first = width + 3 * unseen.index(name)
                rows[mine, first : first + 3] = unseen_sd_m[name] * np.eye(3)
        return rows

    def as_table(self) -> CovarianceTable:
        """The table of a subject file: names, and the lower triangle row by row."""
        rows = [[float(f"{x:.{DIGITS}g}") for x in row[: n + 1]] for n, row in enumerate(self.root)]
        return CovarianceTable(factors=list(self.factors), markers=list(self.markers), root=rows)


def read_covariance(read: Entries) -> BodyCovariance:
    """The record of a table that :meth:`BodyCovariance.as_table` made.

    Raises:
        FileFormatError: An entry is missing, row n does not have n + 1 finite numbers, or no person varies so much.
        ShapeError: The number of rows is not that of the names' parameters.
    """
    rows = read.need(_ROOT)
    root = np.zeros((len(rows), len(rows)))
    for n, row in enumerate(rows):
        root[n, : n + 1] = row
    found = BodyCovariance(read.need(_FACTORS), read.need(_MARKERS), root)
    spreads = np.sqrt((root * root).sum(axis=1))
    if spreads.size and spreads.max() > MOST_SPREAD:
        k, names = int(spreads.argmax()), [*found.factors, *np.repeat(found.markers, 3)]
        reason = f"the standard deviation of {names[k]} is {spreads[k]:.3g}, more than {MOST_SPREAD:g}"
        raise read.fault(reason, _ROOT.key)
    return found


def _triangle(value: object) -> list[list[float]] | None:
    """Rows of a lower triangle; None where they are not."""
    if not isinstance(value, list):
        return None
    for n, row in enumerate(value):
        if not isinstance(row, list) or len(row) != n + 1 or any(isinstance(x, bool) for x in row):
            return None
        if not all(isinstance(x, int | float) and math.isfinite(x) for x in row):
            return None
    return value


_FACTORS = fields.texts("factors", "names of the scale factors", required=True)
_MARKERS = fields.texts("markers", "names of the markers", required=True)
_ROOT = fields.Field(
    "root",
    "rows of L, whose square L Lᵀ is the covariance",
    "rows, the n-th of n finite numbers",
    _triangle,
    True,
)
COVARIANCE = fields.record("covariance", _FACTORS, _MARKERS, _ROOT)
"""Entries of the covariance in a subject file."""
