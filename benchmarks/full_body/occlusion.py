"""Occlusion curves: error of hidden markers, and of joint angles, over the share that is hidden and over gap length.

The filters are compared with what laboratories do before the kinematic filter (splines, rigid-body filling), on three
real walks and on synthetic ones with truth. Of a practice's two answers, the filled position and the body's marker
after the kinematic filter, the better one counts. All methods get the same markers, corrected on what is shown, and the
same settings everywhere; nothing is swept.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import Person, load, present
from benchmarks.dynamic.losses import CAPTURES, FRACTIONS, Occluded, occluded
from benchmarks.dynamic.methods import Mapper, pooled
from benchmarks.dynamic.synthetic import differences, make_case
from benchmarks.full_body.filling import rigid_filled, spline_filled
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, SMOOTHED
from benchmarks.references import rms
from benchmarks.thesis_report.contents import OPEN, Band, Findings, Row, Sheet
from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.cameras import true_markers
from mbkf.synthesis.person import body_of
from mbkf.trial.results.summary import ROOT_DOFS

FCDI_SMOOTHED, DYNAMIC_SMOOTHED = f"{FCDI}, smoothed", f"{DYNAMIC}, smoothed"
METHODS = {name: {**CAUSAL, **SMOOTHED}[name] for name in (FCDI, DYNAMIC, FCDI_SMOOTHED, DYNAMIC_SMOOTHED)}

SPLINE, RIGID, RIGID_NEAR = "cubic spline", "rigid body, own segment", "rigid body, neighbours too"
RIGID_PAST = "rigid body, past only"
OFFLINE = (SPLINE, RIGID, RIGID_NEAR)
"""What laboratories do once a capture is over: both edges of a gap are known."""

FILLED, AFTER = ": filled", ": then FCDI"
ESTIMATES = (*METHODS, *(name + kind for name in (*OFFLINE, RIGID_PAST) for kind in (FILLED, AFTER)))

SHARES = (0.05, 0.10, 0.20, 0.27, 0.35, 0.50)
GAPS_S = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
GAP_S, SHARE = 0.2, 0.10
"""Gap length of the curves over the share, and share of the curves over gap length."""

SYNTHETIC = "synthetic walk"
SEEDS, FEW_SEEDS = 4, 1
"""Random seeds where there is a bound on real walks, and elsewhere."""

SYNTHETIC_SEEDS = 2

CAUSAL_RATIO, SMOOTHED_RATIO = 1.0, 0.7
WITHIN_SD, NOMINAL = 1.96, 0.95
_OVER = "over the best of spline, rigid-body filling and FCDI"
_MM = 1e3


@dataclass(frozen=True)
class Condition:
    """Hidden are streaks of ``gap_s`` over a ``share`` of all marker-frames; where they overlap, gaps are longer."""

    share: float
    gap_s: float

    @property
    def bounded(self) -> bool:
        """Whether the methods are judged here on real walks."""
        return self.share in FRACTIONS and self.gap_s == GAP_S


@dataclass(frozen=True)
class Trial:
    """One hiding: a person, not corrected yet, with the truth if it is known, a condition and a random seed."""

    person: Person
    truth: Truth | None
    condition: Condition
    seed: int


@dataclass(frozen=True)
class Score:
    """Errors of one estimate.

    Attributes:
        hidden_mm: RMS distance of hidden markers from where they were measured.
        true_mm: RMS distance of hidden markers of the body from their true places on the bones.
        angle_deg: RMS error of the joints' angles, all frames.
        cover: Share of them within 1.96 stated standard deviations.
    """

    hidden_mm: float
    true_mm: float = float("nan")
    angle_deg: float = float("nan")
    cover: float = float("nan")


Scores = Mapping[str, Score]


@dataclass(frozen=True)
class Point:
    """Scores of all estimates (:data:`ESTIMATES`) at one condition of one capture, pooled over ``seeds`` hidings."""

    capture: str
    condition: Condition
    seeds: int
    scores: Scores

    def hidden_mm(self, name: str) -> float:
        """Hidden-marker RMS of a filter, or of a practice's better answer."""
        if name in METHODS:
            return self.scores[name].hidden_mm
        return min(self.scores[name + FILLED].hidden_mm, self.scores[name + AFTER].hidden_mm)

    def best(self, names: Iterable[str]) -> str:
        """The one with the smallest hidden-marker RMS."""
        return min(names, key=self.hidden_mm)

    def ratio(self, name: str, others: Iterable[str] = (*OFFLINE, FCDI)) -> float:
        """Hidden-marker RMS over that of the best of others."""
        return self.hidden_mm(name) / self.hidden_mm(self.best(others))


