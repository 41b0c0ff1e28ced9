"""A limb fitted to its markers while the rest of the body stays: most likely pose, from a start that is given.

    J(q) = Σ_m ‖m − m(q)‖² / σ_m²  +  Σ_j (θ_j / σ_θ)²  +  Σ_j (beyond_j / σ_b)²

over the limb's markers m and dofs j: fit, posture prior and ranges of joints. A pose that fits as well but lies beyond
its ranges, such as a thigh turned about its long axis with a knee that bends forwards, costs more than the right one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.markers import innovations
from mbkf.model.limbs import Limb, limbs
from mbkf.numerics.elimination import Border
from mbkf.numerics.levenberg_marquardt import ArrowEquations, minimise
from mbkf.sensors.joint_limits import JointLimits, JointLimitSettings
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerSensor
from mbkf.sensors.posture import prior_information
from mbkf.sensors.posture_sensor import PostureSensor

BEYOND_SD_RAD = 0.05
"""Spread σ_b of a joint beyond its range: 20° beyond weigh as much as a marker seven standard deviations off."""

LEAST_SEEN = 3
"""Least number of a limb's markers seen in a frame in which it is judged or fitted."""

STRAY_M, STRAY_SHARE = 0.06, 0.25
"""Markers further from the fitted limb are left out, at most this share of those seen."""

ITERATIONS = 12


@dataclass(frozen=True)
class LimbPose:
    """A fitted limb.

    Attributes:
        q: (nq,) configuration of the body; what does not belong to the limb is as given.
        cost: J, with the markers left out at :data:`STRAY_M`.
        rms_m: RMS distance of the limb's seen markers, m.
        beyond_rad: Largest distance of a joint from its range, rad.
    """

    q: Array
    cost: float
    rms_m: float
    beyond_rad: float


@dataclass(frozen=True)
class LimbEvidence:
    """Fit of a pose's limbs to the markers of a frame; arrays by limb.

    Attributes:
        seen: (L,) number of markers seen.
        misfit_m: (L,) RMS distance of its markers, m; 0 without one.
        segment_m: (L,) the same of its worst segment, m.
        others_m: (L,) the same of all other markers, m.
        beyond_rad: (L,) largest distance of a joint from its range, rad.
        dof: (L,) the dof that lies so far.
    """

    seen: Array
    misfit_m: Array
    segment_m: Array
    others_m: Array
    beyond_rad: Array
    dof: NDArray[np.intp]


