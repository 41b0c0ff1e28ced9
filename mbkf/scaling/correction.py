"""Local marker correction on the trial itself (thesis section 4.1.1): markers sit a little elsewhere in every session.

Skin shifts between standing with spread arms and walking, and markers are attached anew. With the scale factors fixed,
each marker's offset in its segment is found anew over frames of the whole trial, near its place in the subject file.
Displacements by flexion stay as scaling found them; the place of a marker is that in the trial's usual posture.
Shoulders are displaced as they are held in the trial (:mod:`mbkf.sensors.shoulder_girdle`), with the markers there.

Departs from thesis section 4.1.1, which takes each marker's mean place in its segment.
A trial does not separate a rigid displacement of all markers of a segment from another pose of that segment. Left to
the offsets of single markers, it would move joint centres by a centimetre, and torques with them. On the segments
between plates and pelvis it therefore has a prior near the static trial, where bones were marked.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotConverged
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body, scale_of
from mbkf.model.joint_centres import centres_of
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.model.subject_covariance import covariance_of
from mbkf.numerics.levenberg_marquardt import minimise
from mbkf.scaling.covariance import corrected_covariance
from mbkf.scaling.evidence import learnt_prior
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.problem import KEYPOINT_POSTURE_FRAMES, ScalingProblem
from mbkf.scaling.records import FrameWeights, ScalingPrior, ScalingState
from mbkf.scaling.trial_lengths import LengthEvidence, length_evidence
from mbkf.sensors.flexed_skin import flexions_of, slide_covariance
from mbkf.sensors.pose_fit import segment_by_segment
from mbkf.sensors.shoulder_girdle import OWN_M, around_shoulders, shoulder_names

FRAMES, FEW_FRAMES = 40, 12
"""Frames of a trial that markers are corrected on, and that show its lengths where they are not."""

OBSERVATIONS = 10.0
"""Effective number of independent readings of a marker in the frames of one trial (skin moves slowly)."""

POSTURE_OBSERVATIONS = 1.0
"""The same for the posture: the mean posture of a movement is as far from neutral as one posture is."""

OUTLIER_M = 0.06
"""Distance from the fitted body beyond which a sample is a wrong point and left out."""

COMMON_SD_M = 0.003
"""Spread of a steady segment's markers in each of the six directions of a rigid displacement."""

MOVED_M = 0.01
"""Distance beyond which a marker was attached anew, or exchanged, and does not count for the common displacement."""

FIXED_FACTOR_SD = 1e-5

KNOWN_SKIN = 0.01
"""Spread of a trial's displacements by flexion about the subject's, over that of the body file, for the covariance: one
trial does not separate them from its poses, and a person's skin moves alike in all trials."""


class Correction(NamedTuple):
    """A correction: the subject with the marker positions of the trial, and the trial's segment lengths."""

    subject: Subject
    lengths: LengthEvidence


def correct_markers(subject: Subject, trial: MarkerTrajectories) -> Subject:
    """The subject with the marker positions of this trial: :func:`correction` without the lengths."""
    return correction(subject, trial).subject


def trial_lengths(subject: Subject, trial: MarkerTrajectories, frames: int = FEW_FRAMES) -> LengthEvidence:
    """Segment lengths of a trial, or of a part of it, against those of a subject whose markers are not corrected.

    Args:
        subject: A scaled subject.
        trial: Markers under the subject's own names.
        frames: Number of frames that are looked at.

    Raises:
        NotObservable: Too few of the subject's markers are in the trial.
        NotConverged: Most of them do not fit the body.
    """
    return length_evidence(subject, *_fitted(subject, trial, frames))


