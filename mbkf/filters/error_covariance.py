"""Error covariance of the dynamic filter, where skin repeats marker errors from frame to frame.

Its marker noise is wide, because a frame of skin-borne markers is no independent reading, and its plant as wide to
keep up; gains depend on their ratio, but P on their size. So P is not what the errors are like. They have two parts:

    what is new in every frame    κ P, κ the share of the marker noise that is new
    what skin repeats             C of positions and, moving about as ω, ω² C of velocities, ω⁴ C of accelerations

with C the covariance of a pose fitted to one frame whose markers err as much as the innovations show; a sine of
amplitude 1 has q, v and a of size 1, ω and −ω², the first and the last in opposition. Joints that nothing observes owe
their spread to neither, and wrenches theirs to plates: they keep what P states. The wrench of a foot that no plate
reads follows from the accelerations by Newton's law, and errs as they do. Of two such feet only the sum does; how they
share it is known by where they stand and how they push off, which errs alike for a whole double support:

    (c² − 1) κ [D, −D; −D, D] is added,  D = covariance of half the difference of both wrenches in P
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array


@dataclass(frozen=True)
class ErrorSettings:
    """How errors repeat. Set on synthetic captures with 3 to 5 mm of skin so that 95 % intervals cover 94 to 100 %.

    Attributes:
        new_share: Share κ of the marker noise that is new in every frame.
        skin_rate_rad_s: How fast the rest changes, ω.
        sharing_scale: Factor c on the spread of how two feet share a load that no plate reads.
    """

    new_share: float = 0.035
    skin_rate_rad_s: float = 4.0
    sharing_scale: float = 2.3


@dataclass(frozen=True)
class ErrorCovariance:
    """Errors of (q, v, a, w); their covariance Σ is positive semidefinite as P is.

    Attributes:
        P: (N, N) the filter's own covariance.
        information: (nv, nv) of one frame on the configuration, as the filter weighs it.
        seen: (n,) dofs that markers observe.
        skin: Variance of the markers over what the filter takes for it.
        new: Share κ of what the filter takes for it that is new in every frame.
        rate_rad_s: ω.
        free: Feet whose wrenches follow from Newton's law alone, 0 right and 1 left.
        sharing: Factor c where both do.
    """

    P: Array
    information: Array
    seen: NDArray[np.intp]
    skin: float
    new: float
    rate_rad_s: float
    free: tuple[int, ...] = ()
    sharing: float = 1.0

    @cached_property
    def size(self) -> Array:
        """(N,) by which errors of the filter's kind are smaller than P says, √κ."""
        nv, size = len(self.information), np.ones(len(self.P))
        for first in (0, nv, 2 * nv):
            size[first + self.seen] = self.new**0.5
        for foot in self.free:
            size[3 * nv + 6 * foot : 3 * nv + 6 * foot + 6] = self.new**0.5
        return size

    @cached_property
    def _difference(self) -> Array | None:
        """(6, 6) what is added to both feet's wrenches, and taken from between them; None for one foot or none."""
        if len(self.free) < 2 or self.sharing == 1.0:
            return None
        first = 3 * len(self.information)
        right, left = slice(first, first + 6), slice(first + 6, first + 12)
        between = self.P[right, left]
        half = 0.25 * (self.P[right, right] + self.P[left, left] - between - between.T)
        return np.asarray((self.sharing**2 - 1.0) * self.new * half)

    @cached_property
    def _root(self) -> Array:
        """(n, n) W with Wᵀ W the inverse of the information on the seen dofs."""
        seen, information = self.seen, self.information
        if len(seen) < len(information):
            information = information[seen[:, None], seen]
        if not len(seen):
            return information
        factor, failed = lapack.dpotrf(information.T, lower=1)
        if not failed:
            return lapack.dtrtri(factor, lower=1, overwrite_c=1)[0]
        values, vectors = np.linalg.eigh(information)
        if values[-1] <= 0.0:
            raise np.linalg.LinAlgError("a frame does not determine the joints that its markers observe")
        return (vectors / np.sqrt(np.maximum(values, 1e-13 * values[-1]))).T

    @property
    def repeated(self) -> Array:
        """(n, n) C of the seen dofs."""
        return self.skin * (self._root.T @ self._root)

    @cached_property
    def _repeated_variance(self) -> Array:
        return self.skin * np.einsum("ij,ij->j", self._root, self._root)

    @property
    def position(self) -> Array:
        """(nv, nv) block of Σ of the configuration."""
        nv, seen = len(self.information), self.seen
        size = self.size[:nv]
        block = self.P[:nv, :nv] * size
        block *= size[:, None]
        block[seen[:, None], seen] += self.repeated
        return block

    @property
    def position_variance(self) -> Array:
        """(nv,) diagonal of Σ of the configuration."""
        return self._variance(0, 1.0)

    @property
    def velocity_variance(self) -> Array:
        """(nv,) diagonal of Σ of the velocities."""
        return self._variance(len(self.information), self.rate_rad_s**2)

    def _variance(self, first: int, share: float) -> Array:
        mine = slice(first, first + len(self.information))
        found: Array = np.diagonal(self.P)[mine] * self.size[mine] ** 2
        found[self.seen] += share * self._repeated_variance
        return found

    def variance_of(self, T: Array) -> Array:
        """(m,) diagonal of T Σ Tᵀ for quantities T (m, n) of its first n components, without Σ."""
        nv, rate = len(self.information), self.rate_rad_s
        n = T.shape[1]
        sized = T * self.size[:n]
        variance: Array = np.einsum("ij,ij->i", sized @ self.P[:n, :n], sized)
        # Positions and accelerations swing in opposition, velocities between them.
        swing = T[:, :nv] - rate**2 * T[:, 2 * nv : 3 * nv]
        quarter = rate * T[:, nv : 2 * nv]
        parts = np.concatenate([swing, quarter])
        repeated = (parts[:, self.seen] if len(self.seen) < nv else parts) @ self._root.T
        squared = np.einsum("ij,ij->i", repeated, repeated)
        variance += self.skin * (squared[: len(T)] + squared[len(T) :])
        if self._difference is not None and n == 3 * nv + 12:
            apart = T[:, 3 * nv : 3 * nv + 6] - T[:, 3 * nv + 6 :]
            variance += np.einsum("ij,ij->i", apart @ self._difference, apart)
        return variance

    @property
    def wrench_variance(self) -> Array:
        """(12,) diagonal of Σ of both feet's wrenches."""
        mine = slice(3 * len(self.information), 3 * len(self.information) + 12)
        found: Array = np.diagonal(self.P)[mine] * self.size[mine] ** 2
        return found if self._difference is None else found + np.tile(np.diagonal(self._difference), 2)

    def covariance(self) -> Array:
        """(N, N) Σ."""
        nv, rate, C = len(self.information), self.rate_rad_s, self.repeated
        whole = self.P * self.size * self.size[:, None]
        rates = (1.0, rate, rate**2)
        for first, second, sign in ((0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (0, 2, -1.0), (2, 0, -1.0)):
            own = np.ix_(first * nv + self.seen, second * nv + self.seen)
            whole[own] += sign * rates[first] * rates[second] * C
        if self._difference is not None:
            wrenches = slice(3 * nv, 3 * nv + 12)
            whole[wrenches, wrenches] += np.kron([[1.0, -1.0], [-1.0, 1.0]], self._difference)
        return whole
