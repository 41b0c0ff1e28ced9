"""Labels of a first frame without any prediction: relative positions of points, then a pose fit that must be good.

Departs from thesis section 4.1.3, which sorts the markers of a standing pose by height and side. The subject's own
marker geometry replaces such rules here, for any protocol: the root's markers are found by their distances, the other
segments by the distances of their markers from each other and from the joint, and the pose fitted to these (the least
squares of thesis eq. 4.1 with positions only) predicts the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, AssignmentSettings, Indices, assign
from mbkf.labelling.beam import PartialBody
from mbkf.labelling.beam_search import search_bodies, search_limb
from mbkf.labelling.placing import log_likelihood_ratio
from mbkf.labelling.seeds import Seeds, seeds_in_any_attitude, upright_seeds
from mbkf.labelling.skeleton import clusters, limbs
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import PoseFit, fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor

LEAST_SD_M = 0.010
"""Least spread of a marker: body and person differ."""

MIN_MARKERS = 6
"""Fewer markers do not determine a pose."""

OUTLYING_SDS = 2.5
"""A point further than so many standard deviations from its marker does not take part in the fit."""

DOUBTFUL_SDS = 2.0
"""A limb with a marker further off than so many standard deviations, or without one, is searched again."""

LIMB_CANDIDATES = 3
"""Alternatives of such a limb that are fitted."""


@dataclass(frozen=True)
class FirstFrameSettings:
    """Limits within which a first frame is accepted.

    Attributes:
        rms_m: Greatest RMS distance of the labelled points from the fitted body.
        least_share: Least share of the body's markers that must be found.
        least_explained: Least share of the points that must be labelled, or of the markers where these are fewer.
        candidates: Bodies of the beam search that are fitted.
        rounds: Greatest number of rounds of alternately fitting and assigning.
        radius_m: Radius of the assignment while the pose is rough.
    """

    rms_m: float = 0.025
    least_share: float = 0.6
    least_explained: float = 0.8
    candidates: int = 6
    rounds: int = 6
    radius_m: float = 0.25


@dataclass(frozen=True)
class FirstFrame:
    """A labelled frame.

    Attributes:
        points: (M,) point of every marker, ``HIDDEN`` where none.
        q: (nq,) fitted pose.
        rms_m: RMS distance of the labelled points from it.
        log_ratio: Twice the log-likelihood ratio of its labels and of ghosts only, posture included.
    """

    points: Indices
    q: Array
    rms_m: float
    log_ratio: float

    @property
    def labelled(self) -> int:
        """Number of markers found."""
        return int((self.points != HIDDEN).sum())


class _Fits:
    """Fits of one frame by their first labels: limbs that are searched again often have the same ones."""

    def __init__(self, fitted: Callable[[Array, Indices, None], FirstFrame], points_m: Array) -> None:
        self._fitted, self._points_m = fitted, points_m
        self._found: dict[bytes, FirstFrame] = {}

    def of(self, labels: Indices) -> FirstFrame:
        """Pose and labels from first labels (M,)."""
        key = labels.tobytes()
        if key not in self._found:
            self._found[key] = self._fitted(self._points_m, labels, None)
        return self._found[key]


class FirstFrameSearch:
    """Finds a subject's markers among unlabelled points.

    Attributes:
        sensor: The markers on the subject's body.
        sd_m: (M,) spread of a marker about its place on the body, noise and placement together, m.
        settings: Limits within which a labelled frame is accepted.
    """

    def __init__(self, sensor: MarkerSensor, sd_m: Array, settings: FirstFrameSettings | None = None) -> None:
        self.sensor = sensor
        self.sd_m = np.hypot(sd_m, LEAST_SD_M)
        self.settings = settings or FirstFrameSettings()
        self.posture = PostureSensor(sensor.model)
        self._body = clusters(sensor, self.sd_m)
        self._assignment = AssignmentSettings(radius_m=self.settings.radius_m, near_m=0.0)

    @property
    def fewest_points(self) -> int:
        """Least number of points of a frame that is searched."""
        return max(MIN_MARKERS, int(np.ceil(self.settings.least_share * len(self.sd_m))))

    def upright(self, points_m: Array) -> FirstFrame | None:
        """Labels of points (N, 3) of an upright body of any heading, or None where they do not fit."""
        return self._search(points_m, upright_seeds(self._body[0], points_m))

    def any_attitude(self, points_m: Array) -> FirstFrame | None:
        """The same for a body in any attitude (prone, kneeling); slower, since the root has more candidate poses."""
        return self._search(points_m, seeds_in_any_attitude(self._body[0], points_m))

    def _search(self, points_m: Array, seeds: Seeds) -> FirstFrame | None:
        candidates = search_bodies(self._body, points_m, seeds, self.settings.candidates)
        fits = _Fits(self._fitted, points_m)
        fitted = [fits.of(one.labels) for one in candidates]
        near = [one for one in fitted if one.rms_m <= 2.0 * self.settings.rms_m] or fitted
        if not near:
            return None
        best = self._improved(points_m, max(near, key=lambda one: one.log_ratio), fits)
        return best if self.accepted(best, len(points_m)) else None

    def near_pose(self, points_m: Array, q: Array) -> FirstFrame | None:
        """Labels of points (N, 3) of a body that is nearly in the pose q (nq,), or None."""
        predicted = self.sensor.positions(q)
        near = np.broadcast_to(0.03**2 * np.eye(3), (len(predicted), 3, 3))
        first = assign(predicted, points_m, lambda chosen: near[chosen], self._assignment)
        found = self._fitted(points_m, first, q)
        return found if self.accepted(found, len(points_m)) else None

    def refined(self, points_m: Array, labels: Indices) -> FirstFrame | None:
        """Labels of points (N, 3) from rough ones (M,), which some markers may lack, or None."""
        if np.count_nonzero(labels != HIDDEN) < MIN_MARKERS:
            return None
        fits = _Fits(self._fitted, points_m)
        found = self._improved(points_m, fits.of(labels), fits)
        return found if self.accepted(found, len(points_m)) else None

    def _improved(self, points_m: Array, found: FirstFrame, fits: _Fits) -> FirstFrame:
        """Labels with every doubtful limb searched again from the fitted body, from the fingers and toes inwards."""
        for limb in reversed(limbs(self._body)):
            own = np.concatenate([cluster.markers for cluster in limb])
            shown = labelled_points(points_m, found.points)
            distance = np.linalg.norm(self.sensor.positions(found.q) - shown, axis=1)
            if (distance[own] <= DOUBTFUL_SDS * self.sd_m[own]).all():
                continue
            others = [
                fits.of(one.labels)
                for one in search_limb(points_m, self._placed(found), limb, LIMB_CANDIDATES)
            ]
            found = max(found, *others, key=lambda one: one.log_ratio)
        return found

    def _placed(self, found: FirstFrame) -> PartialBody:
        rotations, origins = self.sensor.model.placements(found.q)
        joints = [self.sensor.model.joint(cluster.segment).joint_id for cluster in self._body]
        return PartialBody(rotations[joints], origins[joints], found.points, 0.0)

    def accepted(self, found: FirstFrame, points: int) -> bool:
        """True where enough markers of a frame with so many points fit well enough."""
        could = min(points, len(found.points))
        enough = found.labelled >= max(self.fewest_points, self.settings.least_explained * could)
        return enough and found.rms_m <= self.settings.rms_m

    def _fitted(self, points_m: Array, labels: Indices, start: Array | None) -> FirstFrame:
        """Pose and labels: fit, assign by the fit's covariance, and again until no label changes."""
        q = start
        for _ in range(self.settings.rounds):
            measured = labelled_points(points_m, labels)
            if q is None:
                q = segment_by_segment(self.sensor, measured)
            fit = self._fit(measured, q)
            distance = np.linalg.norm(self.sensor.positions(fit.q) - measured, axis=1)
            found = FirstFrame(labels, fit.q, fit.rms_m, self.log_ratio(measured, fit.q))
            far = distance > OUTLYING_SDS * self.sd_m
            if far.any() and (~far).sum() >= MIN_MARKERS:
                fit = self._fit(np.where(far[:, None], np.nan, measured), fit.q)
            again = self._assigned(points_m, fit.q, fit.covariance)
            if (again == labels).all():
                break
            labels, q = again, fit.q
        return found

    def log_ratio(self, markers_m: Array, q: Array) -> float:
        """Twice the log-likelihood ratio of markers (M, 3) on a body in pose q (nq,) and ghosts, with the pose's prior.

        Exchanged markers of a wrist fit as well, but turn the forearm by half a turn: its posture is unlikely.
        """
        away = self.sensor.positions(q) - markers_m
        posture = self.posture.reading(q).deviation / self.posture.sd
        return float(np.nansum(log_likelihood_ratio((away**2).sum(axis=1), self.sd_m)) - posture @ posture)

    def _fit(self, measured_m: Array, start: Array) -> PoseFit:
        return fit_pose(self.sensor, self.posture, measured_m, self.sd_m, start, max_iterations=12)

    def _assigned(self, points_m: Array, q: Array, covariance: Array) -> Indices:
        reading = self.sensor.reading(q)

        def spread(chosen: BoolArray) -> Array:
            H = reading.only(chosen).jacobian
            own = self.sd_m[chosen, None, None] ** 2 * np.eye(3)
            return np.asarray((H @ covariance) @ H.transpose(0, 2, 1) + own)

        return assign(reading.positions_m, points_m, spread, self._assignment)


def labelled_points(points_m: Array, labels: Indices) -> Array:
    """(M, 3) the markers' points, NaN where a marker has none."""
    if not len(points_m):
        return np.full((len(labels), 3), np.nan)
    return np.where((labels != HIDDEN)[:, None], points_m[labels], np.nan)
