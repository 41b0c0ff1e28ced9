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

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.marker_sets.places import WornPlaces
from mbkf.model.human import HumanModel
from mbkf.model.scale_derivatives import origin_derivatives
from mbkf.scaling.problem import FACTOR_BOUNDS
from mbkf.sensors.marker_sensor import MarkerReading, MarkerSensor
from mbkf.sensors.posture_sensor import PostureSensor

OFF_BODY = 0.03
"""Prior share ε of points that are not on the body."""

ROOM_M3 = 2.0
"""Volume of such points: that of a person with moving arms and legs, and its surroundings."""

TILT_RAD = 0.25
"""Spread of the pelvis about upright."""

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
        self, places: WornPlaces, points_m: Array, weight: Array, model: HumanModel | None = None
    ) -> None:
        self.places, self.points_m = places, points_m
        with np.errstate(divide="ignore"):
            self._log_weight = np.log(weight)
        body = places.body
        self.model = model or HumanModel(body, np.ones(len(body.scale_factors)), body.reference_mass_kg)
        joints = [self.model.joint(segment.name).joint_id for segment in body.segments]
        self._moves = self.model.supports[joints].astype(float)[:, None]
        self._carried = (np.arange(len(joints))[:, None] == places.segment_index).astype(float)
        self._posture = PostureSensor(self.model)
        self._reference = MarkerSensor(self.model, places.segments, places.position_m)
        self._scale = np.array([body.segment(name).scale_matrix for name in places.segments])
        count = len(body.scale_factors)
        covariance = PROPORTION_SD**2 * np.eye(count) + SIZE_SD**2 * np.ones((count, count))
        self._factor_information = np.linalg.inv(covariance)

    def sized(self, factors: Array) -> MarkerSensor:
        """The components on a body of these scale factors (K,)."""
        body = self.places.body
        model = HumanModel(body, factors, body.reference_mass_kg)
        local = np.einsum("cak,k->ca", self._scale, factors) * self.places.position_m
        return MarkerSensor(model, self.places.segments, local)

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
        density = by_point @ by_component
        density += self._log_weight
        np.exp(density, out=density)
        density *= 1.0 - OFF_BODY
        total = density.sum(axis=1) + OFF_BODY / ROOM_M3
        density /= total[:, None]
        return density, float(np.log(total).sum())

    def priors(self, q: Array, factors: Array) -> float:
        """Logarithm of the priors of a pose (nq,) and scale factors (K,), up to a constant."""
        turned, _ = self._posture.deviation(q)
        deviation = turned[self._posture.dofs] / self._posture.sd
        excess = self._limit_excess(turned) / LIMIT_SD_RAD
        rotation = self.model.placements(q)[0][self.model.root.joint_id]
        tilt = rotation[:2, 2] / TILT_RAD
        size = factors - 1.0
        return -0.5 * float(
            deviation @ deviation + excess @ excess + tilt @ tilt + size @ self._factor_information @ size
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
            sensor = self.sized(factors)
            reading = sensor.reading(q)
            shares, _ = self.shares(reading.positions_m, width)
            step = self._step(reading, shares, self.points_m, width, q, (sensor, factors))
            q = self.model.integrate(q, step[: self.model.nv])
            factors = np.clip(factors + step[self.model.nv :], *FACTOR_BOUNDS)
        return self._judged(q, factors, widths_m[-1], self.sized(factors).positions(q))

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
        sized: tuple[MarkerSensor, Array] | None = None,
    ) -> Array:
        """M-step: one Gauss–Newton step of the pose (nv,), and of the scale factors behind it where they are free."""
        matrix, gradient = self.equations(reading, shares, points_m, width_m, q, sized)
        matrix[np.diag_indices(len(matrix))] += _DAMPING * np.trace(matrix) / len(matrix)
        return np.asarray(np.linalg.solve(matrix, gradient))

    def equations(
        self,
        reading: MarkerReading,
        shares: Array,
        points_m: Array,
        width_m: float,
        q: Array,
        sized: tuple[MarkerSensor, Array] | None = None,
    ) -> tuple[Array, Array]:
        """Gauss–Newton matrix (n, n) of the M-step and gradient (n,) of log-likelihood and priors, uphill.

        Args:
            reading: The components at q.
            shares: (N, C) shares of the E-step.
            points_m: (N, 3) the points.
            width_m: The width s.
            q: (nq,) the pose.
            sized: The components' sensor and scale factors (K,) where those are free: then n = nv + K, else nv.
        """
        total = shares.sum(axis=0)
        active = total > LEAST_SHARE
        pull = total[active] / (width_m**2 + self.places.sd_m[active] ** 2)
        target = (shares[:, active].T @ points_m) / total[active, None]
        positions = reading.positions_m[active]
        errors = pull[:, None] * (target - positions)
        model = self.model if sized is None else sized[0].model
        nv, size = self.model.nv, self.model.nv + (0 if sized is None else len(sized[1]))
        matrix, gradient = np.zeros((size, size)), np.zeros(size)
        moved = model.spatial_jacobian(q) * self._moves
        carried = self._carried[:, active]
        flat = moved.reshape(-1, nv)
        matrix[:nv, :nv] = flat.T @ (_inertia(carried, positions, pull) @ moved).reshape(-1, nv)
        gradient[:nv] = (carried @ _wrenches(positions, errors[:, :, None])[..., 0]).ravel() @ flat
        if sized is not None:
            sensor, factors = sized
            by_factors = self._by_factors(sensor, q, active)
            weighted = by_factors * pull[:, None, None]
            wrenches = _wrenches(positions, weighted).reshape(len(pull), -1)
            across = flat.T @ (carried @ wrenches).reshape(len(flat), -1)
            matrix[:nv, nv:], matrix[nv:, :nv] = across, across.T
            by_factors = by_factors.reshape(-1, size - nv)
            matrix[nv:, nv:] = by_factors.T @ weighted.reshape(-1, size - nv)
            gradient[nv:] = errors.ravel() @ by_factors
        prior = self._posture.reading(q)
        rows = prior.jacobian / self._posture.sd[:, None]
        matrix[:nv, :nv] += rows.T @ rows
        gradient[:nv] -= rows.T @ (prior.deviation / self._posture.sd)
        turned, by_pose = self._posture.deviation(q)
        excess = self._limit_excess(turned)
        passed = by_pose[excess != 0.0] / LIMIT_SD_RAD
        matrix[:nv, :nv] += passed.T @ passed
        gradient[:nv] -= passed.T @ (excess[excess != 0.0] / LIMIT_SD_RAD)
        self._upright(q, matrix, gradient)
        if sized is not None:
            matrix[nv:, nv:] += self._factor_information
            gradient[nv:] -= self._factor_information @ (factors - 1.0)
        return matrix, gradient

    def _upright(self, q: Array, matrix: Array, gradient: Array) -> None:
        """Adds the prior of an upright pelvis: the horizontal part of its axis, R z."""
        rotation = self.model.placements(q)[0][self.model.root.joint_id]
        turns = np.arange(self.model.nv)[self.model.root.v][3:]
        # δ(R z) = R (δθ × z), δθ × z = (δθ_y, −δθ_x, 0)
        jacobian = np.column_stack([-rotation[:2, 1], rotation[:2, 0], np.zeros(2)]) / TILT_RAD
        matrix[np.ix_(turns, turns)] += jacobian.T @ jacobian
        gradient[turns] -= jacobian.T @ (rotation[:2, 2] / TILT_RAD)

    def _by_factors(self, sensor: MarkerSensor, q: Array, active: Array) -> Array:
        """(A, 3, K) derivatives of the active components by the scale factors."""
        rotations, _ = sensor.model.placements(q)
        joints = sensor.joint_ids[active]
        own = self._scale[active] * self.places.position_m[active, :, None]
        return np.asarray(origin_derivatives(sensor.model, rotations)[joints] + rotations[joints] @ own)


