"""Error covariance of the dynamic filter, where skin repeats marker errors from frame to frame.

Its marker noise is wide, because frames of skin-borne markers are not independent readings, and its plant as wide to
keep up; gains depend on their ratio, but P on their size. So P is not the covariance of the errors. They have two
parts:

    new in every frame    K P K, κ = K² the share of the marker noise that is new
    repeated by skin      C of positions and, moving about as ω, ω² C of velocities, ω⁴ C of accelerations

with C the covariance of a pose fitted to one frame whose markers err as much as the innovations show; a sine of
amplitude 1 has q, v and a of size 1, ω and −ω², the first and the last in opposition. Joints that nothing observes owe
their spread to neither and keep what P states. κ is not the same for positions, velocities and accelerations, since
P's process noise is as wide as its marker noise, and later frames take away more of it.

The wrench of a foot on a plate, or in the air, is known as well as the plate reads: P's part times the noise that the
readings show over the noise that the filter gives them. The wrench of a foot that no plate reads follows from the
accelerations by Newton's law, and errs as they do. Of two such feet only the sum does; how they share it is known by
where they stand and how they push off, which errs alike for a whole double support:

    (c² − 1) κ [D, −D; −D, D] is added,  D = covariance of half the difference of both wrenches in P

Where no plate reads at all, a quick change is known only after a while, causally, and with its corners cut, smoothed:
l lᵀ is added, l = the rates of change of accelerations and wrenches times a lag, and, smoothed, b bᵀ, b = their second
derivatives times the square of a time: where an estimate bends, a corner was cut or soft tissue rings. Last, e eᵀ is
added for every wrench e that may be there or not: a small vertical force at the middle of the sole of a foot without a
plate that carries hardly anything; what a plate reads below its threshold under a foot that counts as in the air; and a
share of the change since the frame before on a plate, whose reading is a mean over the frame, beyond what its noise
changes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array
from mbkf.model.layout import FEET, Layout


@dataclass(frozen=True)
class ErrorSettings:
    """Repetition of errors. Set on synthetic walks, squats and jumps of two persons with 0 to 5 mm of skin.

    Attributes:
        new_share: Share κ of the marker noise that is new in every frame, for positions and loads on other parts.
        new_rates, smoothed_new_rates: The same for velocities and accelerations, causally and smoothed; feet without
            a plate err as accelerations do.
        skin_share: Share of what innovations show that is skin; the rest are misplaced markers, which the offset by
            the body has (:mod:`mbkf.filters.body_errors`).
        skin_rate_rad_s: How fast skin moves, ω.
        sharing_scale: Factor c on the spread of how two feet share a load that no plate reads.
        lag_s, smoothed_lag_s: Time by which reactions without plates lag behind, causally and smoothed.
        corner_s: Time over which smoothed reactions without plates may bend more or less than true ones.
        edge_share: Spread e of the vertical force on a foot without a plate that carries next to nothing, as a share
            of body weight.
        push_share: Spread of the force by which two feet without a plate push apart, side by side and a step apart, as
            a share of the push of forces that point to the pelvis.
        frame_share: Share of a plate's change since the frame before, and of the change of that change, by which its
            mean over a frame may be off.
    """

    new_share: float = 0.035
    new_rates: tuple[float, float] = (0.055, 0.025)
    smoothed_new_rates: tuple[float, float] = (0.08, 0.014)
    skin_share: float = 0.65
    skin_rate_rad_s: float = 2.8
    sharing_scale: float = 1.5
    lag_s: float = 0.038
    smoothed_lag_s: float = 0.008
    corner_s: float = 0.012
    edge_share: float = 0.08
    push_share: tuple[float, float] = (0.2, 0.3)
    frame_share: tuple[float, float] = (0.005, 0.15)


@dataclass(frozen=True)
class ErrorCovariance:
    """Errors of (q, v, a, w); their covariance Σ is positive semidefinite as P is.

    Attributes:
        layout: Slices of the state.
        P: (N, N) the filter's own covariance.
        information: (nv, nv) of one frame on the configuration, as the filter weighs it.
        seen: (n,) dofs that markers observe.
        skin: Variance of the markers over what the filter takes for it.
        new: Share κ of what the filter takes for it that is new in every frame, for positions and loads on other parts.
        new_rates: The same for velocities and accelerations; feet without a plate err as accelerations do.
            None if ``new`` holds for all.
        rate_rad_s: ω.
        free: Feet whose wrenches follow from Newton's law alone, 0 right and 1 left.
        sharing: Factor c where both do.
        late: (k, nv + 12 or more) l and b of accelerations and wrenches; None for none.
        edges: (n, 12) every e, on both feet's wrenches about the world's origin, N, N m.
        plates: (2, 6) noise of the feet's wrenches by plates over what the filter takes for it; or one number.
        supports: Slice of the wrench on other parts that bear, which Newton's law alone tells, too; None where none do.
    """

    layout: Layout
    P: Array
    information: Array
    seen: NDArray[np.intp]
    skin: float
    new: float
    rate_rad_s: float
    free: tuple[int, ...] = ()
    sharing: float = 1.0
    late: Array | None = None
    edges: Array = field(default_factory=lambda: np.zeros((0, FEET)))
    supports: slice | None = None
    new_rates: tuple[float, float] | None = None
    plates: Array | float = 1.0

    @cached_property
    def size(self) -> Array:
        """(N,) by which errors of the filter's kind are smaller than P says, √κ."""
        layout, rates = self.layout, self.new_rates or (self.new, self.new)
        size = _motion_size(layout.nv, layout.size, self.seen.tobytes(), (self.new, *rates)).copy()
        size[layout.wrench] = np.reshape(self.plates, -1)
        for foot in self.free:
            size[layout.feet[foot]] = rates[1] ** 0.5
        if self.supports is not None:
            size[self.supports] = self.new**0.5
        return size

    @cached_property
    def added(self) -> Array:
        """(k, N) roots of what is added for lags and for wrenches that may be there or not."""
        edges = len(self.edges)
        added = np.zeros((edges + (0 if self.late is None else len(self.late)), self.layout.size))
        added[:edges, self.layout.wrench] = self.edges
        if self.late is not None:
            added[edges:, self._late] = self.late
        return added

    @property
    def _late(self) -> slice:
        """Components that lag: accelerations, wrenches of the feet, and on other parts where they are stated."""
        first = self.layout.a.start
        return slice(first, first if self.late is None else first + self.late.shape[1])

    @property
    def apart(self) -> float:
        """(c² − 1) κ of two feet without a plate; 0 for one foot or none."""
        return 0.0 if len(self.free) < 2 else (self.sharing**2 - 1.0) * self.new

    @cached_property
    def difference(self) -> Array | None:
        """(6, 6) what is added to both feet's wrenches, and taken from between them; None where that is nothing."""
        if self.apart == 0.0:
            return None
        right, left = self.layout.feet
        between = self.P[right, left]
        half = 0.25 * (self.P[right, right] + self.P[left, left] - between - between.T)
        return np.asarray(self.apart * half)

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
        q, seen = self.layout.q, self.seen
        block = self.P[q, q] * self.size[q]
        block *= self.size[q, None]
        block[seen[:, None], seen] += self.repeated
        return block

    @property
    def position_variance(self) -> Array:
        """(nv,) diagonal of Σ of the configuration."""
        return self._variance(self.layout.q, 1.0)

    @property
    def velocity_variance(self) -> Array:
        """(nv,) diagonal of Σ of the velocities."""
        return self._variance(self.layout.v, self.rate_rad_s**2)

    def _variance(self, part: slice, share: float) -> Array:
        found: Array = np.diagonal(self.P)[part] * self.size[part] ** 2
        found[self.seen] += share * self._repeated_variance
        return found

    def variance_of(self, T: Array) -> Array:
        """(m,) diagonal of T Σ Tᵀ for quantities T (m, n) of its first n components, without Σ."""
        layout, rate, n = self.layout, self.rate_rad_s, T.shape[1]
        sized = T * self.size[:n]
        variance: Array = np.einsum("ij,ij->i", sized @ self.P[:n, :n], sized)
        # Positions and accelerations swing in opposition, velocities between them.
        parts = np.concatenate([T[:, layout.q] - rate**2 * T[:, layout.a], rate * T[:, layout.v]])
        repeated = (parts[:, self.seen] if len(self.seen) < layout.nv else parts) @ self._root.T
        squared = np.einsum("ij,ij->i", repeated, repeated)
        variance += self.skin * (squared[: len(T)] + squared[len(T) :])
        if n < layout.wrench.stop:
            return variance
        if self.difference is not None:
            right, left = layout.feet
            apart = T[:, right] - T[:, left]
            variance += np.einsum("ij,ij->i", apart @ self.difference, apart)
        if self.late is not None:
            mine = T[:, self._late]
            variance += np.square(mine @ self.late[:, : mine.shape[1]].T).sum(axis=1)
        return variance + np.square(T[:, layout.wrench] @ self.edges.T).sum(axis=1)

    @property
    def wrench_variance(self) -> Array:
        """(12,) diagonal of Σ of both feet's wrenches."""
        mine, first = self.layout.wrench, self.layout.a.start
        found: Array = np.diagonal(self.P)[mine] * self.size[mine] ** 2
        if self.difference is not None:
            found += np.tile(np.diagonal(self.difference), 2)
        found += np.square(self.edges).sum(axis=0)
        if self.late is None:
            return found
        return found + np.square(self.late[:, mine.start - first : mine.stop - first]).sum(axis=0)

    def covariance(self) -> Array:
        """(N, N) Σ."""
        layout, rate, C = self.layout, self.rate_rad_s, self.repeated
        whole = self.P * self.size * self.size[:, None]
        q, v, a = (part.start + self.seen for part in (layout.q, layout.v, layout.a))
        swing = rate**2 * C
        for part, own in ((q, C), (v, swing), (a, rate**2 * swing)):
            whole[np.ix_(part, part)] += own
        whole[np.ix_(q, a)] -= swing
        whole[np.ix_(a, q)] -= swing
        feet, late = layout.wrench, self._late
        if self.difference is not None:
            whole[feet, feet] += np.kron([[1.0, -1.0], [-1.0, 1.0]], self.difference)
        if self.late is not None:
            whole[late, late] += self.late.T @ self.late
        whole[feet, feet] += self.edges.T @ self.edges
        return whole


@lru_cache(maxsize=8)
def _motion_size(nv: int, size: int, seen: bytes, new: tuple[float, float, float]) -> Array:
    """(N,) as :attr:`ErrorCovariance.size` for the errors of the motion, 1 for others.

    Args:
        nv: Dofs.
        size: Components N.
        seen: Dofs that markers observe, as bytes.
        new: κ of positions, velocities and accelerations.
    """
    found = np.ones(size)
    found[: 3 * nv].reshape(3, nv)[:, np.frombuffer(seen, dtype=np.intp)] = np.sqrt(new)[:, None]
    return found