def correction(subject: Subject, trial: MarkerTrajectories) -> Correction:
    """The subject with the marker positions of this trial; markers not in the trial keep theirs.

    Args:
        subject: A scaled subject.
        trial: Markers under the subject's own names.

    Raises:
        NotObservable: Too few of the subject's markers are in the trial.
        NotConverged: Most of them do not fit the body.
    """
    problem, state = _fitted(subject, trial, FRAMES)
    local = problem.local_m(state.factors, state.offsets_m)
    if state.girdle_m.size:
        local += problem.shoulders.girdle.on_trunk @ state.girdle_m.reshape(-1, 3)
    shares = problem.usual_shares(state.poses)
    before = covariance_of(subject, problem.body)
    if before is not None:
        before = _corrected(before, problem, state)
    found = {
        marker.name: (position, problem.prior.slides_m[:, m], shares[:, m])
        for m, (marker, position) in enumerate(zip(problem.markers, local, strict=True))
    }
    centres = _centres(subject, problem.body, state)
    markers = tuple(_moved(m, found) for m in subject.markers)
    corrected = replace(subject, markers=markers, covariance=before, joint_centres_m=centres)
    return Correction(corrected, length_evidence(subject, problem, state))


def _fitted(subject: Subject, trial: MarkerTrajectories, frames: int) -> tuple[ScalingProblem, ScalingState]:
    """The problem with spreads learnt from the trial, without outliers, and its solution."""
    problem = _problem(subject, trial, frames)
    sensor = problem.sensor(problem.start(np.zeros((0, problem.posture.model.nq))))
    poses = segment_by_segment(sensor, problem.measured_m)
    problem = problem.with_shoulders(poses, subject.standing_q)
    state = problem.start(poses)
    solution = minimise(state, problem.linearise, problem.cost, problem.move, tolerance=1e-3)
    state = solution.state
    outliers = problem.outliers(state, OUTLIER_M)
    if outliers.sum() > 0.5 * problem.seen.sum():
        raise NotConverged(
            f"most markers do not fit the subject's body within {1e3 * OUTLIER_M:.0f} mm; check that subject and trial "
            "belong together, and unit and axes (--unit, --up)"
        )
    moved = np.linalg.norm(state.offsets_m, axis=1) > MOVED_M
    if outliers.any() or moved.any():
        precision = _offset_precision(problem.markers, subject, problem.body, ~moved)
        problem = _with_precision(problem.without(outliers), precision)
        solution = minimise(state, problem.linearise, problem.cost, problem.move, tolerance=1e-3)
        state = solution.state
    learnt = learnt_prior(problem, state, solution.equations.schur_complement())
    problem = _with_precision(problem, learnt.offset_precision)
    solution = minimise(state, problem.linearise, problem.cost, problem.move, tolerance=1e-3)
    return problem, solution.state


def _centres(subject: Subject, body: BodyDescription, state: ScalingState) -> dict[str, float]:
    """Displacements of the joints' centres with those of the shoulders in the trial."""
    found = dict(subject.joint_centres_m)
    if not state.girdle_m.size:
        return found
    for name, moved in zip(shoulder_names(body), state.girdle_m.tolist(), strict=True):
        found[name] = found.get(name, 0.0) + moved
    return found


def _corrected(before: BodyCovariance, problem: ScalingProblem, state: ScalingState) -> BodyCovariance:
    """The covariance after correction: displacements by flexion, fixed in the fit, err as scaling left them."""
    covariance = KNOWN_SKIN**2 * slide_covariance(problem.body, problem.segments)
    if len(problem.prior.slides_m):
        problem = problem.with_prior(replace(problem.prior, slide_precision=np.linalg.inv(covariance[0])))
    return corrected_covariance(before, problem, problem.information(state))


def _moved(marker: SubjectMarker, found: dict[str, tuple[Array, Array, Array]]) -> SubjectMarker:
    """A marker at its place in the usual posture of a trial; one that is not in the trial keeps its own."""
    if marker.name not in found:
        return marker
    place, slides, shares = found[marker.name]
    return replace(marker, position_m=place + shares @ slides, slides_m=slides, slid=shares)


def _with_precision(problem: ScalingProblem, offset_precision: Array) -> ScalingProblem:
    return problem.with_prior(replace(problem.prior, offset_precision=offset_precision))


