"""Scaling as one least-squares problem over many frames; departs from thesis eq. 4.1 in weights and priors.

Unknowns: the pose x_t of every frame, the independent scale factors k, an offset δ of every marker from its reference
place and its displacements c_d by flexion (:mod:`mbkf.sensors.flexed_skin`), shared by all frames, and by those of a
trial the shoulders' displacement h (:mod:`mbkf.sensors.shoulder_girdle`). Residuals, each divided by its standard
deviation:

    markers    r_b(x, k) + A_b(x) (D_b(k) m̄ + δ + Σ_d f_d(x) c_d) + w A_trunk(x) h − measured
    placement  δ − δ₀                (tight for anatomical markers, loose for technical ones)
    skin       c_d − c₀_d            (markers of a segment move together, for the most part)
    shoulders  h − h₀                (they rise with the arms)
    factors    k − k₀                (bodies are alike in proportion, less so in size)
    posture    joint rotations       (dofs without markers stay near standing, :mod:`mbkf.scaling.usual_posture`)
    upright    inclination of feet and root, where keypoints are scaled from standing (:mod:`mbkf.scaling.standing`)
"""

from __future__ import annotations

from copy import copy
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel
from mbkf.model.protocol import ProtocolMarker
from mbkf.numerics.elimination import Border
from mbkf.numerics.levenberg_marquardt import ArrowEquations
from mbkf.scaling.records import FrameWeights, ScalingPrior, ScalingSettings, ScalingState, ShownMarkers
from mbkf.scaling.shoulders import TrialShoulders, without_shoulders
from mbkf.scaling.standing import UprightPosture
from mbkf.scaling.usual_posture import Turned, UsualPosture
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.scaled_markers import ScaledMarkers

FACTOR_BOUNDS = (0.5, 1.6)
"""Range of a scale factor; one that ends here is reported as an active bound."""

KEYPOINT_POSTURE_FRAMES = 0.5
"""Number of independent observations of the posture in a moving trial of keypoints: these leave joints so much freedom
that a squat would otherwise be scaled to look like standing."""

MOST_TURNED_RAD = 1.0
"""Greatest rotation of a joint in one step, rad. A joint that early steps turn more than once, as toes with a single
marker, takes many steps to turn back."""

OUTLYING_SD = 4.0
"""Least distance of an outlier in standard deviations of its noise: of three coordinates 0.1 % lie further."""