def _inertia(carried: Array, positions_m: Array, masses: Array) -> Array:
    """(S, 6, 6) Σ m XᵀX of the points on every segment, X = [1, −p×] taking its spatial velocity to a point's.

    Args:
        carried: (S, A) 1 where a segment carries a point.
        positions_m: (A, 3) points p in the world.
        masses: (A,) their masses m.
    """
    first = masses[:, None] * positions_m
    second = first[:, :, None] * positions_m[:, None]
    mass, first, second = carried @ masses, carried @ first, carried @ second.reshape(-1, 9)
    second = second.reshape(-1, 3, 3)
    matrix, one = np.zeros((len(carried), 6, 6)), np.eye(3)
    matrix[:, :3, :3] = mass[:, None, None] * one
    matrix[:, 3:, :3] = _wrenches(first, np.broadcast_to(one, (len(carried), 3, 3)))[:, 3:]
    matrix[:, :3, 3:] = np.swapaxes(matrix[:, 3:, :3], 1, 2)
    matrix[:, 3:, 3:] = np.trace(second, axis1=1, axis2=2)[:, None, None] * one - second
    return matrix


def _wrenches(positions_m: Array, forces: Array) -> Array:
    """(A, 6, n) XᵀF = [F, p × F] of forces F (A, 3, n) at points p (A, 3), about the world's origin."""
    found = np.empty((len(forces), 6, forces.shape[2]))
    found[:, :3] = forces
    p = positions_m[:, :, None]
    for k in range(3):
        after, last = (k + 1) % 3, (k + 2) % 3
        found[:, 3 + k] = p[:, after] * forces[:, last] - p[:, last] * forces[:, after]
    return found