def measured(data: Path | None, mapper: Mapper, *, quick: bool) -> tuple[Point, ...]:
    """All points of all curves; a condition of both curves is measured once.

    Args:
        data: Folder of the public captures; without it, or where a walk is missing, synthetic walks remain.
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether one walk and one condition, with one seed, are enough.
    """
    conditions = _conditions(quick)
    people = [load(name, data, correct=False) for name in real_walks(data, quick=quick) if data is not None]
    counts = {one: 1 if quick else SEEDS if one.bounded else FEW_SEEDS for one in conditions}
    trials = [
        Trial(person, None, one, seed)
        for person in people
        for one in conditions
        for seed in range(counts[one])
    ]
    if not (quick and people):
        trials += [
            Trial(person, truth, one, seed)
            for seed, (person, truth) in enumerate(mapper(_synthetic, range(1 if quick else SYNTHETIC_SEEDS)))
            for one in conditions
        ]
    groups: dict[tuple[str, Condition], list[Scores]] = {}
    for trial, scores in zip(trials, mapper(scores_of, trials), strict=True):
        groups.setdefault((trial.person.name, trial.condition), []).append(scores)
    return tuple(Point(name, one, len(found), _pooled(found)) for (name, one), found in groups.items())


def real_walks(data: Path | None, *, quick: bool) -> list[str]:
    """Names of the real walks that are measured and there; the first one when quick."""
    return present(CAPTURES[: 1 if quick else None], data)


def bands_left_out(data: Path | None, *, quick: bool) -> list[str]:
    """Names of the bounded numbers that real walks which are missing would give."""
    wanted = CAPTURES[: 1 if quick else None]
    missing = [name for name in wanted if name not in real_walks(data, quick=quick)]
    kinds = (f"dynamic {_OVER}", f"smoothed {_OVER}")
    bounded = [one for one in _conditions(quick) if one.bounded]
    return [f"{_row(name, one)}: {kind}" for name in missing for one in bounded for kind in kinds]


def _row(name: str, condition: Condition) -> str:
    return f"occlusion, {name}, {100 * condition.share:.0f} % hidden"


def _conditions(quick: bool) -> list[Condition]:
    if quick:
        return [Condition(SHARE, GAP_S)]
    wanted = [Condition(share, GAP_S) for share in SHARES] + [Condition(SHARE, gap_s) for gap_s in GAPS_S]
    return list(dict.fromkeys(wanted))


def _synthetic(seed: int) -> tuple[Person, Truth]:
    case = make_case(("walk", seed))
    return Person(SYNTHETIC, case.capture, case.given), case.truth


def _pooled(found: Sequence[Scores]) -> Scores:
    return {name: _together([one[name] for one in found]) for name in ESTIMATES}


def _together(scores: Sequence[Score]) -> Score:
    return Score(
        pooled(one.hidden_mm for one in scores),
        pooled(one.true_mm for one in scores),
        pooled(one.angle_deg for one in scores),
        float(np.mean([one.cover for one in scores])),
    )


