"""A body fitted to a cloud of unnamed points: pose and size by expectation–maximisation over places of markers.

With the density of :mod:`mbkf.marker_sets.places` on a body in pose q with scale factors k, a point p has the
likelihood

    L(p) = ε u + (1 − ε) Σ_c π_c N(p; m_c(q, k), (s² + σ_c²) 1)

with the share ε of points off the body, spread evenly (u), and a width s that shrinks during the fit, so that it
converges from far starts (deterministic annealing). The E-step shares every point among the components, the M-step is
one Gauss–Newton step of the weighted distances with priors of posture, size and upright stance (Dempster,
Laird & Rubin 1977; for point sets Myronenko & Song, IEEE Trans. PAMI 32, 2010, 2262-2275).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array
from mbkf.marker_sets.places import WornPlaces
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import Information
from mbkf.scaling.problem import FACTOR_BOUNDS
from mbkf.scaling.standing import UprightPosture
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerReading
from mbkf.sensors.posture import prior_information
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.scaled_markers import ScaledMarkers

OFF_BODY = 0.03
"""Prior share ε of points that are not on the body."""

ROOM_M3 = 2.0
"""Volume of such points: that of a person with moving arms and legs, and its surroundings."""

TILT_RAD = 0.25
"""Spread of the pelvis about upright."""

SOLE_SD_RAD = 0.12
"""Spread of a sole's inclination in standing: shoes raise heels, and the body is not scaled yet."""

PROPORTION_SD = 0.06
"""Spread of a scale factor about the person's overall size."""

SIZE_SD = 0.13
"""Spread of the overall size about the reference body's, children among the persons."""

LEAST_SHARE = 1e-3
"""Least sum of shares of a component that takes part in the M-step."""

LIMIT_SD_RAD = 0.1
"""Softness of the joints' limits: knees and elbows bend one way, which distinguishes front and back."""

_DAMPING = 1e-6


@dataclass(frozen=True)
class PosedBody:
    """A body in a cloud of N points.

    Attributes:
        q: (nq,) pose.
        factors: (K,) scale factors.
        shares: (N, C) probability that a point belongs to a component; the rest of a row to 1 is that of a point off
            the body.
        log_posterior: Logarithm of likelihood and priors.
    """

    q: Array
    factors: Array
    shares: Array
    log_posterior: float


