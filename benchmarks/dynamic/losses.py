"""Lost markers: random streaks on real captures, and all shank and foot markers of one leg on synthetic ones.

What is taken away is withheld from the marker correction as well. FCDI (the kinematic filter) is run at the factor on
its accelerations that suits each row best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import Person, load
from benchmarks.dynamic.methods import SCALES, Mapper, Method, best_on_all, corrected, pooled, rows_or_failure
from benchmarks.dynamic.synthetic import FCDI, SWEEP_SEEDS, Case, differences
from benchmarks.references import rms
from mbkf.conventions import Array, BoolArray
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.synthesis.cameras import OCCLUSION_FRAMES, occlusions
from mbkf.synthesis.capture import CaptureSettings
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.results.summary import ROOT_DOFS

FRACTIONS = (0.10, 0.27)
CAUSAL_MM = {0.10: 7.5, 0.27: 11.0}
SMOOTH_MM = {0.10: 5.5, 0.27: 7.5}
FARTHEST_MM = 100.0
CAPTURES = ("rajagopal walk", "biomechzoo HC032A", "biomechzoo HC044A")

GAP_S = 0.3
BACK_S = 0.05
BACK_RATIO, BACK_DEG = 1.5, 1.0
"""Back: the error is at most that of the same filter without the gap times this factor, or plus this angle."""

PLACES = (("right", 0.4), ("left", 0.6))
"""Leg, and middle of its gap as a fraction of the trial."""

LOSS_MOTIONS = ("walk", "squat")
LOSS_NOISE = CaptureSettings()
"""A leg is lost in captures as `mbkf synth` makes them: 3 mm artefact leave less of an error without any gap."""

OCCLUSION_SCALES = (0.15, 0.3, 0.6, 1.2, 2.4, 4.8)
_MM, _MS = 1e3, 1e3


@dataclass(frozen=True)
class Occluded:
    """A real capture with hidden streaks.

    Attributes:
        subject: Markers corrected on what is shown.
        shown: The capture without the hidden samples, under the subject's own names.
        withheld_m: (T, M, 3) all measured positions.
        hidden: (T, M) what was taken away.
    """

    subject: Subject
    shown: Capture
    withheld_m: Array
    hidden: BoolArray


@dataclass(frozen=True)
class OcclusionErrors:
    """Hidden-marker RMS, the largest distance of any measured marker, both in mm, and samples without estimate."""

    hidden_mm: float
    farthest_mm: float
    unknown: int


def occlude(key: tuple[str, float, int], data: Path) -> Occluded:
    """Hides random 20-frame streaks of a capture.

    Args:
        key: Capture, fraction of marker-frames and seed.
        data: Folder of the reference captures.
    """
    name, fraction, seed = key
    return occluded(load(name, data, correct=False), fraction, seed)


def occluded(person: Person, fraction: float, seed: int, length: int = OCCLUSION_FRAMES) -> Occluded:
    """Hides random streaks of a person's capture.

    Args:
        person: Capture, and subject whose markers are not corrected yet.
        fraction: Fraction of the marker-frames to hide.
        seed: Random seed.
        length: Frames of a streak.
    """
    markers = subject_markers(person.capture.markers, person.subject)
    hidden = streaks(markers.present, fraction, seed, length)
    positions = np.where(hidden[:, :, None], np.nan, markers.positions_m)
    shown = replace(person.capture, markers=replace(markers, positions_m=positions))
    return Occluded(corrected(person.subject, shown), shown, markers.positions_m, hidden)


def streaks(present: BoolArray, fraction: float, seed: int, length: int = OCCLUSION_FRAMES) -> BoolArray:
    """(T, M) samples to hide: streaks of some frames over a fraction of all marker-frames, where there is one.

    Args:
        present: (T, M) samples that are measured.
        fraction: Fraction of the marker-frames to hide.
        seed: Random seed.
        length: Frames of a streak.
    """
    frames, markers = present.shape
    rng = np.random.default_rng([seed, round(1000 * fraction)])
    return np.asarray(occlusions(frames, markers, fraction, rng, length) & present)


def occlusion_errors(case: Occluded, method: Method) -> OcclusionErrors:
    """Runs a method on the visible samples and compares with the withheld ones."""
    found = method.run(case.shown, case.subject)
    order = [found.marker_names.index(name) for name in case.shown.markers.names]
    distance = _MM * np.linalg.norm(found.predicted_m[:, order] - case.withheld_m, axis=2)
    at_hidden = distance[case.hidden]
    farthest = float(np.nanmax(distance)) if np.isfinite(distance).any() else float("nan")
    return OcclusionErrors(rms(at_hidden), farthest, int(np.isnan(at_hidden).sum()))


def occlusion_rows(
    name: str,
    fraction: float,
    data: Path,
    methods: Sequence[Method],
    mapper: Mapper,
    *,
    seeds: Sequence[int],
    scales: Sequence[float] = OCCLUSION_SCALES,
) -> list[Check]:
    """The rows of one capture and fraction: every method against its bounds and FCDI at its best.

    Args:
        name: Name of the capture.
        fraction: Fraction of the marker-frames that is hidden.
        data: Folder of the reference captures.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        seeds: Random seeds of the streaks.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
    """
    hidden = mapper(partial(occlude, data=data), [(name, fraction, seed) for seed in seeds])
    scale, kinematic = best_occlusion(hidden, mapper, scales)
    label = f"{name}, {100 * fraction:.0f} % hidden, {len(seeds)} seeds"
    rows = [information(f"{label}: FCDI at its best scale {scale:g}", kinematic, "mm")]
    for method in methods:
        own = f"{label}: {method.label}"
        rows += rows_or_failure(own, partial(_hidden_rows, own, hidden, method, mapper, fraction, kinematic))
    return rows


def _hidden_rows(
    label: str, hidden: Sequence[Occluded], method: Method, mapper: Mapper, fraction: float, kinematic: float
) -> list[Check]:
    found = mapper(partial(occlusion_errors, method=method), hidden)
    value = pooled(one.hidden_mm for one in found)
    bound = (SMOOTH_MM if method.smooth else CAUSAL_MM)[fraction]
    farthest = float(np.max([one.farthest_mm for one in found]))
    unknown = float(sum(one.unknown for one in found))
    return [
        Check(f"{label}, hidden-marker RMS", value, bound, "<=", "mm"),
        Check(f"{label}, hidden-marker RMS / FCDI", value / kinematic, 1.0, "<="),
        Check(f"{label}, farthest marker", farthest, FARTHEST_MM, "<=", "mm"),
        Check(f"{label}, hidden samples without an estimate", unknown, 0.0, "<="),
    ]


def best_occlusion(
    hidden: Sequence[Occluded], mapper: Mapper, scales: Sequence[float] = OCCLUSION_SCALES
) -> tuple[float, float]:
    """FCDI's best scale and its pooled hidden-marker RMS in mm, searched on some seeds and measured on all.

    Args:
        hidden: Captures with hidden markers.
        mapper: Runs a function on many items, in turn or on several processes.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
    """

    def score(some: Sequence[Occluded], scale: float) -> float:
        errors = mapper(partial(occlusion_errors, method=replace(FCDI, scale=scale)), some)
        return pooled(one.hidden_mm for one in errors)

    return best_on_all(score, hidden, scales, SWEEP_SEEDS)


@dataclass(frozen=True)
class Loss:
    """A synthetic trial in which one leg loses its markers.

    Attributes:
        case: The trial.
        leg: "right" or "left".
        first, end: The frames [first, end) without its shank, foot and toe markers.
        capture: The capture without them.
        subject: Markers corrected on that capture.
    """

    case: Case
    leg: str
    first: int
    end: int
    capture: Capture
    subject: Subject


@dataclass(frozen=True)
class LossErrors:
    """Angle errors of knee and ankle.

    Attributes:
        gap_deg: RMS in the gap, over both joints' dofs.
        usual_deg: The same without the gap.
        back_s: Time after the gap until the error is back.
    """

    gap_deg: float
    usual_deg: float
    back_s: float


def lose(key: tuple[Case, str, float]) -> Loss:
    """Takes a leg's markers away for 300 ms about a place in the trial."""
    case, leg, place = key
    markers = case.capture.markers
    first = round(place * markers.frames - 0.5 * GAP_S * markers.rate_hz)
    end = first + round(GAP_S * markers.rate_hz)
    segments = {f"{leg}_{segment}" for segment in ("shank", "foot", "toes")}
    own = {marker.name for marker in case.given.markers if marker.segment in segments}
    positions = markers.positions_m.copy()
    positions[first:end, [name in own for name in markers.names]] = np.nan
    capture = replace(case.capture, markers=replace(markers, positions_m=positions))
    return Loss(case, leg, first, end, capture, corrected(case.given, capture))


