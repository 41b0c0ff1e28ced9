"""Synthetic captures with known truth: torques, velocities, divergence and consistency of a filter.

The body is the true one. Marker positions are corrected on each trial first, as `reconstruct` does by default,
for every method alike. FCDI (kinematic filter and inverse dynamics) is run at the factor on its accelerations that
is best for the motion, found for torques and for velocities separately: it is compared at its own best in each.
RMS values over joint dofs and tracked frames are pooled over seeds.

What the capture defaults say of their errors is shown without a bound: a squat is planned, no random walk as a plant
believes, and these settings expect skin. `dynamic_consistency` judges the filter where everything is matched.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from benchmarks.checks import Check
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
from mbkf.pipelines.results.summary import ROOT_DOFS, SETTLING_S, compare_with_truth
from mbkf.pipelines.synth import synthesise
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of

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
_TWO_SIDED_95 = 1.959964
_MM = 1e3


@dataclass(frozen=True)
class Case:
    """One synthetic trial: who, what was recorded, what was true.

    Attributes:
        motion, seed: Which.
        given: The true person, with markers where they were in the static trial.
        subject: The same with marker positions corrected on this trial.
        capture: The labelled trial.
        truth: What really happened.
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
        untracked: Frames not followed.
    """

    torque_nm: float
    torque_inside_nm: float
    velocity_rad_s: float
    angle_deg: float
    farthest_mm: float
    untracked: int


@dataclass(frozen=True)
class Consistency:
    """What a filter says of its errors against what they are, per dof and over settled frames.

    Attributes:
        nees: Mean of (error / sd)² of positions, velocities and torques.
        coverage: Share of errors inside the 95 % interval, likewise.
        nis: Normalised innovation squared per reading.
        joint_nees: NEES per dof of positions and velocities with their whole covariance; NaN without one.
    """

    nees: tuple[float, float, float]
    coverage: tuple[float, float, float]
    nis: float
    joint_nees: float


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


def consistency_of(case: Case, method: Method) -> Consistency:
    """NEES, coverage and NIS of a method on a case."""
    found = method.run(case.capture, case.subject, keep_covariance=True)
    joint = compare_with_truth(found, case.truth)["nees_per_dof"]
    settled = (found.times_s >= found.times_s[0] + SETTLING_S) & found.tracked
    spreads = (found.sd_q, found.sd_v, found.sd_tau)
    ratios = [
        (error / np.where(sd[:, ROOT_DOFS:] > 0.0, sd[:, ROOT_DOFS:], np.nan))[settled]
        for error, sd in zip(differences(found, case.truth), spreads, strict=True)
    ]
    judged = settled & (found.nis_readings > 0)
    nis = found.nis[judged] / found.nis_readings[judged]
    return Consistency(
        _three([float(np.nanmean(ratio**2)) for ratio in ratios]),
        _three([_share_inside(ratio) for ratio in ratios]),
        float(nis.mean()) if judged.any() else float("nan"),
        float("nan") if joint is None else joint,
    )


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    a, b, c = values
    return a, b, c


def _share_inside(ratio: Array) -> float:
    known = ratio[np.isfinite(ratio)]
    return float((np.abs(known) <= _TWO_SIDED_95).mean()) if known.size else float("nan")


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
    """What others reach on the trials of one motion, pooled.

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


def consistency_rows(
    keys: Sequence[tuple[str, int]], methods: Sequence[Method], mapper: Mapper
) -> list[Check]:
    """Camera noise, no artefact, known marker positions, default settings: NEES, NIS and coverage, no bounds.

    Args:
        keys: Motion and seed of each trial.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    trials = mapper(partial(make_case, settings=MATCHED, correct=False), keys)
    rows: list[Check] = []
    for method in methods:
        label = f"defaults, camera noise only: {method.label}"
        rows += rows_or_failure(label, partial(_consistent, label, trials, method, mapper))
    return rows


def _consistent(label: str, trials: Sequence[Case], method: Method, mapper: Mapper) -> list[Check]:
    found = mapper(partial(consistency_of, method=method), trials)
    rows = []
    for k, quantity in enumerate(("positions", "velocities", "torques")):
        nees = float(np.mean([one.nees[k] for one in found]))
        inside = 100.0 * float(np.mean([one.coverage[k] for one in found]))
        rows.append(information(f"{label}, NEES per dof, {quantity}", nees))
        rows.append(information(f"{label}, 95 % intervals cover, {quantity}", inside, "%"))
    nis = float(np.mean([one.nis for one in found]))
    rows.append(information(f"{label}, NIS per reading", nis))
    joint = float(np.mean([one.joint_nees for one in found]))
    return [*rows, information(f"{label}, joint NEES, positions and velocities", joint)]


def within(name: str, value: float, least: float, most: float, unit: str = "") -> list[Check]:
    """The two checks of a number that has to lie in a band.

    Args:
        name: Name of the checks.
        value: The number.
        least: Lower end of the band.
        most: Upper end of the band.
        unit: Unit of the number.
    """
    return [
        Check(f"{name}, at least", value, least, ">=", unit),
        Check(f"{name}, at most", value, most, "<=", unit),
    ]


def information(name: str, value: float, unit: str = "") -> Check:
    """A number shown without a bound.

    Args:
        name: Name of the row.
        value: The number.
        unit: Its unit.
    """
    return Check(name, value, float("inf"), "<=", unit)