class LimbFits:
    """Judges and fits the limbs of a body by its markers.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        names: (M,) their names; numbers where they have none.
        limbs: The limbs, without what no marker of the capture moves with.
        on_limb: (L, M) markers by limb.
        trunk_dofs: Dofs of all that belongs to no limb.
    """

    def __init__(
        self, sensor: MarkerSensor, noise_m: Array, unobservable: BoolArray, named: Sequence[str] = ()
    ) -> None:
        """Makes it.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) their noise, m.
            unobservable: (nv,) dofs that move no marker of the capture.
            named: (M,) names of the markers, for statements about them; empty where they have none.
        """
        self.names = tuple(named) or tuple(f"marker {m}" for m in range(len(sensor.segments)))
        self.sensor, self.noise_m = sensor, noise_m
        self.limbs = tuple(_shown(limbs(sensor.model), unobservable))
        names = np.array(sensor.segments, dtype=object)
        segments = list(dict.fromkeys(sensor.segments))
        self.on_limb = np.array(
            [np.isin(names, [joint.segment for joint in limb.joints]) for limb in self.limbs], dtype=bool
        ).reshape(len(self.limbs), len(names))
        self._posture = PostureSensor(sensor.model)
        self._weights = self._posture.weights(1.0, unobservable)
        self._ranges = JointLimits(self._posture, unobservable, JointLimitSettings(BEYOND_SD_RAD))
        self._information = MarkerInformation(sensor, noise_m)
        self._on_segment = (names == np.array(segments, dtype=object)[:, None]).astype(float)
        self._counts = self._on_segment.sum(axis=1)
        self._of_limb = np.array(
            [[s in {joint.segment for joint in limb.joints} for s in segments] for limb in self.limbs],
            dtype=float,
        ).reshape(len(self.limbs), len(segments))
        nv = sensor.model.nv
        self.trunk_dofs = np.flatnonzero(~unobservable)
        for limb in self.limbs:
            self.trunk_dofs = np.setdiff1d(self.trunk_dofs, limb.dofs)
        self._dofs = np.zeros((len(self.limbs), nv))
        for row, limb in zip(self._dofs, self.limbs, strict=True):
            row[limb.dofs] = 1.0

    def evidence(self, q: Array, measured_m: Array) -> LimbEvidence:
        """Fit and ranges of all limbs in a pose.

        Args:
            q: (nq,) configuration.
            measured_m: (M, 3) measured positions of a frame, NaN where missing.
        """
        squared = _squared(measured_m - self.sensor.positions(q))
        seen = squared == squared  # noqa: PLR0124, a missing marker's is NaN
        squared[~seen] = 0.0
        sums, counts = self._on_segment @ squared, self._on_segment @ seen
        own, number = self._of_limb @ sums, self._of_limb @ counts
        others = (sums.sum() - own) / np.maximum(counts.sum() - number, 1.0)
        worst = (self._of_limb * (sums / np.maximum(counts, 1.0))).max(axis=1, initial=0.0)
        excess = self._ranges.beyond(self._posture.deviation(q)[0])
        if excess is None:
            beyond, dof = np.zeros(len(number)), np.zeros(len(number), dtype=np.intp)
        else:
            by_limb = np.abs(excess) * self._dofs
            dof = by_limb.argmax(axis=1)
            beyond = by_limb.max(axis=1, initial=0.0)
        return LimbEvidence(
            number, np.sqrt(own / np.maximum(number, 1.0)), np.sqrt(worst), np.sqrt(others), beyond, dof
        )

    def fits_within(self, q: Array, measured_m: Array, most_m: float, most_rad: float) -> bool:
        """True where every seen marker lies nearer than a distance, and every joint's excess over its range is smaller.

        Args:
            q: (nq,) configuration.
            measured_m: (M, 3) measured positions of a frame, NaN where missing.
            most_m: The distance.
            most_rad: The excess, rad.
        """
        places_m = self.sensor.positions(q)
        found = innovations(measured_m, places_m, most_m)
        near = found.near if found is not None else not (_squared(measured_m - places_m) > most_m**2).any()
        if not near:
            return False
        excess = self._ranges.beyond(self._posture.deviation(q)[0])
        return excess is None or bool(np.abs(excess).max() <= most_rad)

    def worst_segment(self, squared_m2: Array) -> Array:
        """(L,) largest mean square among each limb's segments, of squared distances (M,), m²."""
        means = self._on_segment @ squared_m2 / self._counts
        return np.asarray((self._of_limb * means).max(axis=1, initial=0.0))

    def trunk(self, q: Array, measured_m: Array) -> Array:
        """(nq,) the pose with all that belongs to no limb fitted to its own markers alone.

        Args:
            q: (nq,) pose in doubt.
            measured_m: (M, 3) measured positions of a frame, NaN where missing.
        """
        own = ~self.on_limb.any(axis=0) & ~np.isnan(measured_m[:, 0])
        if np.count_nonzero(own) < LEAST_SEEN:
            return q
        return self._fitted(self.trunk_dofs, q, measured_m, own, ranged=True)

    def fit(self, limb: Limb, q: Array, measured_m: Array, ranged: bool = True) -> LimbPose:
        """The limb in its most likely pose near a start, without the markers that stay far from it.

        Args:
            limb: One of :attr:`limbs`.
            q: (nq,) start; what does not belong to the limb stays.
            measured_m: (M, 3) measured positions of a frame, NaN where missing.
            ranged: False for the minimum by markers and posture alone.
        """
        own = self.on_limb[self.limbs.index(limb)] & ~np.isnan(measured_m[:, 0])
        found = self._fitted(limb.dofs, q, measured_m, own, ranged)
        distance = np.linalg.norm(measured_m - self.sensor.positions(found), axis=1)
        far = np.flatnonzero(own & (distance > STRAY_M))
        if len(far):
            most = int(STRAY_SHARE * np.count_nonzero(own))
            used = own.copy()
            used[far[np.argsort(distance[far])[::-1][:most]]] = False
            found = self._fitted(limb.dofs, found, measured_m, used, ranged)
        return self.judged(limb, found, measured_m)

    def judged(self, limb: Limb, found: Array, measured_m: Array) -> LimbPose:
        """The limb as it is in a pose.

        Args:
            limb: One of :attr:`limbs`.
            found: (nq,) the pose.
            measured_m: (M, 3) measured positions of a frame, NaN where missing.
        """
        own = self.on_limb[self.limbs.index(limb)] & ~np.isnan(measured_m[:, 0])
        squared = ((measured_m - self.sensor.positions(found)) ** 2).sum(axis=1)
        deviation = self._posture.deviation(found)[0]
        pull = (deviation * self._weights)[limb.dofs]
        excess = self._ranges.beyond(deviation)
        beyond = np.zeros(len(limb.dofs)) if excess is None else excess[limb.dofs]
        capped = np.minimum(squared[own], STRAY_M**2) / self.noise_m[own] ** 2
        cost = float(capped.sum() + pull @ pull + (beyond / BEYOND_SD_RAD) @ (beyond / BEYOND_SD_RAD))
        rms = float(np.sqrt(squared[own].mean())) if own.any() else 0.0
        return LimbPose(found, cost, rms, float(np.abs(beyond).max(initial=0.0)))

    def _fitted(
        self, dofs: NDArray[np.intp], start: Array, measured_m: Array, used: BoolArray, ranged: bool
    ) -> Array:
        """(nq,) minimum of J over some dofs, by the markers ``used`` (M,), with ranges or without."""
        model, square = self.sensor.model, np.ix_(dofs, dofs)
        target, noise, weights = measured_m[used], self.noise_m[used, None], self._weights

        def weighed(positions_m: Array, deviation: Array) -> float:
            errors, pull = (positions_m[used] - target) / noise, (deviation * weights)[dofs]
            excess = self._ranges.beyond(deviation) if ranged else None
            passed = 0.0 if excess is None else float(((excess[dofs] / BEYOND_SD_RAD) ** 2).sum())
            return float((errors**2).sum() + pull @ pull) + passed

        def cost(q: Array) -> float:
            return weighed(self.sensor.positions(q), self._posture.deviation(q)[0])

        def linearise(q: Array) -> ArrowEquations:
            reading, (deviation, turning) = self.sensor.reading(q), self._posture.deviation(q)
            known = self._information.at(reading, measured_m - reading.positions_m, used)
            known += prior_information(self._posture, deviation, turning, weights)
            passed = self._ranges.information(deviation, turning) if ranged else None
            known = known if passed is None else known + passed
            hessian = known.matrix[square] + 1e-9 * np.eye(len(dofs))
            at = weighed(reading.positions_m, deviation)
            none = Border.plain(np.zeros((1, len(dofs), 0)))
            return ArrowEquations(
                hessian[None], none, np.zeros((0, 0)), -known.vector[dofs][None], np.zeros(0), at
            )

        def move(q: Array, own: Array, _: Array) -> Array:
            step = np.zeros(model.nv)
            step[dofs] = own[0]
            return model.integrate(q, step)

        return minimise(start, linearise, cost, move, tolerance=1e-3, max_iterations=ITERATIONS).state


def _shown(every: Sequence[Limb], unobservable: BoolArray) -> Iterator[Limb]:
    """Limbs without joints and dofs that move no marker."""
    for limb in every:
        dofs = limb.dofs[~unobservable[limb.dofs]]
        if len(dofs):
            joints = tuple(one for one in limb.joints if not unobservable[one.v].all())
            yield Limb(limb.name, joints, dofs)


def _squared(apart_m: Array) -> Array:
    """(M,) squared lengths of (M, 3) vectors."""
    return np.asarray(np.vecdot(apart_m, apart_m))