def scores_of(trial: Trial) -> Scores:
    """Every estimate of one trial."""
    streak = round(trial.condition.gap_s * trial.person.capture.markers.rate_hz)
    case = occluded(trial.person, trial.condition.share, trial.seed, streak)
    with single_threaded():
        filled = fillings(case)
        found = {name: method.run(case.shown, case.subject) for name, method in METHODS.items()}
        for name, positions_m in filled.items():
            markers = replace(case.shown.markers, positions_m=positions_m)
            found[name + AFTER] = CAUSAL[FCDI].run(replace(case.shown, markers=markers), case.subject)
    scores = {name: _score(case, one, trial.truth) for name, one in found.items()}
    for name, positions_m in filled.items():
        # What was not filled is where the kinematic filter has it.
        position = np.where(np.isnan(positions_m), _markers(found[name + AFTER], case), positions_m)
        scores[name + FILLED] = replace(scores[name + AFTER], hidden_mm=hidden_mm(case, position))
    return scores


def fillings(case: Occluded) -> dict[str, Array]:
    """(T, M, 3) markers with gaps filled, NaN where a practice cannot, by the practice."""
    positions = case.shown.markers.positions_m
    segment = {marker.name: marker.segment for marker in case.subject.markers}
    rigid = partial(
        rigid_filled, positions, [segment[name] for name in case.shown.markers.names], case.subject
    )
    return {
        SPLINE: spline_filled(positions),
        RIGID: rigid(neighbours=False),
        RIGID_NEAR: rigid(),
        RIGID_PAST: rigid(past_only=True),
    }


def hidden_mm(case: Occluded, positions_m: Array) -> float:
    """RMS distance of hidden markers from where they were measured.

    Args:
        case: What was hidden.
        positions_m: (T, M, 3) estimated positions, in the order of the capture.
    """
    return _MM * rms(np.linalg.norm(positions_m - case.withheld_m, axis=2)[case.hidden])


def _markers(found: Reconstruction, case: Occluded) -> Array:
    return found.predicted_m[:, [found.marker_names.index(name) for name in case.shown.markers.names]]


def _score(case: Occluded, found: Reconstruction, truth: Truth | None) -> Score:
    own = hidden_mm(case, _markers(found, case))
    if truth is None:
        return Score(own)
    error = differences(found, truth)[0]
    return Score(
        own,
        _true_mm(case, found, truth),
        float(np.rad2deg(rms(error))),
        covered(error, found.sd_q[:, ROOT_DOFS:]),
    )


def _true_mm(case: Occluded, found: Reconstruction, truth: Truth) -> float:
    """RMS distance of hidden markers of the body, without skin, from their true places."""
    names = case.shown.markers.names
    by_name = {marker.name: marker for marker in found.subject.markers}
    subject = replace(found.subject, markers=tuple(by_name[name] for name in names))
    on_body = np.full((found.frames, len(names), 3), np.nan)
    on_body[found.tracked] = true_markers(body_of(subject), subject, found.q[found.tracked])
    true = truth.markers_m[:, [truth.marker_names.index(name) for name in names]]
    return _MM * rms(np.linalg.norm(on_body - true, axis=2)[case.hidden])


def covered(error: Array, sd: Array) -> float:
    """Share of errors within 1.96 stated standard deviations, of those that are stated.

    Args:
        error: (T, n) errors, NaN where unknown.
        sd: (T, n) their standard deviations, NaN where not stated.
    """
    known = np.isfinite(error) & np.isfinite(sd)
    return float((np.abs(error) <= WITHIN_SD * sd)[known].mean()) if known.any() else float("nan")


