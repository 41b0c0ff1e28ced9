"""Uncertainty that scaling leaves in a person's body: the covariance of scale factors, marker places and skin."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import ShapeError
from mbkf.io import fields
from mbkf.io.packed_triangle import packed, unpacked
from mbkf.io.toml import Entries

MOST_SPREAD = 2.0
"""Largest standard deviation of a scale factor, and of a marker's place in m."""

LARGEST_SD = 1e3
"""Bound of a number that is taken for a standard deviation at all."""

DIGITS = 6
"""Significant digits of a number in a subject file."""


class CovarianceTable(TypedDict):
    """The table ``[covariance]`` of a subject file: names, standard deviations, and L's lower triangle over them."""

    factors: list[str]
    markers: list[str]
    centres: list[str]
    flexions: int
    sd: list[float]
    packed_root: str


@dataclass(frozen=True)
class BodyCovariance:
    """Covariance Σ = L Lᵀ of scale factors, of places of markers in their segments, and of displacements by flexion.

    There are K factors, E displacements of joint centres (:mod:`mbkf.model.joint_centres`), M markers, and D flexions
    that displace a marker (:mod:`mbkf.sensors.flexed_skin`), in this order.

    Attributes:
        factors: (K,) names of the scale factors.
        markers: (M,) names of the markers.
        root: (s, s) L, lower triangular, s = K + E + 3 M (1 + D); rows of factors are pure numbers, the others m.
        flexions: D; 0 where scaling learnt nothing of the skin.
        centres: (E,) names of the displacements of joint centres.
    """

    factors: tuple[str, ...]
    markers: tuple[str, ...]
    root: Array
    flexions: int = 0
    centres: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Raises: ShapeError: the root does not have the size of the names' parameters."""
        size = self.sizes + 3 * len(self.markers) * (1 + self.flexions)
        object.__setattr__(self, "root", read_only(self.root))
        if self.root.shape != (size, size):
            raise ShapeError("root", f"({size}, {size})", self.root.shape)

    @property
    def sizes(self) -> int:
        """K + E: number of rows before those of the markers."""
        return len(self.factors) + len(self.centres)

    @classmethod
    def of(
        cls,
        factors: tuple[str, ...],
        markers: tuple[str, ...],
        covariance: Array,
        flexions: int = 0,
        centres: tuple[str, ...] = (),
    ) -> BodyCovariance:
        """From Σ itself, which may be singular.

        Args:
            factors: (K,) names of the scale factors.
            markers: (M,) names of the markers.
            covariance: (s, s) Σ.
            flexions: D.
            centres: (E,) names of the displacements of joint centres.
        """
        covariance = 0.5 * (covariance + covariance.T)
        with suppress(np.linalg.LinAlgError):
            root = np.asarray(np.linalg.cholesky(covariance))
            return cls(factors, markers, root, flexions, centres)
        values, vectors = np.linalg.eigh(covariance)
        wide = vectors * np.sqrt(np.maximum(values, 0.0))
        lower = np.asarray(np.linalg.qr(wide.T, mode="r")).T
        return cls(factors, markers, lower * np.where(np.diag(lower) < 0.0, -1.0, 1.0), flexions, centres)

    @property
    def covariance(self) -> Array:
        """(s, s) Σ."""
        return self.root @ self.root.T

    def rows(self, markers: Sequence[str], unseen_sd_m: Mapping[str, float], skin: Array) -> Array:
        """(K + E + 3 n (1 + D), r) a root of the covariance of sizes, places of n markers and their displacements.

        Args:
            markers: (n,) their names.
            unseen_sd_m: Standard deviation of the place of a marker that scaling did not see, per coordinate, m.
            skin: (D, 3 n, 3 n) prior covariance of the displacements by each flexion, m², for markers whose own
                displacements scaling did not learn.
        """
        count, known = self.sizes, {name: n for n, name in enumerate(self.markers)}
        unseen = [name for name in markers if name not in known]
        places, width = 3 * len(markers), len(self.root)
        rows = np.zeros((count + places * (1 + len(skin)), width + 3 * len(unseen) + places * len(skin)))
        rows[:count, :width] = self.root[:count]
        learnt = [name in known and self.flexions == len(skin) for name in markers]
        for n, name in enumerate(markers):
            if name in known:
                of_marker = count + 3 * known[name] + 3 * len(self.markers) * np.arange(1 + self.flexions)
                for d, first in enumerate(of_marker[: 1 + len(skin) * learnt[n]]):
                    mine = count + d * places + 3 * n
                    rows[mine : mine + 3, :width] = self.root[first : first + 3]
            else:
                mine, first = count + 3 * n, width + 3 * unseen.index(name)
                rows[mine : mine + 3, first : first + 3] = unseen_sd_m[name] * np.eye(3)
        new = np.repeat(np.logical_not(learnt), 3)
        apart = rows[count + places :, width + 3 * len(unseen) :]
        for d, covariance in enumerate(skin):
            own = slice(d * places, (d + 1) * places)
            apart[own, own] = new[:, None] * np.linalg.cholesky(covariance)
        return rows

    def as_table(self) -> CovarianceTable:
        """The table of a subject file: names, standard deviations, and L packed."""
        return CovarianceTable(
            factors=list(self.factors),
            markers=list(self.markers),
            centres=list(self.centres),
            flexions=self.flexions,
            sd=[float(f"{x:.{DIGITS}g}") for x in np.linalg.norm(self.root, axis=1)],
            packed_root=packed(self.root),
        )


