"""Labels of a scaled person that may be wrong: the capture shows a marker elsewhere than the standing trial did.

Markers are moved, lost or added between the trials, and a ghost may take the place of one that is not worn. A label is
judged by the distance of its points, on the smoothed body, from the place that scaling found and from those of
neighbours.
"""

from __future__ import annotations

import itertools
import math
import warnings
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.tracklets import link_points
from mbkf.trial.labelling.body import LabelBody
from mbkf.trial.labelling.doubts import DOUBTFUL_ODDS, Doubt, Doubts
from mbkf.trial.labelling.known_names import KnownNames
from mbkf.trial.labelling.relabelling import Relabelled, trajectories

MOVED_SD_M = 0.008
"""Spread of an untouched marker about its place in scaling."""

FAR, NAMED_FAR = 1.2, 2.0
"""A label is doubtful at so many standard deviations from its place, or at so many where the capture names it."""

RARE = 0.5
"""A label is doubtful in a smaller share of the usual number of frames, unless the capture names it."""

NAMED_ODDS = 1e3
"""Odds that a name adds to its label."""

NAMED_SHARE = 0.5
"""Share of its points named by the capture from which a label counts as named."""

MOST_ODDS = 1e6


@dataclass(frozen=True)
class _Found:
    """The N markers found, as the capture shows them.

    Attributes:
        markers: (N,) their numbers among the subject's.
        local_m: (N, 3) mean place in the segment's frame.
        share: (N,) share of the frames that show it.
        named: (N,) share of its points to which the capture gives the same name.
    """

    markers: Indices
    local_m: Array
    share: Array
    named: Array


def scaled_doubts(
    body: LabelBody, points: MarkerTrajectories, found: Relabelled, names: KnownNames
) -> Doubts:
    """Doubts about the labels of a scaled person.

    Args:
        body: The subject as scaled.
        points: The capture.
        found: The labels, with the body by which they were judged.
        names: The capture's names.
    """
    lines = _contradictions(body, points, found, names)
    labels = found.label_of_point
    unused = tuple(name for m, name in enumerate(body.names) if not (labels == m).any())
    doubts = Doubts((), {}, 0.0, _nameless(points, labels), unused, scaled=True, names=lines)
    if found.places is None or found.body is None:
        return doubts
    shown = _found(body, points, found, found.body, names)
    if not len(shown.markers):
        return doubts
    place, spread = body.sensor.local_m, _spread(body)
    off = np.linalg.norm(shown.local_m - place[shown.markers], axis=1)
    deviation = off / spread[shown.markers]
    limit = np.where(shown.named >= NAMED_SHARE, NAMED_FAR, FAR)
    far = {
        body.names[m]: float(d)
        for m, d, s, most in zip(shown.markers, off, deviation, limit, strict=True)
        if s > most
    }
    usual = float(np.median(shown.share))
    rare = {
        body.names[m]: float(share)
        for m, share, named in zip(shown.markers, shown.share, shown.named, strict=True)
        if share < RARE * usual and named < NAMED_SHARE
    }
    cases, odds = _rivals(body, shown)
    return replace(
        doubts,
        cases=tuple(sorted(cases, key=lambda case: case.odds)),
        far_m=far,
        misfit=float(np.mean(deviation**2) / 3.0),
        rare=rare,
        odds=odds,
    )


def _spread(body: LabelBody) -> Array:
    """(M,) spread of each marker of the subject about its place."""
    return np.array([np.hypot(np.hypot(m.noise_m, m.session_sd_m), MOVED_SD_M) for m in body.markers])


def _found(
    body: LabelBody, points: MarkerTrajectories, found: Relabelled, corrected: LabelBody, names: KnownNames
) -> _Found:
    assert found.places is not None
    own = trajectories(points, found.label_of_point, body.names).select(corrected.names)
    offset = found.places.local(own.positions_m)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # markers without a frame
        local = corrected.sensor.local_m + np.nanmean(offset, axis=0)
    markers = np.array([body.names.index(name) for name in corrected.names], dtype=np.intp)
    count = own.present.sum(axis=0)
    same = (names.trusted == found.label_of_point) & (names.trusted != HIDDEN)
    named = np.array([(same & (found.label_of_point == m)).sum() for m in markers]) / np.maximum(1, count)
    there = ~np.isnan(local).any(axis=1)
    return _Found(markers[there], local[there], (count / points.frames)[there], named[there])


