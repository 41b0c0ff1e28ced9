"""From trials to a scaled subject: frames, fits with spreads of everybody and of this person, checks, report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, NotConverged
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import NO_SLIDES, STANDING_KEY, Subject, SubjectMarker
from mbkf.model.body import Body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.model.sides import mirrored
from mbkf.numerics.levenberg_marquardt import Solution
from mbkf.scaling.covariance import body_covariance, factor_errors
from mbkf.scaling.evidence import learnt_prior
from mbkf.scaling.frames import ScalingFrames, choose_frames
from mbkf.scaling.problem import FACTOR_BOUNDS, KEYPOINT_POSTURE_FRAMES, ScalingProblem
from mbkf.scaling.records import FrameWeights, ScalingPrior, ScalingSettings, ScalingState
from mbkf.scaling.search import COARSE, FINE, Progress, first_poses, first_state, minimum
from mbkf.scaling.verdict import DOUBTS_KEY, FitQuality, as_each_other
from mbkf.sensors.flexed_skin import slide_covariance

MAX_STANDING_TILT_DEG = 50.0
SESSION_SHARE = 0.5
MIN_SESSION_SD_M = 0.005
SAME_FACTOR_SD = 1e-5
"""Spread of a split factor about its origin in scaling by the thesis's factors."""

MAX_RMS_M = 0.05
"""Greatest RMS distance of the markers, unless their noise explains more."""

MAX_RMS_PER_NOISE = 2.5
"""The same over the noise per coordinate; noise alone gives 1.7."""


def scale_subject(
    static: Sequence[MarkerTrajectories],
    dynamic: Sequence[MarkerTrajectories],
    protocol: Protocol,
    *,
    mass_kg: float,
    height_m: float | None = None,
    settings: ScalingSettings | None = None,
    progress: Progress | None = None,
) -> Subject:
    """Scale factors and marker positions of a person from standing trials, moving trials or both.

    Args:
        static: Standing trials (neutral posture).
        dynamic: Trials of any movement.
        protocol: The marker protocol.
        mass_kg: Body mass.
        height_m: Body height, if known.
        settings: Weights of the priors.
        progress: Called with accepted iterations and their greatest number.

    Raises:
        InvalidInput: An impossible mass or height, no trial, or a static trial without an upright person.
        NotObservable: Too few markers of the protocol.
        NotConverged: The fit is poor, or the proportions are impossible: the markers are not this protocol's.
    """
    settings = settings or ScalingSettings()
    _check_size(mass_kg, height_m)
    if not static and not dynamic:
        raise InvalidInput("scaling needs captures: a static trial, or at least one --trial")
    frames = choose_frames([*static, *dynamic], protocol, settings.frames_per_trial)
    problem = scaling_problem(frames, len(static), protocol, height_m, settings)
    moving = len(dynamic) > 0 and settings.skin and with_skin(problem).flexions > 0
    problem, start, tolerance = _started(problem, moving)
    freed = problem.with_prior(with_skin(problem)) if moving else problem
    solution = minimum(problem, start, progress, tolerance)
    dropped = problem.outliers(solution.state, settings.outlier_m)
    if dropped.sum() > 0.5 * problem.seen.sum():
        raise NotConverged(
            f"most markers lie further than {1e3 * settings.outlier_m:.0f} mm from the fitted body; check that "
            f"'{protocol.name}' is their protocol (--protocol), and their unit and axes (--unit, --up)"
        )
    if dropped.any():
        problem, freed = problem.without(dropped), freed.without(dropped)
        solution = minimum(problem, solution.state, progress, tolerance)
    if freed.prior.flexions:
        exchanged = _exchanged(problem, _nearly_learnt(problem, solution))  # skin that moves would hide them
        moved = minimum(freed, freed.start_from(solution.state), progress, COARSE)
        problem, solution = _with_learnt_prior(freed, moved, progress)
    else:
        problem, solution = _with_learnt_prior(problem, solution, progress)
        exchanged = _exchanged(problem, solution.state)
    rms = float(np.sqrt(np.nanmean(np.linalg.norm(problem.errors_m(solution.state), axis=2) ** 2)))
    noise = float(np.sqrt((problem.noise_m**2).mean()))
    if rms > max(MAX_RMS_M, MAX_RMS_PER_NOISE * noise):
        raise NotConverged(
            f"the markers fit the body only to {1e3 * rms:.0f} mm RMS; check that '{protocol.name}' is their protocol "
            "(--protocol)"
        )
    standing = solution.state.poses[frames.trial < len(static)]
    _require_upright(standing)
    factors = dict(zip(problem.body.scale_factors, solution.state.factors.tolist(), strict=True))
    quality = FitQuality(
        factors,
        tuple(name for name, k in factors.items() if _at_bound(k)),
        settings.proportion_sd,
        rms / noise,
        float(dropped.sum() / problem.seen.sum()),
        solution.converged,
    )
    if quality.refusal:
        raise NotConverged(quality.refusal)
    subject = _subject(problem, solution, frames, dropped, protocol, mass_kg, height_m, settings)
    doubts = [*quality.doubts, *exchanged]
    if doubts:
        subject.report[DOUBTS_KEY] = doubts
    if len(standing):
        model = problem.posture.model
        subject.report[STANDING_KEY] = [round(float(x), 7) for x in _middle(model, standing)]
    return subject


