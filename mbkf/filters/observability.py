"""Observability of a filter's whole state: rank of [H; HF; HF²; …] (thesis eq. 4.14) in units that make it safe.

Rows are readings in units of their noise, columns are components of the state in typical sizes D, and time counts in τ:

    O_k = R^(-1/2) H (τF)^k D / k!

is the k-th term of the change of the readings after the time τ, when the state changes by one typical size at its
beginning. A singular value of all of them is thus a number of standard deviations, and a direction counts as observed
from :data:`OBSERVED_SD` on. Four blocks show positions, velocities and forces; further ones are added while the rank
grows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import ShapeError
from mbkf.filters.readings import Readings
from mbkf.model.body import Body
from mbkf.model.clinical import dof_names
from mbkf.model.layout import WRENCH, Layout
from mbkf.sensors.observability import RANK_TOLERANCE

OBSERVED_SD = 0.01
"""A direction is observed if one typical size along it changes the readings of a window by this many standard
deviations. Ten thousand windows would have to be averaged to see less. Exact null directions reach 1e-12.
"""

LEAST_BLOCKS = 4

WINDOW_S = 0.1
"""Time τ over which a change of the state has to show in the readings."""

SIZES = {"q": 0.1, "v": 1.0, "a": 10.0, "u": 10.0}
"""Typical size of a component: rad or m, its rates, N m."""

FORCE_N, MOMENT_NM = 100.0, 10.0
"""Typical size of a force and of a moment at the feet and at the root."""

_PARTS = {"q": "position", "v": "velocity", "a": "acceleration"}
_OF_WRENCH = [f"{kind} {axis}" for kind in ("force", "moment") for axis in "xyz"]
_WRENCH_SIZES = [FORCE_N] * 3 + [MOMENT_NM] * 3


class Component(NamedTuple):
    """A component of the tangent state.

    Attributes:
        part: Kind of quantity: "position", "velocity", "acceleration", "torque", "pelvis residual", "right foot" …
        name: Its dof, or "force x" … "moment z".
        size: Typical size, in its SI unit.
    """

    part: str
    name: str
    size: float


def components(layout: Layout, model: Body, torques: str = "torque") -> tuple[Component, ...]:
    """The (N,) components of a state, in order.

    Torques of the first six dofs are the residual at the root. A joint whose acceleration is prescribed (the toes) has
    no torque in the state.

    Args:
        layout: Slices of the tangent state.
        model: The body.
        torques: Part that the torques are listed as.
    """
    dofs = dof_names(model)
    toes = {i for name in model.roles.toes for i in _indices(model.joint(name).v)}
    found: dict[int, Component] = {}
    for key, own in layout.slices.items():
        if key == WRENCH:
            foot = own.start
            for side in ("right foot", "left foot"):
                for k, (name, size) in enumerate(zip(_OF_WRENCH, _WRENCH_SIZES, strict=True)):
                    found[foot + k] = Component(side, name, size)
                foot += len(_OF_WRENCH)
        elif key == "u":
            root = model.root.segment
            for k, (name, size) in enumerate(zip(_OF_WRENCH, _WRENCH_SIZES, strict=True)):
                found[own.start + k] = Component(f"{root} residual", name, size)
            moved = [i for i in range(len(_OF_WRENCH), model.nv) if i not in toes]
            for k, i in enumerate(moved, own.start + len(_OF_WRENCH)):
                found[k] = Component(torques, dofs[i], SIZES[key])
        elif key in _PARTS:
            for k, name in enumerate(dofs):
                found[own.start + k] = Component(_PARTS[key], name, SIZES[key])
    for extra in layout.extras:
        first, sizes = layout[extra.name].start, np.asarray(extra.start_sd, dtype=float)
        names = _OF_WRENCH if len(sizes) == len(_OF_WRENCH) else [str(k + 1) for k in range(len(sizes))]
        for k, (name, size) in enumerate(zip(names, sizes, strict=True)):
            found[first + k] = Component(extra.name, name, float(size))
    return tuple(found[i] for i in range(layout.size))


def _indices(own: slice) -> range:
    return range(own.start, own.stop)


@dataclass(frozen=True)
class StateObservability:
    """Observability of a state of N components at one operating point.

    Attributes:
        reading_rank: Rank of H alone.
        blocks: Number of blocks H F^k that are stacked.
        singular_values: (N,) of the stacked rows, falling: by how many standard deviations all readings together change
            over 0.1 s for one typical size along the direction.
        directions: (N, N) directions that belong to them, one a row, orthonormal in typical sizes.
    """

    reading_rank: int
    blocks: int
    singular_values: Array
    directions: Array

    @cached_property
    def rank(self) -> int:
        """Rank of [H; HF; HF²; …]."""
        return _rank(self.singular_values)

    @property
    def gap(self) -> tuple[float, float]:
        """Least singular value that counts and greatest that does not; NaN where all or 0 of them count."""
        values, rank = self.singular_values, self.rank
        counted = float(values[rank - 1]) if rank else np.nan
        return counted, float(values[rank]) if rank < len(values) else np.nan

    @property
    def unobserved_share(self) -> Array:
        """(N,) share of each component in the directions that leave every reading as it is: 0 seen, 1 unseen."""
        return np.asarray(np.sum(self.directions[self.rank :] ** 2, axis=0))


def whitened(readings: Readings, sizes: Array, *, priors: bool = False) -> Array:
    """(k, N) R^(-1/2) H D of a frame's readings.

    Args:
        readings: A frame's readings.
        sizes: (N,) D.
        priors: Priors count, too, else instruments and laws alone.
    """
    if priors:
        return _root(readings.whole_matrix, sizes)
    known = readings.instruments.matrix
    rows = np.zeros((0, len(sizes)))
    if known.any():
        own = _root(known, sizes[: len(known)])
        rows = np.hstack([own, np.zeros((len(own), len(sizes) - len(known)))])
    return np.vstack([rows, readings.counted[0] * sizes])


def _root(information: Array, sizes: Array) -> Array:
    """(k, n) rows A with AᵀA = D Λ D, as many as the rank of Λ (n, n)."""
    values, vectors = np.linalg.eigh(information * np.outer(sizes, sizes))
    kept = values > RANK_TOLERANCE**2 * values[-1]
    return np.asarray(np.sqrt(values[kept])[:, None] * vectors[:, kept].T)


def state_observability(rows: Array, F: Array, sizes: Array) -> StateObservability:
    """Observability of a state.

    Args:
        rows: (k, N) whitened readings in typical sizes (:func:`whitened`).
        F: (N, N) of the error's rate δẋ = F δx, 1/s.
        sizes: (N,) typical sizes.

    Raises:
        ShapeError: F or the sizes do not fit the rows.
    """
    n = rows.shape[1]
    if F.shape != (n, n):
        raise ShapeError("F", f"({n}, {n})", F.shape)
    if sizes.shape != (n,):
        raise ShapeError("sizes", f"({n},)", sizes.shape)
    scaled = WINDOW_S * F * sizes / sizes[:, None]
    first = _rank(np.linalg.svd(rows, compute_uv=False))
    stacked, rank = [rows], first
    for k in range(1, n):
        stacked.append(stacked[-1] @ scaled / k)
        if k + 1 < LEAST_BLOCKS:
            continue
        before, rank = rank, _rank(np.linalg.svd(np.vstack(stacked), compute_uv=False))
        if rank <= before:
            break
    return StateObservability(first, len(stacked), *_singular(np.vstack(stacked)))


def _singular(rows: Array) -> tuple[Array, Array]:
    """Singular values (n,), falling, and right singular vectors (n, n) of rows (k, n)."""
    n = rows.shape[1]
    _, values, directions = np.linalg.svd(np.vstack([rows, np.zeros((max(n - len(rows), 0), n))]))
    return values, directions


def _rank(values: NDArray[np.floating]) -> int:
    return int(np.count_nonzero(values > OBSERVED_SD))
