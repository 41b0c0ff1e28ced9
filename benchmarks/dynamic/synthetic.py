"""Synthetic captures with known truth: torques, velocities and divergence of a filter.

The body is the true one. Marker positions are corrected on each trial first, as `reconstruct` does by default,
for every method alike. FCDI (kinematic filter and inverse dynamics) is run at the factor on its accelerations that
is best for the motion, found for torques and for velocities separately: it is compared at its own best in each.
RMS values over joint dofs and tracked frames are pooled over seeds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.methods import (
    SCALES,
    Mapper,
    Method,
    best,
    best_two,
    corrected,
    pooled,
    rows_or_failure,
    tared,
)
from benchmarks.dynamic.offline import offline_motion
from benchmarks.references import rms
from mbkf.conventions import Array
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.synth import synthesise

MOTIONS = ("walk", "squat", "jump")
NOISE = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.005)
"""1 mm camera noise and 5 mm artefact; occlusion and plates as `mbkf synth` has them."""

MATCHED = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.0)
"""Camera noise only; the subject's markers then state exactly this noise."""

DIVERGED_MM = 200.0
EDGE_S = 0.2
"""Stretch at both ends of a trial in which a zero-phase low-pass is not judged."""

SWEEP_SEEDS = 4
FCDI = Method("kinematic")
_MM = 1e3


@dataclass(frozen=True)
class Case:
    """One synthetic trial: person, capture and truth.

    Attributes:
        motion, seed: Name of the motion, random seed.
        given: The true person, with markers where they were in the static trial.
        subject: The same with marker positions corrected on this trial.
        capture: The labelled trial.
        truth: The true motion.
    """

    motion: str
    seed: int
    given: Subject
    subject: Subject
    capture: Capture
    truth: Truth


@dataclass(frozen=True)
class Errors:
    """RMS errors of one method on one case, over joint dofs.

    Attributes:
        torque_nm: Torques, over all tracked frames.
        torque_inside_nm: Torques, without the trial's ends.
        velocity_rad_s: Velocities, over all tracked frames.
        angle_deg: Tangent differences of posture.
        farthest_mm: Largest distance of a marker of the reconstructed body from its true position.
        untracked: Frames not tracked.
    """

    torque_nm: float
    torque_inside_nm: float
    velocity_rad_s: float
    angle_deg: float
    farthest_mm: float
    untracked: int


def make_case(key: tuple[str, int], settings: CaptureSettings = NOISE, *, correct: bool = True) -> Case:
    """The trial of a motion and a seed, on the true body.

    Args:
        key: Motion and seed.
        settings: Errors of the instruments.
        correct: Whether marker positions are corrected on the trial; if not, they are exact and their stated
            noise is that of the cameras.
    """
    motion, seed = key
    with single_threaded():
        subject, made = synthesise(motion, seed=seed, settings=settings)
    capture = tared(made.trial)
    if correct:
        return Case(motion, seed, subject, corrected(subject, capture), capture, made.truth)
    exact = tuple(replace(marker, noise_m=settings.markers_sd_m) for marker in subject.markers)
    exact_subject = replace(subject, markers=exact)
    return Case(motion, seed, exact_subject, exact_subject, capture, made.truth)


def errors_of(case: Case, method: Method) -> Errors:
    """Runs a method on a case and compares with the truth."""
    found = method.run(case.capture, case.subject)
    error_q, error_v, error_tau = differences(found, case.truth)
    distance = _MM * np.linalg.norm(found.predicted_m - _true_markers(found, case.truth), axis=2)
    return Errors(
        rms(error_tau),
        rms(_inside(error_tau, found.rate_hz)),
        rms(error_v),
        float(np.rad2deg(rms(error_q))),
        float(np.nanmax(distance)) if np.isfinite(distance).any() else float("nan"),
        int((~found.tracked).sum()),
    )


def differences(found: Reconstruction, truth: Truth) -> tuple[Array, Array, Array]:
    """(T, joint dofs) errors of posture (tangent), velocity and torque; NaN where not tracked."""
    model = body_of(found.subject)
    error_q = np.full(found.v.shape, np.nan)
    for t in np.flatnonzero(found.tracked):
        error_q[t] = model.difference(found.q[t], truth.q[t])
    known = found.tracked[:, None]
    error_v = np.where(known, truth.v - found.v, np.nan)
    error_tau = np.where(known, truth.tau - found.tau, np.nan)
    return error_q[:, ROOT_DOFS:], error_v[:, ROOT_DOFS:], error_tau[:, ROOT_DOFS:]


def offline_torque_nm(case: Case) -> float:
    """Torque RMS of zero-phase 6 Hz inverse dynamics, without the trial's ends."""
    found = offline_motion(case.capture, case.subject)
    error = (case.truth.tau - found.tau)[:, ROOT_DOFS:]
    return rms(_inside(error, case.capture.markers.rate_hz))


def _true_markers(found: Reconstruction, truth: Truth) -> Array:
    """(T, M, 3) true positions in the order of the reconstruction's markers."""
    return truth.markers_m[:, [truth.marker_names.index(name) for name in found.marker_names]]


def _inside(error: Array, rate_hz: float) -> Array:
    edge = round(EDGE_S * rate_hz)
    return error[edge : len(error) - edge]


