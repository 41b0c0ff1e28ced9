"""Degrees of freedom that markers determine: ranks of H and of the observability matrix (thesis eq. 4.14)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from mbkf.conventions import Array, read_only
from mbkf.errors import ShapeError
from mbkf.model.body import Body
from mbkf.model.clinical import dof_names
from mbkf.sensors.marker_sensor import MarkerSensor

RANK_TOLERANCE = 1e-6
"""Singular values below this share of the largest one count as zero."""

SHARE_THRESHOLD = 0.01
"""A dof is unobserved if more than this share of it lies in the null space."""

BENT_POSTURES = 4
_BEND_RAD = 0.35


@dataclass(frozen=True)
class Observability:
    """Observability of a body by markers in P postures, the first of them standing straight.

    Attributes:
        dofs: (nv,) names of the tangent dofs.
        ranks: (P,) rank of the marker Jacobian H; nv if every dof is determined.
        state_ranks: (P,) rank of [H; HF; HF²; …] for positions and velocities; 2 nv if it is full.
        unobserved_share: (P, nv) share of each dof in the null space of H: 0 fully seen, 1 unseen.
        sd: (P, nv) standard deviation that one frame leaves on each dof, rad (m for the pelvis's
            translations); infinite for an undetermined dof.
    """

    dofs: tuple[str, ...]
    ranks: NDArray[np.int64]
    state_ranks: NDArray[np.int64]
    unobserved_share: Array
    sd: Array

    @property
    def complete(self) -> bool:
        """True if positions and velocities of all dofs are determined in every posture."""
        nv = len(self.dofs)
        return bool((self.ranks == nv).all() and (self.state_ranks == 2 * nv).all())

    @property
    def typical_sd(self) -> Array:
        """(nv,) median of ``sd`` over the bent postures; infinite if most do not determine the dof."""
        return np.asarray(np.median(self.sd[1:], axis=0))

    @property
    def unobserved(self) -> tuple[str, ...]:
        """Dofs that no posture determines fully; each may still be seen in part (see ``unobserved_share``)."""
        return self._named(np.all(self.unobserved_share > SHARE_THRESHOLD, axis=0))

    @property
    def sometimes_unobserved(self) -> tuple[str, ...]:
        """Dofs that are determined in some postures only (a straight elbow hides the turn of the arm)."""
        hidden = self.unobserved_share > SHARE_THRESHOLD
        return self._named(np.any(hidden, axis=0) & ~np.all(hidden, axis=0))

    def _named(self, chosen: NDArray) -> tuple[str, ...]:
        return tuple(name for name, here in zip(self.dofs, chosen, strict=True) if here)


def numerical_rank(matrix: Array) -> int:
    """Rank of a matrix (m, n): number of singular values above the tolerance."""
    return int(np.linalg.matrix_rank(matrix, rtol=RANK_TOLERANCE))


def null_space(matrix: Array) -> Array:
    """(n, n − rank) orthonormal basis of the null space of a matrix (m, n)."""
    return np.asarray(scipy.linalg.null_space(matrix, rcond=RANK_TOLERANCE))


def observability_matrix(measurement: Array, plant: Array) -> Array:
    """[H; HF; HF²; …] (thesis eq. 4.14): at most n blocks, without those that are zero.

    Args:
        measurement: (m, n) H.
        plant: (n, n) F of ẋ = F x.

    Raises:
        ShapeError: F does not fit H.
    """
    n = measurement.shape[1]
    if plant.shape != (n, n):
        raise ShapeError("plant", f"({n}, {n})", plant.shape)
    blocks = [measurement]
    while len(blocks) < n:
        following = blocks[-1] @ plant
        if not following.any():
            break
        blocks.append(following)
    return np.vstack(blocks)


def kinematic_plant(nv: int) -> Array:
    """(2 nv, 2 nv) F of the kinematic filter: velocities move positions, nothing moves velocities."""
    plant = np.zeros((2 * nv, 2 * nv))
    plant[:nv, nv:] = np.eye(nv)
    return plant


def generic_postures(model: Body) -> Array:
    """(P, nq) postures: standing straight, then every dof bent by about 20° in fixed random ways.

    Bent postures show the observability in general; the straight one lacks some by symmetry.
    """
    rng, size = np.random.default_rng(18), (BENT_POSTURES, model.nv)
    bends = rng.uniform(0.5, 1.5, size) * rng.choice((-1.0, 1.0), size) * _BEND_RAD
    neutral = model.neutral()
    return np.array([neutral, *(model.integrate(neutral, bend) for bend in bends)])


def analyse(model: Body, segments: Sequence[str], local_m: Array, noise_m: Array) -> Observability:
    """Observability of a body by M markers in the postures of :func:`generic_postures`.

    Args:
        model: The body.
        segments: Segment of each marker.
        local_m: (M, 3) positions in the segments' frames, m.
        noise_m: (M,) measurement noise (1 sd), m.

    Raises:
        ShapeError: The arrays do not have one row per marker.
        UnknownName: A segment is unknown.
    """
    sensor = MarkerSensor(model, segments, local_m)
    if noise_m.shape != (len(sensor.segments),):
        raise ShapeError("noise_m", f"({len(sensor.segments)},)", noise_m.shape)
    plant = kinematic_plant(model.nv)
    ranks, state_ranks, shares, deviations = [], [], [], []
    for q in generic_postures(model):
        H = sensor.reading(q).jacobian
        rows = H.reshape(-1, model.nv)
        unobserved = null_space(rows)
        of_state = np.hstack([rows, np.zeros_like(rows)])
        ranks.append(model.nv - unobserved.shape[1])
        state_ranks.append(numerical_rank(observability_matrix(of_state, plant)))
        shares.append(np.sum(unobserved**2, axis=1))
        deviations.append(_one_frame_sd((H / noise_m[:, None, None]).reshape(-1, model.nv), shares[-1]))
    return Observability(
        dofs=dof_names(model),
        ranks=read_only(ranks, dtype=np.int64),
        state_ranks=read_only(state_ranks, dtype=np.int64),
        unobserved_share=read_only(shares),
        sd=read_only(deviations),
    )


def _one_frame_sd(weighted: Array, share: Array) -> Array:
    """(nv,) square root of the diagonal of (HᵀR⁻¹H)⁺; infinite for dofs with a share in the null space."""
    inverse = np.linalg.pinv(weighted, rcond=RANK_TOLERANCE)
    return np.where(share > SHARE_THRESHOLD, np.inf, np.linalg.norm(inverse, axis=1))