class CloudProblem:
    """The fit of a body of the reference's kind to points.

    Attributes:
        places: Density of marker places.
        points_m: (N, 3) the points, all of them seen.
        weight: (C,) weight of each component in this cloud, or (N, C) for each of its points.
        model: The reference body; built where None.
    """

    def __init__(
        self,
        places: WornPlaces,
        points_m: Array,
        weight: Array,
        model: HumanModel | None = None,
        *,
        standing: bool = False,
    ) -> None:
        """Takes places and points.

        Args:
            places: Density of marker places.
            points_m: (N, 3) the points.
            weight: (C,) or (N, C) weights of the components.
            model: The reference body; built where None.
            standing: True where the soles are known to be level.
        """
        self.places, self.points_m = places, points_m
        with np.errstate(divide="ignore"):
            self._log_weight = np.log((1.0 - OFF_BODY) * weight)
        body = places.body
        self.model = model or HumanModel(body, np.ones(len(body.scale_factors)), body.reference_mass_kg)
        self._posture = PostureSensor(self.model)
        self._usual = self._posture.weights(1.0, np.zeros(self.model.nv, dtype=bool))
        self._level = UprightPosture(
            self.model, dict.fromkeys(self.model.roles.feet if standing else (), SOLE_SD_RAD)
        )
        self._components = ScaledMarkers(self.model, places.segments, places.position_m)
        self._reference = self._components.sensor
        count = len(body.scale_factors)
        covariance = PROPORTION_SD**2 * np.eye(count) + SIZE_SD**2 * np.ones((count, count))
        self._factor_information = np.linalg.inv(covariance)

    def of_points(self, chosen: NDArray[np.intp]) -> CloudProblem:
        """The problem with some of the points alone, by their numbers."""
        thinned = copy(self)
        thinned.points_m = self.points_m[chosen]
        if self._log_weight.ndim == 2:
            thinned._log_weight = self._log_weight[chosen]
        return thinned

    def reading(self, q: Array, factors: Array) -> tuple[MarkerReading, Array]:
        """Components at q (nq,) on a body of scale factors (K,), and their derivatives (C, 3, K) by these."""
        found = self._components.reading(q[None], factors)
        return found.markers[0], found.by_factors[0]

    def shares(
        self, positions_m: Array, width_m: float, points_m: Array | None = None
    ) -> tuple[Array, float]:
        """E-step: shares (N, C) of the points in components at positions (C, 3), and the log-likelihood.

        Args:
            positions_m: (C, 3) centres of the components.
            width_m: The width s.
            points_m: (N, 3) other points than the cloud's.
        """
        points = self.points_m if points_m is None else points_m
        variance = width_m**2 + self.places.sd_m**2
        # −|p − m|² / 2 s² + logarithm of the height, as one product (N, 5) (5, C)
        square = (points**2).sum(axis=1)
        by_point = np.column_stack([points, square, np.ones(len(points))])
        by_component = np.empty((5, len(variance)))
        by_component[:3] = positions_m.T / variance
        by_component[3] = -0.5 / variance
        by_component[4] = by_component[3] * (positions_m**2).sum(axis=1) - 1.5 * np.log(
            2.0 * np.pi * variance
        )
        if self._log_weight.ndim == 1:
            by_component[4] += self._log_weight
        density = by_point @ by_component
        if self._log_weight.ndim == 2:
            density += self._log_weight
        np.exp(density, out=density)
        total = density.sum(axis=1) + OFF_BODY / ROOM_M3
        density /= total[:, None]
        return density, float(np.log(total).sum())

    def priors(self, q: Array, factors: Array) -> float:
        """Logarithm of the priors of a pose (nq,) and scale factors (K,), up to a constant."""
        turned, _ = self._posture.deviation(q)
        deviation = turned * self._usual
        excess = self._limit_excess(turned) / LIMIT_SD_RAD
        rotation = self.model.placements(q)[0][self.model.root.joint_id]
        tilt = rotation[:2, 2] / TILT_RAD
        size, soles = factors - 1.0, self._level.residuals(self.model, q)
        return -0.5 * float(
            deviation @ deviation
            + excess @ excess
            + tilt @ tilt
            + soles @ soles
            + size @ self._factor_information @ size
        )

    def _limit_excess(self, turned: Array) -> Array:
        """(nv,) excess of these joint angles over their limits, rad."""
        return np.asarray(turned - np.clip(turned, self.model.limits[:, 0], self.model.limits[:, 1]))

    def posed(self, q: Array, size: float, widths_m: tuple[float, ...]) -> PosedBody:
        """A body of the reference's proportions, its pose fitted.

        Args:
            q: (nq,) pose to start from, of the body of this size.
            size: Its overall size.
            widths_m: Widths of the iterations.
        """
        factors = np.full(len(self.places.body.scale_factors), size)
        sensor = self._reference
        points = self.points_m / size
        q = self._with_root(q, 1.0 / size)
        for width in widths_m:
            reading = sensor.reading(q)
            shares, _ = self.shares(reading.positions_m, width / size, points)
            step = self._step(reading, shares, points, width / size, q)
            q = self.model.integrate(q, step)
        q = self._with_root(q, size)
        return self._judged(q, factors, widths_m[-1], sensor.positions(self._with_root(q, 1.0 / size)) * size)

    def fitted(self, start: PosedBody, widths_m: tuple[float, ...]) -> PosedBody:
        """Pose and scale factors fitted together.

        Args:
            start: Where to start.
            widths_m: Widths of the iterations.
        """
        q, factors = start.q, start.factors
        for width in widths_m:
            reading, by_factors = self.reading(q, factors)
            shares, _ = self.shares(reading.positions_m, width)
            step = self._step(reading, shares, self.points_m, width, q, (by_factors, factors))
            q = self.model.integrate(q, step[: self.model.nv])
            factors = np.clip(factors + step[self.model.nv :], *FACTOR_BOUNDS)
        return self._judged(q, factors, widths_m[-1], self.reading(q, factors)[0].positions_m)

    def _judged(self, q: Array, factors: Array, width_m: float, positions_m: Array) -> PosedBody:
        shares, likelihood = self.shares(positions_m, width_m)
        return PosedBody(q, factors, shares, likelihood + self.priors(q, factors))

    def _with_root(self, q: Array, size: float) -> Array:
        moved = q.copy()
        moved[self.model.root.q][:3] = size * q[self.model.root.q][:3]
        return moved

    def _step(
        self,
        reading: MarkerReading,
        shares: Array,
        points_m: Array,
        width_m: float,
        q: Array,
        sized: tuple[Array, Array] | None = None,
    ) -> Array:
        """M-step: one Gauss–Newton step of the pose (nv,), and of the scale factors behind it where they are free."""
        matrix, gradient = self.equations(reading, shares, points_m, width_m, q, sized)
        matrix[np.diag_indices(len(matrix))] += _DAMPING * np.trace(matrix) / len(matrix)
        _, step, failed = lapack.dposv(matrix, gradient)
        if failed:
            raise np.linalg.LinAlgError("the matrix of the step is not positive definite")
        return np.asarray(step)

    def equations(
        self,
        reading: MarkerReading,
        shares: Array,
        points_m: Array,
        width_m: float,
        q: Array,
        sized: tuple[Array, Array] | None = None,
    ) -> tuple[Array, Array]:
        """Gauss–Newton matrix (n, n) of the M-step and gradient (n,) of log-likelihood and priors, uphill.

        Args:
            reading: The components at q.
            shares: (N, C) shares of the E-step.
            points_m: (N, 3) the points.
            width_m: The width s.
            q: (nq,) the pose.
            sized: The components' derivatives (C, 3, K) by the scale factors, and these (K,), where they are free: then
                n = nv + K, else nv.
        """
        total = shares.sum(axis=0)
        active = total > LEAST_SHARE
        total = np.where(active, total, 1.0)
        pull = total / (width_m**2 + self.places.sd_m**2)
        away = (shares.T @ points_m) / total[:, None] - reading.positions_m
        known = MarkerInformation(self._reference, pull**-0.5).at(reading, away, active)
        turned, by_pose = self._posture.deviation(q)
        known += prior_information(self._posture, turned, by_pose, self._usual)
        excess = self._limit_excess(turned)
        if excess.any():
            known += prior_information(self._posture, excess, by_pose, (excess != 0.0) / LIMIT_SD_RAD)
        self._upright(reading, known)
        if len(self._level.sd):
            soles, by_pose = self._level.linearised(self.model, q)
            known.matrix[:] += by_pose.T @ by_pose
            known.vector[:] -= by_pose.T @ soles
        if sized is None:
            return known.matrix, known.vector
        return self._with_factors(
            known, reading.only(active), pull[active], away[active], (sized[0][active], sized[1])
        )

    def _upright(self, reading: MarkerReading, known: Information) -> None:
        """Adds the prior of an upright pelvis: the horizontal part of its axis, R z."""
        turns = slice(self.model.root.v.start + 3, self.model.root.v.stop)
        rotation = reading.spatial[3:, turns]
        # δ(R z) = R (δθ × z), δθ × z = (δθ_y, −δθ_x, 0)
        jacobian = np.column_stack([-rotation[:2, 1], rotation[:2, 0], np.zeros(2)]) / TILT_RAD
        known.matrix[turns, turns] += jacobian.T @ jacobian
        known.vector[turns] -= jacobian.T @ (rotation[:2, 2] / TILT_RAD)

    def _with_factors(
        self, known: Information, reading: MarkerReading, pull: Array, away: Array, sized: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Equations of pose and scale factors.

        Args:
            known: Those of the pose alone.
            reading: The A components that count.
            pull: (A,) their weights.
            away: (A, 3) their distances from their points.
            sized: Their derivatives (A, 3, K) by the scale factors, and these (K,).
        """
        nv, size = len(known.vector), len(known.vector) + len(sized[1])
        by_factors = sized[0].reshape(-1, size - nv)
        weighted = by_factors * np.repeat(pull, 3)[:, None]
        matrix, gradient = np.empty((size, size)), np.empty(size)
        matrix[:nv, :nv], gradient[:nv] = known.matrix, known.vector
        across = reading.jacobian.reshape(-1, nv).T @ weighted
        matrix[:nv, nv:], matrix[nv:, :nv] = across, across.T
        matrix[nv:, nv:] = by_factors.T @ weighted + self._factor_information
        gradient[nv:] = away.ravel() @ weighted - self._factor_information @ (sized[1] - 1.0)
        return matrix, gradient