def _started(problem: ScalingProblem, moving: bool) -> tuple[ScalingProblem, ScalingState, float]:
    """The problem with shoulders as the arms of a first state let expect, that state, and the search's tolerance."""
    start = first_state(problem) if moving else problem.start(first_poses(problem))
    problem = problem.with_shoulders(start.poses)
    return problem, replace(start, girdle_m=problem.prior.girdle_m), COARSE if moving else FINE


def _with_learnt_prior(
    problem: ScalingProblem, solution: Solution[ScalingState], progress: Progress | None
) -> tuple[ScalingProblem, Solution[ScalingState]]:
    """The problem with the prior that its solution teaches, and the solution of that."""
    learnt = learnt_prior(problem, solution.state, solution.equations.schur_complement())
    problem = problem.with_prior(learnt)
    return problem, minimum(problem, solution.state, progress)


def _nearly_learnt(problem: ScalingProblem, solution: Solution[ScalingState]) -> ScalingState:
    """The state one step from a solution towards that with the prior it teaches."""
    learnt = learnt_prior(problem, solution.state, solution.equations.schur_complement())
    problem = problem.with_prior(learnt)
    return problem.move(solution.state, *problem.linearise(solution.state).step(0.0))


def _check_size(mass_kg: float, height_m: float | None) -> None:
    """Refuses a mass or a height that people do not have."""
    if not (np.isfinite(mass_kg) and mass_kg > 0):
        raise InvalidInput(f"the body mass must be positive, got {mass_kg} kg; give --mass KG")
    if height_m is not None and not 0.5 < height_m < 2.6:
        raise InvalidInput(
            f"the body height must be between 0.5 and 2.6 m, got {height_m} m; give --height M"
        )


def _at_bound(factor: float) -> bool:
    return factor <= FACTOR_BOUNDS[0] + 1e-9 or factor >= FACTOR_BOUNDS[1] - 1e-9


def _exchanged(problem: ScalingProblem, state: ScalingState) -> tuple[str, ...]:
    """A sentence about markers that are at the place of another one of their segment."""
    names, segments = zip(*((m.name, m.segment) for m in problem.markers), strict=True)
    found = problem.local_m(state.factors, state.offsets_m)
    places = problem.local_m(state.factors, np.zeros_like(state.offsets_m))
    pairs = [f"{names[i]} and {names[j]}" for i, j in as_each_other(segments, places, found)]
    return (f"{', '.join(pairs)} are at each other's places; check for exchanged names",) if pairs else ()


def _middle(model: Body, poses: Array) -> Array:
    """(nq,) mean of similar poses (N, nq): that of their differences from the first."""
    away = np.mean([model.difference(poses[0], pose) for pose in poses], axis=0)
    return model.integrate(poses[0], away)