class ScalingProblem:
    """Residuals of N frames of M markers.

    Attributes:
        body: The reference body.
        markers: The M protocol markers.
        measured_m: (N, M, 3) measured positions, NaN where missing.
        weights: Weights of the frames.
        prior: Prior of factors, offsets and displacements.
        skin: Shares of the displacements in the markers' places.
        standing_sd_rad: Spread of a joint's angle about neutral in straight standing.
        centres_m: (E,) displacements of joint centres (:mod:`mbkf.model.joint_centres`); 0 where they are not known.
        seen: (N, M) True where a marker is present.
        trial: (N,) number of the trial of each frame; all are of one trial by default.
        shoulders: The shoulders, displaced in each trial.
    """

    def __init__(
        self,
        body: BodyDescription,
        markers: tuple[ProtocolMarker, ...],
        measured_m: Array,
        weights: FrameWeights,
        prior: ScalingPrior,
        standing_sd_rad: float = ScalingSettings.standing_sd_rad,
        centres_m: Array | None = None,
        trial: NDArray[np.intp] | None = None,
    ) -> None:
        self._centres_m = centres_m
        self.body, self.markers, self.prior, self.weights = body, markers, prior, weights
        self.measured_m = read_only(measured_m)
        self.seen = np.asarray(~np.isnan(self.measured_m).any(axis=2))
        self.noise_m = np.array([m.noise_m for m in markers])
        self.reference_m = np.array([m.position_m for m in markers])
        self.segments = tuple(m.segment for m in markers)
        self._precision = prior.precision
        self._segment_scale = np.array([body.segment(name).scale_matrix for name in self.segments])
        model = self._model(np.ones(len(body.scale_factors)))
        self.posture = PostureSensor(model)
        self.skin = FlexedSkin(model, self.segments)
        self._usual = UsualPosture(self.posture, standing_sd_rad)
        self._upright = UprightPosture(model)
        self._worn = ScaledMarkers(model, self.segments, self.reference_m)
        self._last: tuple[ScalingState, ShownMarkers, ArrowEquations] | None = None
        self._turns: Turned | None = None
        every = np.zeros(len(self.measured_m), dtype=np.intp)
        self.shoulders = TrialShoulders(self._worn.girdle, every if trial is None else trial)

    def _model(self, factors: Array) -> HumanModel:
        return HumanModel(self.body, factors, self.body.reference_mass_kg, centres_m=self._centres_m)

    def start(self, poses: Array) -> ScalingState:
        """State with the prior's factors, offsets and displacements."""
        prior = self.prior
        return ScalingState(poses, prior.factors, prior.offsets_m, prior.slides_m, prior.girdle_m)

    def start_from(self, state: ScalingState) -> ScalingState:
        """A state of a problem with another number of flexions, with the prior's displacements."""
        return replace(state, slides_m=self.prior.slides_m)

    def local_m(self, factors: Array, offsets_m: Array) -> Array:
        """(M, 3) marker positions in their segments' frames: D_b(k) m̄ + δ."""
        return np.einsum("mak,k->ma", self._segment_scale, factors) * self.reference_m + offsets_m

    def places_by_unknowns(self) -> Array:
        """(K + 3 M (1 + D), …) derivative of (factors, places, displacements) by (factors, offsets, displacements)."""
        count, places = len(self.body.scale_factors), 3 * len(self.markers)
        derivative = np.eye(count + places * (1 + self.prior.flexions))
        derivative[count : count + places, :count] = self.places_by_factors().reshape(-1, count)
        return derivative

    def places_by_factors(self) -> Array:
        """(M, 3, K) derivative of :meth:`local_m` by the factors."""
        return np.asarray(self.reference_m[:, :, None] * self._segment_scale)

    def sensor(self, state: ScalingState) -> MarkerSensor:
        """The markers on the body of a state."""
        model = self._model(state.factors)
        return MarkerSensor(model, self.segments, self.local_m(state.factors, state.offsets_m))

    def errors_m(self, state: ScalingState) -> Array:
        """(N, M, 3) modelled minus measured, NaN where a marker is missing."""
        moved = self._displacements_m(state, self._shares(state))
        raised = self.shoulders.displaced_m(state.girdle_m)
        return self._worn.places(state.poses, state.factors, moved, raised) - self.measured_m

    def with_shoulders(self, poses: Array, standing: Array | None = None) -> ScalingProblem:
        """The problem with a displacement of each shoulder in each trial with raised arms, with a prior by elevation.

        Args:
            poses: (N, nq) configurations.
            standing: (nq,) that in which the person was scaled before.
        """
        shoulders = self.shoulders.raised(poses, standing)
        other = self.with_prior(shoulders.expected(self.prior, self.body, poses))
        other.shoulders = shoulders
        return other

    def usual_shares(self, poses: Array) -> Array:
        """(D, M) mean share of each displacement in the frames (N, nq) that show the marker."""
        seen = np.maximum(self.seen, 1e-9)
        shares = self.skin.shares_of(self._turned(poses).deviations)[:, :, : len(self.prior.slides_m)]
        return np.asarray((np.moveaxis(shares, 2, 0) * seen).sum(axis=1) / seen.sum(axis=0))

    def _turned(self, poses: Array) -> Turned:
        """Turns of the joints, kept for the next call: cost and derivatives need those of the same configurations."""
        if self._turns is None or self._turns.poses is not poses:
            deviations, jacobians = zip(*(self.posture.deviation(q) for q in poses), strict=True)
            self._turns = Turned(poses, np.array(deviations), jacobians)
        return self._turns

    def _shares(self, state: ScalingState) -> Array:
        """(1 + D, N, M) 1 and f of N configurations."""
        one = np.ones((1, len(state.poses), len(self.markers)))
        if not self.prior.flexions and not self.prior.slides_m.any():
            return one
        found = self.skin.shares_of(self._turned(state.poses).deviations)
        return np.concatenate([one, np.moveaxis(found, 2, 0)])

    def _displacements_m(self, state: ScalingState, shares: Array) -> Array:
        """(N, M, 3) δ + Σ_d f_d c_d; (M, 3) without displacements."""
        if not state.slides_m.any():
            return state.offsets_m
        return state.offsets_m + np.einsum("dtm,dmi->tmi", shares[1:], state.slides_m)

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
        other._last = None
        return other

    def of_frames(self, chosen: NDArray[np.intp]) -> ScalingProblem:
        """A problem on some of these frames.

        Args:
            chosen: Their numbers.
        """
        other = self.with_measurements(self.measured_m[chosen])
        other.shoulders = self.shoulders.of_frames(chosen)
        other.weights = FrameWeights(
            *(getattr(self.weights, one.name)[chosen] for one in fields(FrameWeights))
        )
        return other

    def with_prior(self, prior: ScalingPrior) -> ScalingProblem:
        """The same problem with another prior."""
        other = copy(self)
        other.prior = prior
        other._precision = prior.precision
        if (prior.flexions, prior.raised) != (self.prior.flexions, self.prior.raised):
            other._last = None
        return other

    def cost(self, state: ScalingState) -> float:
        """Sum of squared residuals."""
        errors = np.where(self.seen[:, :, None], self.errors_m(state), 0.0) / self.noise_m[:, None]
        markers = float(self.weights.markers @ (errors**2).sum(axis=(1, 2)))
        away = self.prior.away(state)
        return markers + float(away @ self._precision @ away) + self._posture_cost(state)

    def _posture_cost(self, state: ScalingState) -> float:
        weights, turns = self.weights, self._turned(state.poses).deviations
        total = float(weights.posture @ self._usual.costs(turns, weights.standing))
        for t in np.flatnonzero(weights.upright):
            tilt = self._upright.residuals(self.posture.model, state.poses[t])
            total += weights.upright[t] * float(tilt @ tilt)
        return total

    def move(self, state: ScalingState, own: Array, shared: Array) -> ScalingState:
        """The state after a step; factors stay inside their bounds, and a frame's joints turn by a radian at most.

        Args:
            state: Before the step.
            own: (N, nv) step of each frame's pose, in the tangent space.
            shared: (s,) step of factors, shoulders, offsets and displacements by flexion.
        """
        model = self.posture.model
        largest = np.abs(own[:, model.root.v.stop :]).max(axis=1, initial=0.0)
        own = own * np.minimum(1.0, MOST_TURNED_RAD / np.maximum(largest, 1e-12))[:, None]
        count = len(state.factors)
        first = count + self.prior.raised
        end = first + state.offsets_m.size
        return ScalingState(
            np.array([model.integrate(q, dq) for q, dq in zip(state.poses, own, strict=True)]),
            np.clip(state.factors + shared[:count], *FACTOR_BOUNDS),
            state.offsets_m + shared[first:end].reshape(state.offsets_m.shape),
            state.slides_m + shared[end:].reshape(state.slides_m.shape)
            if self.prior.flexions
            else state.slides_m,
            state.girdle_m + shared[count:first] if self.prior.raised else state.girdle_m,
        )

    def linearise(self, state: ScalingState) -> ArrowEquations:
        """Gauss–Newton equations; frames border only what they share."""
        _, data = self._by_data(state)
        return self._with_prior(data, self._precision, self.prior.away(state))

    def reduced_data(self, state: ScalingState) -> tuple[Array, Array]:
        """Information of the data on what frames share, without a prior, and its gradient, frames eliminated."""
        return self._by_data(state)[1].reduced()

    def information(self, state: ScalingState) -> Array:
        """(K + E + 3 M (1 + D), …) information on factors, joint centres, offsets and displacements by flexion.

        Frames and shoulders are eliminated. That on the centres is the data's alone, without a prior.
        """
        count, (shown, data) = len(self.body.scale_factors), self._by_data(state)
        by_centres = self._by_centres(state)
        by_size = np.split(shown.by_factors, [count], axis=3)
        shown = replace(shown, by_factors=np.concatenate([by_size[0], by_centres, by_size[1]], axis=3))
        centres = by_centres.shape[3]
        precision = block_diag(
            self._precision[:count, :count], np.zeros((centres, centres)), self._precision[count:, count:]
        )
        away = np.insert(self.prior.away(state), [count] * centres, 0.0)
        data = self._equations(shown, data.frames, data.frame_gradient, data.cost)
        found = self._with_prior(data, precision, away).schur_complement()
        return without_shoulders(found, self.prior, count + centres)

    def _by_data(self, state: ScalingState) -> tuple[ShownMarkers, ArrowEquations]:
        """Whitened errors, and the equations without prior; kept for the next call, often with another prior."""
        if self._last is None or self._last[0] is not state:
            shown = self.shown(state)
            cost = float((shown.errors**2).sum()) + self._posture_cost(state)
            equations = self._equations(shown, *self._frame_equations(state, shown), cost)
            self._last = state, shown, equations
        return self._last[1:]

    @staticmethod
    def _with_prior(data: ArrowEquations, precision: Array, away: Array) -> ArrowEquations:
        """Equations with a prior's precision on what frames share, ``away`` from its mean."""
        pull = precision @ away
        return replace(
            data,
            corner=data.corner + precision,
            corner_gradient=data.corner_gradient + pull,
            cost=data.cost + float(away @ pull),
        )

    def _by_centres(self, state: ScalingState) -> Array:
        """(N, M, 3, E) whitened derivatives of the markers by displacements of joint centres."""
        return self._worn.by_centres(state.poses) * self._whiten()[..., None]

    def _equations(
        self, shown: ShownMarkers, frames: Array, frame_gradient: Array, cost: float
    ) -> ArrowEquations:
        """Gauss–Newton equations of frames and of unknowns without prior."""
        count, (poses, markers, _, nv) = shown.by_factors.shape[3], shown.by_pose.shape
        columns = np.empty((poses, count + 3 * markers, nv))
        by_factors = shown.by_factors.reshape(poses, -1, count).swapaxes(1, 2)
        np.matmul(by_factors, shown.by_pose.reshape(poses, -1, nv), out=columns[:, :count])
        # a marker's offset moves that marker only: (3, 3) (3, nv) for each, not (3 M, 3 M) (3 M, nv)
        by_offset = columns[:, count:].reshape(poses, markers, 3, nv)
        np.matmul(np.swapaxes(shown.axes, 2, 3), shown.by_pose, out=by_offset)
        # its displacements by flexion move it as the offset does, by their shares
        kinds = len(shown.shares)
        of = np.concatenate([np.arange(count), *[np.arange(count, count + 3 * markers)] * kinds])
        factors = None
        if kinds > 1:
            shares = np.repeat(np.moveaxis(shown.shares, 0, 1), 3, axis=2).reshape(poses, -1)
            factors = np.concatenate([np.ones((poses, count)), shares], axis=1)
        corner, gradient = np.zeros((len(of), len(of))), np.zeros(len(of))
        self._add_shared(shown, corner, gradient)
        border = Border(columns.swapaxes(1, 2), of, factors)
        return ArrowEquations(frames, border, corner, frame_gradient, gradient, cost)

    def _frame_equations(self, state: ScalingState, shown: ShownMarkers) -> tuple[Array, Array]:
        """(N, nv, nv) matrices and (N, nv) gradients of the poses."""
        nv, weights = self.posture.model.nv, self.weights
        flat = shown.by_pose.reshape(len(state.poses), -1, nv)
        frames = flat.swapaxes(1, 2) @ flat + 1e-9 * np.eye(nv)
        gradient = (shown.errors.reshape(len(flat), 1, -1) @ flat)[:, 0]
        turned = self._turned(state.poses)
        for t, (deviation, jacobian) in enumerate(zip(turned.deviations, turned.jacobians, strict=True)):
            usual, pull = self._usual.equations(deviation, jacobian, bool(weights.standing[t]))
            frames[t] += weights.posture[t] * usual
            gradient[t] += weights.posture[t] * pull
            if weights.upright[t]:
                tilt, by_tilt = self._upright.linearised(self.posture.model, state.poses[t])
                frames[t] += weights.upright[t] * (by_tilt.T @ by_tilt)
                gradient[t] += weights.upright[t] * (by_tilt.T @ tilt)
        return frames, gradient

    def _add_shared(self, shown: ShownMarkers, corner: Array, gradient: Array) -> None:
        """Adds the markers' terms of what frames share: offsets of two markers have no term in common."""
        count, markers = shown.by_factors.shape[3], np.arange(len(self.markers))
        flat = shown.by_factors.reshape(-1, count)
        corner[:count, :count] += flat.T @ flat
        gradient[:count] += shown.errors.ravel() @ flat
        back = np.swapaxes(shown.axes, 2, 3)
        kinds, frames = len(shown.shares), len(shown.errors)
        by_kind = shown.shares.reshape(kinds, frames, -1, 1, 1)
        across = np.array([(one * (back @ shown.by_factors)).sum(axis=0) for one in by_kind]).reshape(
            -1, count
        )
        corner[count:, :count] += across
        corner[:count, count:] += across.T
        pulls = back @ shown.errors[..., None]
        gradient[count:] += np.array([(one * pulls).sum(axis=0) for one in by_kind]).ravel()
        places = corner[count:, count:].reshape(kinds, len(markers), 3, kinds, len(markers), 3)
        own = back @ shown.axes
        for i in range(kinds):
            for j in range(kinds):
                places[i, markers, :, j, markers] += (by_kind[i] * by_kind[j] * own).sum(axis=0)

    def _whiten(self) -> Array:
        """(N, M, 1) root of a marker's weight over its noise; 0 where it is missing."""
        return np.where(self.seen, np.sqrt(self.weights.markers)[:, None] / self.noise_m, 0.0)[..., None]

    def shown(self, state: ScalingState) -> ShownMarkers:
        """Whitened errors of all frames and their derivatives."""
        shares = self._shares(state)
        moved = self._displacements_m(state, shares)
        reading = self._worn.reading(
            state.poses, state.factors, moved, self.shoulders.displaced_m(state.girdle_m)
        )
        whiten = self._whiten()
        errors = np.array([one.positions_m for one in reading.markers]) - self.measured_m
        by_pose = np.array([one.jacobian for one in reading.markers])
        if state.slides_m.any():
            displaced = reading.axes @ np.moveaxis(state.slides_m, 0, 2)
            self.skin.add_by_poses(by_pose, displaced, *self._turned(state.poses)[1:])
        by_factors = reading.by_factors
        if self.prior.raised:
            by_factors = np.concatenate([by_factors, self.shoulders.by_displacements(reading.trunks)], axis=3)
        by_pose *= whiten[..., None]
        return ShownMarkers(
            np.where(self.seen[..., None], errors, 0.0) * whiten,
            by_pose,
            by_factors * whiten[..., None],
            reading.axes * whiten[..., None],
            shares[: 1 + self.prior.flexions],
        )