def occlusion_findings(points: Sequence[Point]) -> Findings:
    """Bounds and tables of what :func:`measured` found."""
    bands = []
    for point in points:
        if point.capture in CAPTURES and point.condition.bounded:
            row = _row(point.capture, point.condition)
            bands += [
                Band(row, f"dynamic {_OVER}", point.ratio(DYNAMIC), -OPEN, CAUSAL_RATIO),
                Band(row, f"smoothed {_OVER}", point.ratio(DYNAMIC_SMOOTHED), -OPEN, SMOOTHED_RATIO),
            ]
    note = (
        "Hidden-marker RMS against the withheld samples; on synthetic walks also against the truth. Streaks may "
        "overlap to longer gaps. A spline needs both ends of a gap: at the trial's ends nothing is filled, and the "
        "kinematic filter's marker counts. Only the filters without 'smoothed', and 'past only', see no later frame."
    )
    by_share, by_gap = over_share(points), over_gap(points)
    sheets = [
        _ratios(points),
        Sheet("occlusion_share", f"Share hidden, in streaks of {GAP_S:g} s", *_errors(by_share), note),
        Sheet("occlusion_gap", f"Gap length, {100 * SHARE:.0f} % hidden", *_errors(by_gap), note),
        Sheet(
            "occlusion_truth",
            "Hidden markers on synthetic walks, against the truth",
            *_truth([*by_share, *by_gap]),
        ),
    ]
    return Findings(bands, sheets)


def over_share(points: Iterable[Point]) -> list[Point]:
    """Points of the curves over the share, in its order."""
    return sorted(
        (p for p in points if p.condition.gap_s == GAP_S), key=lambda p: (p.capture, p.condition.share)
    )


def over_gap(points: Iterable[Point]) -> list[Point]:
    """Points of the curves over gap length, in its order."""
    return sorted(
        (p for p in points if p.condition.share == SHARE), key=lambda p: (p.capture, p.condition.gap_s)
    )


def _errors(points: Sequence[Point]) -> tuple[tuple[str, ...], tuple[Row, ...]]:
    """Columns and rows of the hidden markers' errors."""
    columns = ("capture", "hidden (%)", "gap (s)", "hidings", *(f"{name} (mm)" for name in ESTIMATES))
    rows: list[Row] = [
        (
            p.capture,
            100 * p.condition.share,
            p.condition.gap_s,
            p.seeds,
            *(p.scores[name].hidden_mm for name in ESTIMATES),
        )
        for p in points
    ]
    return columns, tuple(rows)


def _truth(points: Iterable[Point]) -> tuple[tuple[str, ...], tuple[Row, ...]]:
    """Columns and rows of what the truth tells: a row per condition and method."""
    columns = (
        "hidden (%), gap (s)",
        "method",
        "body's markers to the truth (mm)",
        "joint angles (°)",
        "cover of 95 %",
    )
    judged = (*METHODS, *(name + AFTER for name in (*OFFLINE, RIGID_PAST)))
    rows: list[Row] = []
    for p in {p.condition: p for p in points if p.capture == SYNTHETIC}.values():
        condition = f"{100 * p.condition.share:.0f} %, {p.condition.gap_s:g} s"
        for name in judged:
            one = p.scores[name]
            rows.append((condition, name, one.true_mm, one.angle_deg, one.cover))
    return columns, tuple(rows)


def _ratios(points: Sequence[Point]) -> Sheet:
    """Every point's best practice, and the dynamic filter over it."""
    past, offline = (RIGID_PAST, FCDI), (*OFFLINE, FCDI)
    columns = (
        "capture", "hidden (%)", "gap (s)", "best, both edges known", "its error (mm)", "dynamic over it",
        "dynamic, smoothed, over it", "FCDI, smoothed, over it", "best, past only", "dynamic over it",
    )  # fmt: skip
    rows: list[Row] = []
    for p in points:
        practice, condition = p.best(offline), (p.capture, 100 * p.condition.share, p.condition.gap_s)
        ratios = (p.ratio(name) for name in (DYNAMIC, DYNAMIC_SMOOTHED, FCDI_SMOOTHED))
        rows.append(
            (*condition, practice, p.hidden_mm(practice), *ratios, p.best(past), p.ratio(DYNAMIC, past))
        )
    note = (
        "Filling knows the marker after the gap; the dynamic filter, frame by frame, does not. The last columns "
        "compare it with what is known at that time: rigid-body filling from the edge before the gap, and FCDI."
    )
    return Sheet(
        "occlusion_ratios", "Hidden markers: ours over laboratory practice", columns, tuple(rows), note
    )
