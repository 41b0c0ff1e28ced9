"""Scaling as one least-squares problem over many frames (thesis eq. 4.1): residuals and analytic derivatives.

Unknowns: the pose x_t of every frame, the independent scale factors k and an offset δ of every marker from its
reference place, shared by all frames. Residuals, each divided by its standard deviation:

    markers    r_b(x, k) + A_b(x) (D_b(k) m̄ + δ) − measured
    placement  δ − δ₀                (tight for anatomical markers, loose for technical ones)
    factors    k − k₀                (bodies are alike in proportion, less so in size)
    posture    joint rotations       (dofs without markers stay near standing, :mod:`mbkf.scaling.usual_posture`)
    upright    inclination of feet and root, where keypoints are scaled from standing (:mod:`mbkf.scaling.standing`)
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel
from mbkf.model.protocol import ProtocolMarker
from mbkf.numerics.levenberg_marquardt import ArrowEquations
from mbkf.scaling.standing import UprightPosture
from mbkf.scaling.usual_posture import UsualPosture
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerSensor
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.scaled_markers import ScaledMarkers, ScaledReading

FACTOR_BOUNDS = (0.5, 1.6)
"""Range of a scale factor; one that ends here is reported as an active bound."""

KEYPOINT_POSTURE_FRAMES = 0.5
"""Number of independent observations of the posture in a moving trial of keypoints: these leave joints so much freedom
that a squat would otherwise be scaled to look like standing."""

OUTLYING_SD = 4.0
"""Least distance of an outlier in standard deviations of its noise: of three coordinates 0.1 % lie further."""


@dataclass(frozen=True)
class ScalingSettings:
    """Weights of the priors of scaling.

    Attributes:
        proportion_sd: Spread of a factor about the person's overall size.
        side_sd: Spread of a factor about the mean of both sides; a person's limbs differ by a hundredth in length.
        stature_sd: Spread of overall size when no height is given.
        known_stature_sd: Spread of overall size when the height is given.
        standing_sd_rad: Spread of a joint's angle about neutral in a static trial, rad.
        static_posture_frames: Number of independent observations of the posture in a static trial.
        dynamic_posture_frames: The same in a dynamic trial.
        dynamic_marker_frames: Number of independent observations of the markers in a dynamic trial: skin moves with the
            posture and not anew in every frame.
        frames_per_trial: Greatest number of frames taken from one trial.
        outlier_m: Distance from the fitted body beyond which a sample is left out, m.
    """

    proportion_sd: float = 0.06
    side_sd: float = 0.015
    stature_sd: float = 0.20
    known_stature_sd: float = 0.02
    standing_sd_rad: float = 0.14
    static_posture_frames: float = 1.0
    dynamic_posture_frames: float = 1.0
    dynamic_marker_frames: float = 15.0
    frames_per_trial: int = 40
    outlier_m: float = 0.06


@dataclass(frozen=True)
class ScalingState:
    """One point of the search: ``poses`` (N, nq), ``factors`` (K,), ``offsets_m`` (M, 3)."""

    poses: Array
    factors: Array
    offsets_m: Array


@dataclass(frozen=True)
class FrameWeights:
    """Weights of N frames.

    Attributes:
        markers: (N,) independent observations of the markers.
        posture: (N,) independent observations of the posture.
        standing: (N,) True where the person stands straight.
        upright: (N,) weight of flat feet and an upright root.
    """

    markers: Array
    posture: Array
    standing: BoolArray
    upright: Array

    @classmethod
    def moving(cls, frames: int, markers: float, posture: float) -> FrameWeights:
        """Frames of a movement.

        Args:
            frames: Number of frames.
            markers: Observations of the markers in all of them, at most one in each.
            posture: The same for the posture.
        """
        of_markers, of_posture = (
            np.full(frames, min(1.0, count / max(1, frames))) for count in (markers, posture)
        )
        return cls(of_markers, of_posture, np.zeros(frames, dtype=bool), np.zeros(frames))


@dataclass(frozen=True)
class ScalingPrior:
    """Prior knowledge of factors and offsets.

    Attributes:
        factors: (K,) expected scale factors k₀.
        factor_covariance: (K, K) their covariance.
        offsets_m: (M, 3) expected offsets δ₀ of the markers.
        offset_precision: (3 M, 3 M) inverse covariance of the offsets, 1/m², marker by marker.
    """

    factors: Array
    factor_covariance: Array
    offsets_m: Array
    offset_precision: Array


@dataclass(frozen=True)
class _Shown:
    """Errors of N frames of M markers with derivatives, whitened; 0 where a marker is missing.

    Attributes:
        errors: (N, M, 3) modelled minus measured.
        by_pose: (N, M, 3, nv) derivative by the frame's pose.
        by_factors: (N, M, 3, K) by the scale factors.
        axes: (N, M, 3, 3) by the marker's own offset.
    """

    errors: Array
    by_pose: Array
    by_factors: Array
    axes: Array


class ScalingProblem:
    """Residuals of N frames of M markers.

    Attributes:
        body: The reference body.
        markers: The M protocol markers.
        measured_m: (N, M, 3) measured positions, NaN where missing.
        weights: Weights of the frames.
        prior: Prior of factors and offsets.
        standing_sd_rad: Spread of a joint's angle about neutral in straight standing.
        seen: (N, M) True where a marker is present.
    """

    def __init__(
        self,
        body: BodyDescription,
        markers: tuple[ProtocolMarker, ...],
        measured_m: Array,
        weights: FrameWeights,
        prior: ScalingPrior,
        standing_sd_rad: float = ScalingSettings.standing_sd_rad,
    ) -> None:
        self.body, self.markers, self.prior, self.weights = body, markers, prior, weights
        self.measured_m = read_only(measured_m)
        self.seen = np.asarray(~np.isnan(self.measured_m).any(axis=2))
        self.noise_m = np.array([m.noise_m for m in markers])
        self.reference_m = np.array([m.position_m for m in markers])
        self.segments = tuple(m.segment for m in markers)
        self.factor_root = np.linalg.cholesky(np.linalg.inv(prior.factor_covariance)).T
        self._segment_scale = np.array([body.segment(name).scale_matrix for name in self.segments])
        model = HumanModel.scaled(body=body)
        self.posture = PostureSensor(model)
        self._usual = UsualPosture(self.posture, standing_sd_rad)
        self._upright = UprightPosture(model)
        self._worn = ScaledMarkers(model, self.segments, self.reference_m)
        self._information = MarkerInformation(self._worn.sensor, self.noise_m)

    def start(self, poses: Array) -> ScalingState:
        """State with the prior's factors and offsets."""
        return ScalingState(poses, self.prior.factors, self.prior.offsets_m)

    def local_m(self, factors: Array, offsets_m: Array) -> Array:
        """(M, 3) marker positions in their segments' frames: D_b(k) m̄ + δ."""
        return np.einsum("mak,k->ma", self._segment_scale, factors) * self.reference_m + offsets_m

    def places_by_factors_and_offsets(self) -> Array:
        """(K + 3 M, K + 3 M) derivative of (factors, marker places) by (factors, offsets)."""
        count = len(self.body.scale_factors)
        derivative = np.eye(count + 3 * len(self.markers))
        derivative[count:, :count] = self.places_by_factors().reshape(-1, count)
        return derivative

    def places_by_factors(self) -> Array:
        """(M, 3, K) derivative of :meth:`local_m` by the factors."""
        return np.asarray(self.reference_m[:, :, None] * self._segment_scale)

    def sensor(self, state: ScalingState) -> MarkerSensor:
        """The markers on the body of a state."""
        model = HumanModel(self.body, state.factors, self.body.reference_mass_kg)
        return MarkerSensor(model, self.segments, self.local_m(state.factors, state.offsets_m))

    def errors_m(self, state: ScalingState) -> Array:
        """(N, M, 3) modelled minus measured, NaN where a marker is missing."""
        return self._worn.places(state.poses, state.factors, state.offsets_m) - self.measured_m

    def outliers(self, state: ScalingState, limit_m: float) -> BoolArray:
        """(N, M) samples further than a limit from the fitted body, and further than their noise explains."""
        limit = np.maximum(limit_m, OUTLYING_SD * self.noise_m)
        return np.nan_to_num(np.linalg.norm(self.errors_m(state), axis=2)) > limit

    def without(self, samples: BoolArray) -> ScalingProblem:
        """The same problem without some samples (N, M)."""
        kept = np.where(samples[:, :, None], np.nan, self.measured_m)
        return self.with_measurements(kept)

    def with_measurements(self, measured_m: Array) -> ScalingProblem:
        """The same problem with other samples (N, M, 3)."""
        other = copy(self)
        other.measured_m = read_only(measured_m)
        other.seen = np.asarray(~np.isnan(other.measured_m).any(axis=2))
        return other

    def with_prior(self, prior: ScalingPrior) -> ScalingProblem:
        """The same problem with another prior."""
        other = copy(self)
        other.prior = prior
        other.factor_root = np.linalg.cholesky(np.linalg.inv(prior.factor_covariance)).T
        return other

    def cost(self, state: ScalingState) -> float:
        """Sum of squared residuals."""
        errors = np.where(self.seen[:, :, None], self.errors_m(state), 0.0) / self.noise_m[:, None]
        markers = float(self.weights.markers @ (errors**2).sum(axis=(1, 2)))
        return markers + self._shared_cost(state) + self._posture_cost(state)

    def _posture_cost(self, state: ScalingState) -> float:
        total = 0.0
        for t, q in enumerate(state.poses):
            if self.weights.posture[t]:
                total += self.weights.posture[t] * self._usual.cost(q, bool(self.weights.standing[t]))
            if self.weights.upright[t]:
                tilt = self._upright.residuals(self.posture.model, q)
                total += self.weights.upright[t] * float(tilt @ tilt)
        return total

    def _shared_cost(self, state: ScalingState) -> float:
        factors = self.factor_root @ (state.factors - self.prior.factors)
        offsets = (state.offsets_m - self.prior.offsets_m).ravel()
        return float((factors**2).sum() + offsets @ self.prior.offset_precision @ offsets)

    def move(self, state: ScalingState, own: Array, shared: Array) -> ScalingState:
        """The state after a step; factors stay inside their bounds.

        Args:
            state: Before the step.
            own: (N, nv) step of each frame's pose, in the tangent space.
            shared: (s,) step of factors and offsets.
        """
        model = self.posture.model
        count = len(self.body.scale_factors)
        poses = np.array([model.integrate(q, dq) for q, dq in zip(state.poses, own, strict=True)])
        factors = np.clip(state.factors + shared[:count], *FACTOR_BOUNDS)
        return ScalingState(poses, factors, state.offsets_m + shared[count:].reshape(-1, 3))

    def linearise(self, state: ScalingState) -> ArrowEquations:
        """Gauss–Newton equations; frames border only factors and offsets."""
        reading = self._worn.reading(state.poses, state.factors, state.offsets_m)
        shown = self._shown(reading)
        frames, frame_gradient = self._frame_equations(state, reading)
        count, (poses, markers, _, nv) = len(self.body.scale_factors), shown.by_pose.shape
        across = shown.by_pose.reshape(poses, -1, nv).swapaxes(1, 2)
        border = np.empty((poses, nv, count + 3 * markers))
        border[:, :, :count] = across @ shown.by_factors.reshape(poses, -1, count)
        # a marker's offset moves that marker only: (nv, 3) (3, 3) for each, not (nv, 3 M) (3 M, 3 M)
        by_offset = shown.by_pose.swapaxes(2, 3) @ shown.axes
        border[:, :, count:].reshape(poses, nv, markers, 3)[:] = by_offset.swapaxes(1, 2)
        corner, corner_gradient = self._prior_equations(state)
        self._add_shared(shown, corner, corner_gradient)
        cost = float((shown.errors**2).sum()) + self._shared_cost(state) + self._posture_cost(state)
        return ArrowEquations(frames, border, corner, frame_gradient, corner_gradient, cost)

    def _frame_equations(self, state: ScalingState, reading: ScaledReading) -> tuple[Array, Array]:
        """(N, nv, nv) matrices and (N, nv) gradients of the poses."""
        nv, weights = self.posture.model.nv, self.weights
        frames, gradient = np.empty((len(state.poses), nv, nv)), np.empty((len(state.poses), nv))
        for t, (q, seen) in enumerate(zip(state.poses, reading.markers, strict=True)):
            known = self._information.at(seen, self.measured_m[t] - seen.positions_m, self.seen[t])
            usual, pull = self._usual.equations(q, bool(weights.standing[t]))
            frames[t] = weights.markers[t] * known.matrix + weights.posture[t] * usual + 1e-9 * np.eye(nv)
            gradient[t] = weights.posture[t] * pull - weights.markers[t] * known.vector
            if weights.upright[t]:
                tilt, by_tilt = self._upright.linearised(self.posture.model, q)
                frames[t] += weights.upright[t] * (by_tilt.T @ by_tilt)
                gradient[t] += weights.upright[t] * (by_tilt.T @ tilt)
        return frames, gradient

    def _add_shared(self, shown: _Shown, corner: Array, gradient: Array) -> None:
        """Adds the markers' terms of factors and offsets: the offsets of two markers have no term in common."""
        count, markers = len(self.body.scale_factors), np.arange(len(self.markers))
        flat = shown.by_factors.reshape(-1, count)
        corner[:count, :count] += flat.T @ flat
        gradient[:count] += shown.errors.ravel() @ flat
        back = np.swapaxes(shown.axes, 2, 3)
        across = np.swapaxes((back @ shown.by_factors).sum(axis=0).reshape(-1, count), 0, 1)
        corner[:count, count:] += across
        corner[count:, :count] += across.T
        offsets = corner[count:, count:].reshape(len(markers), 3, len(markers), 3)
        offsets[markers, :, markers] += (back @ shown.axes).sum(axis=0)
        gradient[count:] += (back @ shown.errors[..., None]).sum(axis=0).ravel()

    def _prior_equations(self, state: ScalingState) -> tuple[Array, Array]:
        count = len(self.body.scale_factors)
        shared = count + state.offsets_m.size
        corner, gradient = np.zeros((shared, shared)), np.zeros(shared)
        information = self.factor_root.T @ self.factor_root
        corner[:count, :count] = information
        gradient[:count] = information @ (state.factors - self.prior.factors)
        corner[count:, count:] = self.prior.offset_precision
        gradient[count:] = self.prior.offset_precision @ (state.offsets_m - self.prior.offsets_m).ravel()
        return corner, gradient

    def _shown(self, reading: ScaledReading) -> _Shown:
        """Whitened errors of all frames and their derivatives."""
        whiten = np.where(self.seen, np.sqrt(self.weights.markers)[:, None] / self.noise_m, 0.0)[..., None]
        errors = np.array([one.positions_m for one in reading.markers]) - self.measured_m
        by_pose = np.array([one.jacobian for one in reading.markers])
        by_pose *= whiten[..., None]
        return _Shown(
            np.where(self.seen[..., None], errors, 0.0) * whiten,
            by_pose,
            reading.by_factors * whiten[..., None],
            reading.axes * whiten[..., None],
        )