def losses(trials: Sequence[Case], mapper: Mapper) -> list[Loss]:
    """Two losses of every trial: right leg before its middle, left leg after it."""
    return mapper(lose, [(case, *place) for case in trials for place in PLACES])


def gap_error_deg(loss: Loss, method: Method) -> float:
    """RMS angle error of knee and ankle in the gap."""
    error = leg_error(loss, method.run(loss.capture, loss.subject))
    return rms(error[loss.first : loss.end])


def loss_errors(loss: Loss, method: Method) -> LossErrors:
    """Runs a method with and without the gap."""
    rate_hz = loss.case.capture.markers.rate_hz
    error = leg_error(loss, method.run(loss.capture, loss.subject))
    without = leg_error(loss, method.run(loss.case.capture, loss.case.subject))
    gap, after = slice(loss.first, loss.end), slice(loss.end, None)
    return LossErrors(rms(error[gap]), rms(without[gap]), back_after(error[after], without[after], rate_hz))


def leg_error(loss: Loss, found: Reconstruction) -> Array:
    """(T, 6) tangent errors of the leg's knee and ankle in degrees."""
    return np.rad2deg(differences(found, loss.case.truth)[0][:, leg_dofs(loss.leg)])


def leg_dofs(leg: str) -> Array:
    """Columns of knee and ankle among the joint dofs."""
    model = HumanModel.scaled()
    joints = [model.joint(f"{leg}_{segment}").v for segment in ("shank", "foot")]
    return np.concatenate([np.arange(v.start, v.stop) for v in joints]) - ROOT_DOFS