def _require_upright(standing: Array) -> None:
    """Refuses standing poses (N, nq) with a lying pelvis: the file's up axis is wrong."""
    x, y = standing[:, 3], standing[:, 4]
    tilt = np.degrees(np.arccos(np.clip(1.0 - 2.0 * (x**2 + y**2), -1.0, 1.0)))
    if len(tilt) and np.median(tilt) > MAX_STANDING_TILT_DEG:
        raise InvalidInput(
            f"in the static trial the pelvis is tilted by {np.median(tilt):.0f}° from upright; give the axis that "
            "points up (--up)"
        )


def scaling_problem(
    frames: ScalingFrames,
    static_trials: int,
    protocol: Protocol,
    height_m: float | None,
    settings: ScalingSettings,
) -> ScalingProblem:
    """The least-squares problem of chosen frames.

    Args:
        frames: The frames, those of the static trials first.
        static_trials: Number of static trials.
        protocol: The marker protocol.
        height_m: Body height, if known.
        settings: Weights of the priors.
    """
    body = protocol.body
    weights = _weights(frames, static_trials, settings)
    expected = 1.0 if height_m is None else height_m / body.reference_height_m
    stature = settings.stature_sd if height_m is None else settings.known_stature_sd
    count = len(body.scale_factors)
    prior = ScalingPrior(
        factors=np.full(count, expected),
        factor_covariance=factor_covariance(body, stature, settings),
        offsets_m=np.zeros((len(frames.markers), 3)),
        offset_precision=np.diag(np.repeat([m.placement_sd_m**-2 for m in frames.markers], 3)),
    )
    return ScalingProblem(
        body,
        frames.markers,
        frames.measured_m,
        weights,
        prior,
        settings.standing_sd_rad,
        trial=frames.trial.astype(np.intp),
    )


def with_skin(problem: ScalingProblem) -> ScalingPrior:
    """The prior with unknown displacements of the markers by flexion, unless a network places them."""
    covariance = slide_covariance(problem.body, problem.segments)
    if not len(covariance) or any(marker.kind == "keypoint" for marker in problem.markers):
        return problem.prior
    expected = np.zeros((len(covariance), len(problem.markers), 3))
    return replace(problem.prior, slides_m=expected, slide_precision=np.linalg.inv(covariance[0]))


def factor_covariance(body: BodyDescription, stature_sd: float, settings: ScalingSettings) -> Array:
    """(K, K) prior covariance of the scale factors: overall size, proportion, and the difference of left and right.

    Args:
        body: The reference body, whose factors they are.
        stature_sd: Spread of overall size.
        settings: Spread of proportions and of one side.
    """
    names = np.array(body.scale_factors)
    other = np.array([mirrored(name) for name in names])
    alike = np.eye(len(names)) + ((names[:, None] == other) & (names != other))
    one_side = settings.side_sd**2 * np.diag((names != other).astype(np.float64))
    covariance = np.asarray(stature_sd**2 + settings.proportion_sd**2 * alike + one_side)
    if settings.thesis_factors:
        origin = [body.scale_factors.index(body.split_factors.get(name, name)) for name in body.scale_factors]
        split = np.diag([SAME_FACTOR_SD**2 if name in body.split_factors else 0.0 for name in names])
        covariance = covariance[np.ix_(origin, origin)] + split
    return covariance


def _weights(frames: ScalingFrames, static_trials: int, settings: ScalingSettings) -> FrameWeights:
    """Weights of the frames of standing and moving trials."""
    counts = np.bincount(frames.trial)
    stands = np.arange(len(counts)) < static_trials
    keypoints = any(marker.kind == "keypoint" for marker in frames.markers)
    moving = KEYPOINT_POSTURE_FRAMES if keypoints else settings.dynamic_posture_frames
    posture = np.where(stands, settings.static_posture_frames, moving)
    markers = np.where(stands | keypoints, counts, settings.dynamic_marker_frames)
    return FrameWeights(
        np.minimum(markers / counts, 1.0)[frames.trial],
        np.minimum(posture / counts, 1.0)[frames.trial],
        stands[frames.trial],
        np.where(stands & keypoints, 1.0, 0.0)[frames.trial],
    )