def cases(
    motions: Sequence[str], seeds: Sequence[int], mapper: Mapper, settings: CaptureSettings = NOISE
) -> list[Case]:
    """All trials of some motions and seeds, corrected.

    Args:
        motions: Names of synthetic motions.
        seeds: Random seeds.
        mapper: Runs a function on many items, in turn or on several processes.
        settings: Noise of the captures.
    """
    keys = [(motion, seed) for motion in motions for seed in seeds]
    return mapper(partial(make_case, settings=settings), keys)


def errors(trials: Sequence[Case], method: Method, mapper: Mapper) -> list[Errors]:
    """The errors of one method on every trial.

    Args:
        trials: The trials, with their truth.
        method: The filter with its settings.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    return mapper(partial(errors_of, method=method), trials)


@dataclass(frozen=True)
class Baseline:
    """Pooled errors of the reference methods on the trials of one motion.

    Attributes:
        torque_nm: FCDI's torque RMS at the scale that is best for it.
        torque_scale: That scale.
        velocity_rad_s: Its velocity RMS at the scale that is best for that.
        velocity_scale: That scale.
        offline_nm: Torque RMS of zero-phase 6 Hz inverse dynamics, without the trials' ends.
    """

    torque_nm: float
    torque_scale: float
    velocity_rad_s: float
    velocity_scale: float
    offline_nm: float


def baseline(trials: Sequence[Case], mapper: Mapper, scales: Sequence[float] = SCALES) -> Baseline:
    """FCDI at its best, searched on the first trials and measured on all, and the offline practice.

    Args:
        trials: The trials, with their truth.
        mapper: Runs a function on many items, in turn or on several processes.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
    """
    first = swept(trials[:SWEEP_SEEDS], scales, mapper)
    near = {s for key in ("torque_nm", "velocity_rad_s") for s in best_two(first[key])}
    final = swept(trials, sorted(near), mapper)
    torque, velocity = best(final["torque_nm"]), best(final["velocity_rad_s"])
    return Baseline(
        final["torque_nm"][torque],
        torque,
        final["velocity_rad_s"][velocity],
        velocity,
        pooled(mapper(offline_torque_nm, trials)),
    )


def swept(
    trials: Sequence[Case], scales: Sequence[float], mapper: Mapper
) -> Mapping[str, Mapping[float, float]]:
    """Pooled FCDI errors by scale: ``torque_nm`` and ``velocity_rad_s``.

    Args:
        trials: The trials, with their truth.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    found = {scale: errors(trials, replace(FCDI, scale=scale), mapper) for scale in scales}
    return {
        key: {scale: pooled(getattr(one, key) for one in list_) for scale, list_ in found.items()}
        for key in ("torque_nm", "velocity_rad_s")
    }


def accuracy_rows(
    trials: Sequence[Case], methods: Sequence[Method], mapper: Mapper, *, scales: Sequence[float] = SCALES
) -> list[Check]:
    """The rows of one motion's trials: every method against FCDI at its best and the offline practice.

    Args:
        trials: The trials, with their truth.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
    """
    motion, base = trials[0].motion, baseline(trials, mapper, scales)
    name = f"synthetic {motion}, {len(trials)} seeds"
    rows = [
        information(
            f"{name}: FCDI torque RMS at its best scale {base.torque_scale:g}", base.torque_nm, "N m"
        ),
        information(
            f"{name}: FCDI velocity RMS at its best scale {base.velocity_scale:g}",
            base.velocity_rad_s,
            "rad/s",
        ),
        information(f"{name}: zero-phase 6 Hz inverse dynamics, torque RMS", base.offline_nm, "N m"),
    ]
    for method in methods:
        label = f"{name}: {method.label}"
        rows += rows_or_failure(label, partial(_judged, label, trials, method, mapper, base))
    return rows


def _judged(
    label: str, trials: Sequence[Case], method: Method, mapper: Mapper, base: Baseline
) -> list[Check]:
    return method_rows(label, errors(trials, method, mapper), base, method.smooth)


def method_rows(name: str, found: Sequence[Errors], base: Baseline, smooth: bool) -> list[Check]:
    """The bounds of one method on one motion.

    Args:
        name: Beginning of the rows' names.
        found: The method's errors, per trial.
        base: Errors of FCDI and of the offline practice.
        smooth: Whether the method is a smoother.
    """
    torque = pooled(one.torque_nm for one in found)
    inside = pooled(one.torque_inside_nm for one in found)
    velocity = pooled(one.velocity_rad_s for one in found)
    rows = [
        information(f"{name}, torque RMS", torque, "N m"),
        Check(f"{name}, torque RMS / FCDI", torque / base.torque_nm, 0.45 if smooth else 0.6, "<="),
        Check(
            f"{name}, velocity RMS / FCDI", velocity / base.velocity_rad_s, np.inf if smooth else 0.8, "<="
        ),
    ]
    if smooth:
        rows.append(Check(f"{name}, torque RMS / 6 Hz offline", inside / base.offline_nm, 1.0, "<="))
    lost = float(sum(one.untracked for one in found))
    farthest = float(np.max([one.farthest_mm for one in found]))
    return [
        *rows,
        Check(f"{name}, farthest marker from its true place", farthest, DIVERGED_MM, "<=", "mm"),
        Check(f"{name}, frames not followed", lost, 0.0, "<="),
    ]