def back_after(error_deg: Array, usual_deg: Array, rate_hz: float) -> float:
    """Time from the end of a gap to the first frame whose error is what it is without the gap.

    Args:
        error_deg: (T, n) errors from the first frame after the gap on; their RMS over dofs counts.
        usual_deg: (T, n) errors of the same frames without the gap.
        rate_hz: Frame rate.

    Returns:
        Time in s, one frame at least; infinite where the error never comes back.
    """
    size, usual = (np.sqrt((values**2).mean(axis=1)) for values in (error_deg, usual_deg))
    inside = np.flatnonzero(size <= np.maximum(BACK_RATIO * usual, usual + BACK_DEG))
    return float(inside[0] + 1) / rate_hz if len(inside) else float("inf")


def loss_rows(
    trials: Sequence[Case], methods: Sequence[Method], mapper: Mapper, *, scales: Sequence[float] = SCALES
) -> list[Check]:
    """The rows of one motion: every method's error in the gap against FCDI at its best.

    Args:
        trials: The trials, with their truth.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        scales: Factors on the table of typical accelerations, among which FCDI's best is searched.
    """
    lost = losses(trials, mapper)

    def score(some: Sequence[Loss], scale: float) -> float:
        return pooled(mapper(partial(gap_error_deg, method=replace(FCDI, scale=scale)), some))

    scale, kinematic = best_on_all(score, lost, scales, SWEEP_SEEDS)
    label = f"{trials[0].motion}, one leg's markers lost for {1e3 * GAP_S:.0f} ms, {len(lost)} losses"
    rows = [information(f"{label}: FCDI at its best scale {scale:g}, angle RMS", kinematic, "°")]
    for method in methods:
        own = f"{label}: {method.label}"
        rows += rows_or_failure(own, partial(_leg_rows, own, lost, method, mapper, kinematic))
    return rows


def _leg_rows(
    label: str, lost: Sequence[Loss], method: Method, mapper: Mapper, kinematic: float
) -> list[Check]:
    found = mapper(partial(loss_errors, method=method), lost)
    value, bound = pooled(e.gap_deg for e in found), 0.5 if method.smooth else 0.7
    slowest, back_ms = _MS * max(e.back_s for e in found), np.inf if method.smooth else _MS * BACK_S
    return [
        information(f"{label}, angle RMS in the gap", value, "°"),
        information(f"{label}, the same without the gap", pooled(e.usual_deg for e in found), "°"),
        Check(f"{label}, angle RMS in the gap / FCDI", value / kinematic, bound, "<="),
        Check(f"{label}, back after the gap, slowest", slowest, back_ms, "<=", "ms"),
    ]