def _rivals(body: LabelBody, shown: _Found) -> tuple[list[Doubt], dict[str, float]]:
    """Names of one segment that fit nearly as well, and the odds of every label against the most likely of them."""
    place, spread, names = body.sensor.local_m, _spread(body), body.names
    segments = body.sensor.segments
    away = np.linalg.norm(shown.local_m[:, None] - place, axis=2)  # (N, M)
    cost = (away / spread) ** 2
    row = {int(m): k for k, m in enumerate(shown.markers)}
    prior = np.where(shown.named >= NAMED_SHARE, 2.0 * math.log(NAMED_ODDS), 0.0)
    cases, odds = [], {names[m]: MOST_ODDS for m in row}
    for a, b in itertools.combinations(range(len(names)), 2):
        changed = [(m, other) for m, other in ((a, b), (b, a)) if m in row]
        if not changed or segments[a] != segments[b]:
            continue
        rows, others = [row[m] for m, _ in changed], [other for _, other in changed]
        own = [m for m, _ in changed]
        gap = float((cost[rows, others] - cost[rows, own] + prior[rows]).sum())
        likelier = math.exp(0.5 * min(gap, 2.0 * math.log(MOST_ODDS)))
        for m in own:
            odds[names[m]] = min(odds[names[m]], likelier)
        if likelier <= DOUBTFUL_ODDS:
            cases.append(
                Doubt(
                    tuple(names[m] for m in own),
                    tuple(names[m] for m in others),
                    likelier,
                    tuple(float(x) for x in away[rows, own]),
                    tuple(float(x) for x in away[rows, others]),
                )
            )
    return cases, odds


def _nameless(points: MarkerTrajectories, labels: Indices) -> int:
    """Number of tracklets without a label that span half of the capture or more."""
    pieces = link_points(points.positions_m).pieces
    return sum(len(f) >= 0.5 * points.frames and bool((labels[f, c] == HIDDEN).all()) for f, c in pieces)


def _contradictions(
    body: LabelBody, points: MarkerTrajectories, found: Relabelled, names: KnownNames
) -> tuple[str, ...]:
    """Sentences about the names that the labels contradict, with distances where both markers are on the body."""
    if names.ignored:
        return (f"the capture's names are ignored: {names.ignored}",)
    lines = []
    contradicted = np.where(names.claimed == found.label_of_point, names.claimed != names.trusted, False)
    for marker in np.unique(names.claimed[contradicted & (names.claimed != HIDDEN)]):
        frames, _ = np.nonzero(contradicted & (names.claimed == marker))
        lines.append(
            f"name {body.names[marker]} at frames {frames.min()}–{frames.max()} ({len(frames)} samples) is kept, "
            "but its distances to other markers contradict the body"
        )
    for marker in np.unique(names.claimed[names.claimed != HIDDEN]):
        frames, columns = np.nonzero((names.claimed == marker) & (found.label_of_point != marker))
        given = found.label_of_point[frames, columns]
        for other in np.unique(given):
            own = given == other
            first, last = int(frames[own].min()), int(frames[own].max())
            where = f"name {body.names[marker]} at frames {first}–{last} ({int(own.sum())} samples)"
            if other == HIDDEN:
                lines.append(f"{where} was removed: its points fit no marker")
                continue
            at, shown = frames[own], points.positions_m[frames[own], columns[own]]
            off = [_away_mm(found, body.names[m], at, shown) for m in (marker, other)]
            numbers = "" if None in off else f": {off[1]:.0f} instead of {off[0]:.0f} mm from its place"
            lines.append(f"{where} was changed to {body.names[other]}{numbers}")
    return tuple(lines)


def _away_mm(found: Relabelled, name: str, frames: Indices, points_m: Array) -> float | None:
    """Median distance of points (k, 3) from a marker's places on the smoothed body, None where it is not placed."""
    if found.places is None or found.body is None or name not in found.body.names:
        return None
    away = np.linalg.norm(points_m - found.places.on_body_m[frames, found.body.names.index(name)], axis=1)
    return None if np.isnan(away).all() else float(1e3 * np.nanmedian(away))