def _problem(subject: Subject, trial: MarkerTrajectories, most_frames: int) -> ScalingProblem:
    """Scaling with fixed factors: poses and offsets only, each marker near its place in the subject file."""
    body = reference_body(subject)
    factors = scale_of(subject, body)
    own = tuple(_as_protocol_marker(marker) for marker in subject.markers)
    frames = choose_frames([trial], Protocol(subject.protocol, subject.protocol, body, own), most_frames)
    count = len(frames.measured_m)
    markers = tuple(
        replace(m, position_m=m.position_m / (body.segment(m.segment).scale_matrix @ factors))
        for m in frames.markers
    )
    prior = ScalingPrior(
        factors=factors,
        factor_covariance=FIXED_FACTOR_SD**2 * np.eye(len(factors)),
        offsets_m=np.zeros((len(markers), 3)),
        slides_m=np.zeros((0, len(markers), 3)),
        offset_precision=_offset_precision(markers, subject, body, np.ones(len(markers), dtype=bool)),
    )
    keypoints = any(marker.correlated_m > 0.0 for marker in subject.markers)
    if not keypoints:
        flexions = flexions_of(body, [m.segment for m in markers])
        prior = replace(prior, slides_m=_slides_m(subject, markers, flexions))
    posture = KEYPOINT_POSTURE_FRAMES if keypoints else POSTURE_OBSERVATIONS
    weights = FrameWeights.moving(count, OBSERVATIONS, posture)
    centres_m = centres_of(subject, body)
    return ScalingProblem(body, markers, frames.measured_m, weights, prior, centres_m=centres_m)


def _slides_m(subject: Subject, markers: tuple[ProtocolMarker, ...], flexions: int) -> Array:
    """(D, M, 3) displacements by flexion that scaling found; 0 where it learnt nothing of them."""
    own = {marker.name: marker.slides_m for marker in subject.markers}
    found = [own[m.name] if len(own[m.name]) == flexions else np.zeros((flexions, 3)) for m in markers]
    return np.array(found).reshape(len(markers), flexions, 3).swapaxes(0, 1)


def _offset_precision(
    markers: tuple[ProtocolMarker, ...], subject: Subject, body: BodyDescription, unmoved: BoolArray
) -> Array:
    """(3 M, 3 M): spread of each marker, and the small common displacement of unmoved ones of a steady segment."""
    session_sd = {marker.name: marker.session_sd_m for marker in subject.markers}
    segments, places_m = [m.segment for m in markers], np.array([m.position_m for m in markers])
    beside = OWN_M * around_shoulders(body, segments, places_m).sum(axis=1)
    own_sd = np.hypot([session_sd[marker.name] for marker in markers], beside)
    precision = np.diag(np.repeat(own_sd**-2.0, 3))
    for segment in body.roles.steady:
        here = np.array([marker.segment == segment for marker in markers]) & unmoved
        if here.any():
            rigid = rigid_displacements(np.array([m.position_m for m in markers])[here])
            rows = np.flatnonzero(np.repeat(here, 3))
            precision[np.ix_(rows, rows)] += COMMON_SD_M**-2 * rigid @ rigid.T
    return precision


def rigid_displacements(points_m: Array) -> Array:
    """(3 n, k) orthonormal basis of rigid displacements (small rotations) of points (n, 3); k is 6, 5 or 3."""
    from_middle = points_m - points_m.mean(axis=0)
    moved = [np.tile(axis, len(points_m)) for axis in np.eye(3)]
    turned = [np.cross(axis, from_middle).ravel() for axis in np.eye(3)]
    basis, sizes, _ = np.linalg.svd(np.array(moved + turned).T, full_matrices=False)
    return np.asarray(basis[:, sizes > 1e-6 * sizes[0]])


def _as_protocol_marker(marker: SubjectMarker) -> ProtocolMarker:
    return ProtocolMarker(
        marker.name, marker.segment, marker.neutral_m, "technical", marker.session_sd_m, marker.noise_m
    )
