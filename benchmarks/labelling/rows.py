"""The rows of the labelling table on one capture: as it is, with ghosts and gaps, exchanged tracks, after a loss."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from benchmarks.checks import Check
from benchmarks.labelling.live import live_rows, streamed
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject, match_names
from mbkf.synthesis.cameras import ghosts, occlusions, without_labels
from mbkf.trial.label import label
from mbkf.trial.labelling.score import LabelScore, score

NEVER_WRONG = ("biomechzoo", "gaitalytics", "synthetic")
GHOSTS, HIDDEN_SHARE = 5, 0.10
CROSSING_M, CROSSING_S = 0.015, 0.4
REPAIRED_FRAMES = 20
LOSS_S, BACK_S = 1.0, 0.5
_PERCENT = 100.0


@dataclass(frozen=True)
class Trial:
    """A labelled capture under the subject's names, holding only the subject's markers, and the subject.

    ``judged`` says whether bounds are on it, or it is shown for information.
    """

    name: str
    capture: Capture
    subject: Subject
    judged: bool = True


def plain_rows(trial: Trial) -> list[Check]:
    """As they are: every point of the capture, shuffled."""
    points = shuffled(trial.capture.markers.positions_m, 0)
    found, seconds = labelled(trial, points)
    least, most = 99.8, (0.0 if trial.name.startswith(NEVER_WRONG) else math.inf)
    label_ = f"{trial.name}, as it is"
    live = streamed(points, truth_of(trial, points), trial.subject)
    return [
        *share_rows(label_, [found], least, most),
        Check(f"{label_}: time / duration", seconds / duration_s(trial), math.inf, "<="),
        *live_rows(label_, live, bounded=True),
    ]


def hard_rows(trial: Trial, seeds: range) -> list[Check]:
    """Five ghosts near the body and a tenth of the samples hidden in streaks of 20 frames."""
    label_ = f"{trial.name}, {GHOSTS} ghosts, {_PERCENT * HIDDEN_SHARE:.0f} % hidden, {len(seeds)} seeds"
    shown = [shuffled(hard(trial.capture.markers, seed), seed) for seed in seeds]
    found = [labelled(trial, points)[0] for points in shown]
    live = streamed(shown[0], truth_of(trial, shown[0]), trial.subject)
    return [*share_rows(label_, found, 99.0, 0.1), *live_rows(f"{label_}, the first", live, bounded=False)]


def hard(markers: MarkerTrajectories, seed: int) -> Array:
    """(T, C, 3) with samples hidden, and ghosts in further columns."""
    rng = np.random.default_rng([seed, 5])
    positions = markers.positions_m.copy()
    middle = np.nanmean(positions, axis=1, keepdims=True)
    near = ghosts(np.where(np.isnan(positions), middle, positions), GHOSTS, markers.rate_hz, rng)
    positions[occlusions(len(positions), positions.shape[1], HIDDEN_SHARE, rng)] = np.nan
    return np.concatenate([positions, near], axis=1)


def crossing_rows(trial: Trial) -> list[Check]:
    """Two columns whose points come within 15 mm of each other and go on under each other's number.

    The columns are tracks here, as a tracker that confused two points would have written them.
    """
    frames, rate = trial.capture.markers.frames, trial.capture.markers.rate_hz
    positions, middle, pair = crossed(trial)
    truth = with_positions(trial.capture, positions)
    columns = positions.copy()
    columns[middle:, pair] = positions[middle:, pair[::-1]]
    found, _ = labelled(replace(trial, capture=truth), columns)
    names = [found.names.index(name) for name in own_names(trial, [truth.markers.names[k] for k in pair])]
    bad = np.flatnonzero((found.wrong | found.missed)[:, names].any(axis=1))
    later = bad[bad >= middle]
    until = float(later[-1] - middle + 1) if len(later) else 0.0
    label_ = f"{trial.name}, {' and '.join(found.names[k] for k in names)} exchanged at {middle / rate:.2f} s"
    return [
        Check(f"{label_}: repaired after", until, REPAIRED_FRAMES, "<=", "frames"),
        Check(f"{label_}: frames wrong or missed", float(len(bad)), math.inf, "<=", f"of {frames}"),
    ]


def crossed(trial: Trial) -> tuple[Array, int, list[int]]:
    """Positions in which the two markers of different segments that come nearest are bent to 15 mm distance."""
    markers, subject = trial.capture.markers, trial.subject
    match = match_names(markers.names, subject.markers)
    own = [k for k, name in enumerate(markers.names) if name in match]
    segment = {k: match[markers.names[k]].segment for k in own}
    positions = markers.positions_m.copy()
    edge = round(CROSSING_S * markers.rate_hz)
    best = (math.inf, 0, [own[0], own[1]])
    for i, a in enumerate(own):
        for b in own[i + 1 :]:
            if segment[a] == segment[b]:
                continue
            distance = np.linalg.norm(positions[edge:-edge, a] - positions[edge:-edge, b], axis=1)
            if np.isfinite(distance).all():
                at = int(distance.argmin())
                best = min(best, (float(distance[at]), at + edge, [a, b]))
    gap, middle, pair = best
    bump = np.zeros(markers.frames)
    bump[middle - edge : middle + edge] = np.hanning(2 * edge)
    away = positions[:, pair[1]] - positions[:, pair[0]]
    share = max(0.0, 1.0 - CROSSING_M / gap)
    towards = 0.5 * share * bump[:, None] * away[middle]
    positions[:, pair[0]] += towards
    positions[:, pair[1]] -= towards
    return positions, middle, pair


def loss_rows(trial: Trial) -> list[Check]:
    """All points lost for a second in the middle of the capture; less where that leaves too little around it."""
    markers = trial.capture.markers
    around = round((BACK_S + 0.05) * markers.rate_hz)
    length = min(round(LOSS_S * markers.rate_hz), markers.frames - 2 * around)
    first = (markers.frames - length) // 2
    positions = markers.positions_m.copy()
    positions[first : first + length] = np.nan
    hidden = replace(trial, capture=with_positions(trial.capture, positions))
    found, _ = labelled(hidden, shuffled(positions, 7))
    back = first + length + round(BACK_S * markers.rate_hz)
    after = slice(back, None)
    present = found.right[after].sum() + found.missed[after].sum()
    right = _PERCENT * float(found.right[after].sum()) / max(1, present)
    wrong = float(found.wrong[first + length :].sum())
    label_ = f"{trial.name}, all lost for {length / markers.rate_hz:.2f} s"
    live = streamed(shuffled(positions, 7), truth_of(hidden, positions), trial.subject)
    return [
        *live_rows(f"{label_}, from {BACK_S} s after the return", live, after, bounded=False),
        Check(f"{label_}: right from {BACK_S} s after the return", right, 99.8, ">=", "%"),
        Check(f"{label_}: wrong after the return", wrong, 0.0, "<=", "samples"),
    ]


def share_rows(name: str, found: list[LabelScore], least: float, most: float) -> list[Check]:
    """Right and wrong samples of several runs, in % of those present.

    Args:
        name: Beginning of the rows' names.
        found: Scores of the runs.
        least: Least share of right samples, %.
        most: Largest share of wrong samples, %.
    """
    present = sum(one.present for one in found)
    right = _PERCENT * sum(int(one.right.sum()) for one in found) / present
    wrong = _PERCENT * sum(int(one.wrong.sum()) for one in found) / present
    return [
        Check(f"{name}: right", right, least, ">=", "%"),
        Check(f"{name}: wrong", wrong, most, "<=", "%"),
    ]


def labelled(trial: Trial, points_m: Array) -> tuple[LabelScore, float]:
    """Labels points (T, C, 3) with the trial's subject; the score against its capture, and the seconds it took.

    Where nothing is labelled, every sample counts as missed.
    """
    names = tuple(f"*{k}" for k in range(points_m.shape[1]))
    markers = trial.capture.markers
    raw = replace(trial.capture, markers=replace(markers, names=names, positions_m=points_m))
    seen = trial.capture.markers
    begin = perf_counter()
    try:
        found = label(raw, trial.subject).markers
    except MbkfError:
        found = replace(seen, names=(), positions_m=np.zeros((seen.frames, 0, 3)))
    seconds = perf_counter() - begin
    return score(found, truth_of(trial, points_m), trial.subject), seconds


def truth_of(trial: Trial, points_m: Array) -> MarkerTrajectories:
    """The trial's markers where their points are among those given (T, C, 3)."""
    markers = trial.capture.markers
    shown = markers.positions_m.copy()
    for t, frame in enumerate(points_m):
        there = {point.tobytes() for point in frame}
        shown[t, [point.tobytes() not in there for point in shown[t]]] = np.nan
    return replace(markers, positions_m=shown)


def shuffled(positions_m: Array, seed: int) -> Array:
    """(T, C, 3) the same points in a new order in every frame."""
    return without_labels(positions_m, np.random.default_rng([seed, 11]))


def with_positions(capture: Capture, positions_m: Array) -> Capture:
    """The capture with other positions of its markers."""
    return replace(capture, markers=replace(capture.markers, positions_m=positions_m))


def own_names(trial: Trial, names: list[str]) -> list[str]:
    """The subject's names of a capture's markers."""
    match = match_names(trial.capture.markers.names, trial.subject.markers)
    return [match[name].name for name in names]


def duration_s(trial: Trial) -> float:
    """Length of the capture."""
    return trial.capture.markers.frames / trial.capture.markers.rate_hz