def _subject(
    problem: ScalingProblem,
    solution: Solution[ScalingState],
    frames: ScalingFrames,
    dropped: BoolArray,
    protocol: Protocol,
    mass_kg: float,
    height_m: float | None,
    settings: ScalingSettings,
) -> Subject:
    state = solution.state
    markers = _subject_markers(problem, state, protocol)
    body, information = problem.body, problem.information(state)
    return Subject(
        body=body.name,
        mass_kg=float(mass_kg),
        scale_factors={n: float(k) for n, k in zip(body.scale_factors, state.factors, strict=True)},
        markers=markers,
        protocol=protocol.name,
        height_m=height_m,
        report=_report(problem, solution, factor_errors(problem, information), frames, dropped, settings),
        body_text=body.text,
        covariance=body_covariance(problem, information),
    )


def _subject_markers(
    problem: ScalingProblem, state: ScalingState, protocol: Protocol
) -> tuple[SubjectMarker, ...]:
    """The protocol's markers that are measured; one without samples is at its place on the scaled reference body."""
    local = problem.local_m(state.factors, state.offsets_m)
    index = {marker.name: m for m, marker in enumerate(problem.markers)}
    found = []
    for marker in protocol.markers:
        if marker.kind == "computed":
            continue
        m = index.get(marker.name)
        reference = (problem.body.segment(marker.segment).scale_matrix @ state.factors) * marker.position_m
        slides = NO_SLIDES if m is None or not len(state.slides_m) else state.slides_m[:, m]
        found.append(
            SubjectMarker(
                marker.name,
                marker.segment,
                reference if m is None else local[m],
                marker.noise_m,
                _session_sd_m(marker, m is not None),
                marker.aliases,
                marker.correlated_m,
                marker.correlation_s,
                slides,
                np.zeros(len(slides)),
            )
        )
    return tuple(found)


def _session_sd_m(marker: ProtocolMarker, seen: bool) -> float:
    """Spread of a marker's place in the next trial: a share of its spread in the protocol.

    Keypoints are not attached anew: the network finds the same point in the next trial.
    """
    if seen and marker.kind == "keypoint":
        return MIN_SESSION_SD_M
    return max(MIN_SESSION_SD_M, SESSION_SHARE * marker.placement_sd_m) if seen else marker.placement_sd_m


def _report(
    problem: ScalingProblem,
    solution: Solution[ScalingState],
    errors: Array,
    frames: ScalingFrames,
    dropped: BoolArray,
    settings: ScalingSettings,
) -> dict[str, object]:
    """Plain numbers: fit per marker (mm), factors with standard errors (K,) and bounds reached, markers left out."""
    state, body = solution.state, problem.body
    errors_mm = 1e3 * np.linalg.norm(problem.errors_m(state), axis=2)
    markers = {}
    for i, marker in enumerate(problem.markers):
        column = errors_mm[:, i][~np.isnan(errors_mm[:, i])]
        markers[marker.name] = {
            "kind": marker.kind,
            "rms_mm": round(float(np.sqrt((column**2).mean())), 3) if len(column) else None,
            "max_mm": round(float(column.max()), 3) if len(column) else None,
            "moved_mm": round(1e3 * float(np.linalg.norm(state.offsets_m[i])), 2),
            "samples": len(column),
            "samples_left_out": int(dropped[:, i].sum()),
        }
    return {
        "marker_rms_mm": round(float(np.sqrt(np.nanmean(errors_mm**2))), 3),
        "frames": len(state.poses),
        "converged": solution.converged,
        "factors": {
            name: {
                "value": round(float(k), 5),
                "standard_error": round(float(error), 5),
                "at_bound": _at_bound(float(k)),
            }
            for name, k, error in zip(body.scale_factors, state.factors, errors, strict=True)
        },
        "markers": markers,
        "left_out": frames.left_out,
        "settings": asdict(settings),
    }