def read_covariance(read: Entries) -> BodyCovariance:
    """The record of a table that :meth:`BodyCovariance.as_table` made.

    Raises:
        FileFormatError: An entry is missing, the text is damaged, row n does not have n + 1 finite numbers, or no
            person varies so much.
        ShapeError: The number of rows is not that of the names' parameters.
    """
    root = _read_root(read)
    flexions = int(read.get(_FLEXIONS) or 0)
    found = BodyCovariance(read.need(_FACTORS), read.need(_MARKERS), root, flexions, read.get(_CENTRES) or ())
    spreads = np.sqrt((root * root).sum(axis=1))
    if spreads.size and spreads.max() > MOST_SPREAD:
        k, names = (
            int(spreads.argmax()),
            [*found.factors, *found.centres, *np.tile(np.repeat(found.markers, 3), 1 + found.flexions)],
        )
        reason = f"the standard deviation of {names[k]} is {spreads[k]:.3g}, more than {MOST_SPREAD:g}"
        raise read.fault(reason, _SD.key if _SD.key in read.table else _ROOT.key)
    return found


def _read_root(read: Entries) -> Array:
    """(s, s) L, packed or, as older versions wrote it, row by row.

    Raises:
        FileFormatError: It is missing or damaged.
    """
    text = read.get(_PACKED)
    if text is not None:
        sd = read.need(_SD)
        root = unpacked(text, sd)
        if root is None:
            reason = f"{_PACKED.key} is damaged, or not of {len(sd)} rows as sd has; scale the person again"
            raise read.fault(reason, _PACKED.key)
        return root
    rows = read.get(_ROOT)
    if rows is None:
        raise read.fault(f"{_PACKED.key} is missing; scale the person again, or take the table out")
    root = np.zeros((len(rows), len(rows)))
    for n, row in enumerate(rows):
        root[n, : n + 1] = row
    return root


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
_CENTRES = fields.texts("centres", "names of the displacements of joint centres")
_FLEXIONS = fields.number("flexions", "number of flexions whose displacements are learnt", (0.0, 8.0))
_SD = fields.numbers(
    "sd", "standard deviations of factors, joint centres (m), places and displacements (m)", None, LARGEST_SD
)
_PACKED = fields.text("packed_root", "L, whose square L Lᵀ is the covariance, packed", empty=True)
_ROOT = fields.Field(
    "root", "L of older files, row by row", "rows, the n-th of n finite numbers", _triangle, False
)
COVARIANCE = fields.record("covariance", _FACTORS, _MARKERS, _CENTRES, _FLEXIONS, _SD, _PACKED, _ROOT)
"""Entries of the covariance in a subject file."""
