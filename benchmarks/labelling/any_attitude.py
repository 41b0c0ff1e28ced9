"""Labelling without a standing pose: a kneeling stranger, a prone subject, and strangers known by protocol alone.

S09_KneeltoRun02 is unlabelled and has no static trial, so its labels are not known. What can be measured: how much is
named, whether a track keeps its name, whether a body moves along with it, and whether each cluster's markers stand in
the order that the set's own MarkerSet.xml (OpenSim, generic body) has them. Eight of its columns hold several points
one after the other: the point leaps over a gap to where another one was lost. A track is a column between such leaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from time import perf_counter
from xml.etree import ElementTree

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.labelling.rows import (
    Trial,
    crossing_rows,
    duration_s,
    hard_rows,
    loss_rows,
    plain_rows,
    share_rows,
    shuffled,
    truth_of,
)
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.model.protocol import load_protocol
from mbkf.trial.label_unscaled import label_unscaled
from mbkf.trial.labelling.result import labelled_capture
from mbkf.trial.labelling.score import LabelScore, score
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

FOLDER = "autolabel_unlabelled_fullbody"
KNEELING, PRONE, MARKER_SET = "S09_KneeltoRun02_UNLABELLED.c3d", "PronetoRun01_labelled.c3d", "MarkerSet.xml"
PROTOCOL = "autolabel62"
MASS_KG = 75.0
"""Not known for this person; it does not enter marker positions."""

LEAP_M = 0.05
"""A column whose point is further from where it was before a gap is another point's from there on."""

MISNAMED, RIGHT_NAME, MISNAMED_FROM = "LSHPA", "LSHPP", 1248

CLUSTER_MARKERS = (3, 4)
LEAST_SHARE = 98.0
PROTOCOL_ALONE = ("gaitalytics", "rajagopal walk", "synthetic")
PARTLY_WORN = ("biomechzoo", "rajagopal run")
"""Trials whose protocols list ten and twelve markers that were not worn."""
_PERCENT = 100.0


def rows(context: Context, others: Iterator[Trial]) -> list[Check]:
    """Rows of the kneeling stranger and the prone subject, and of the other trials without their subjects."""
    folder = context.require_data() / FOLDER
    prone = prone_trial(folder)
    checks = [*plain_rows(prone), *crossing_rows(prone), *loss_rows(prone)]
    if not context.quick:
        checks += hard_rows(prone, range(1))
    checks += stranger_rows(prone, 99.8)
    for trial in others:
        if trial.name.startswith(PROTOCOL_ALONE):
            checks += stranger_rows(trial, math.inf)
        elif trial.name.startswith(PARTLY_WORN) and trial.judged:
            checks += stranger_rows(trial, 99.8, 0.1)
    return [*checks, *kneeling_rows(folder)]


def prone_trial(folder: Path) -> Trial:
    """The prone subject, scaled from the trial's own labels."""
    capture = read_capture(folder / PRONE)
    markers = capture.markers
    positions = markers.positions_m.copy()
    wrong, right = markers.names.index(MISNAMED), markers.names.index(RIGHT_NAME)
    positions[MISNAMED_FROM:, [wrong, right]] = positions[MISNAMED_FROM:, [right, wrong]]
    capture = replace(capture, markers=replace(markers, positions_m=positions))
    return Trial("PronetoRun01", capture, scale(None, [capture], mass_kg=MASS_KG))


def stranger_rows(trial: Trial, least: float, most: float = math.inf) -> list[Check]:
    """A trial's shuffled points, labelled by the protocol's name; wrong labels without a warning are counted.

    Args:
        trial: The trial with its true labels.
        least: Least share of right labels, %.
        most: Largest share of wrong labels, %.
    """
    points = shuffled(trial.capture.markers.positions_m, 0)
    names = tuple(f"*{k}" for k in range(points.shape[1]))
    raw = replace(trial.capture, markers=replace(trial.capture.markers, names=names, positions_m=points))
    begin = perf_counter()
    found, subject = label_unscaled(raw, trial.subject.protocol, mass_kg=trial.subject.mass_kg)
    seconds = perf_counter() - begin
    result: LabelScore = score(found.markers, truth_of(trial, points), subject)
    name = f"{trial.name}, by its protocol alone"
    shares = share_rows(name, [result], 0.0, most)
    shares[0] = replace(shares[0], bound=least, relation=">=" if math.isfinite(least) else "<=")
    assert found.doubts is not None, "the person was not measured before"
    sure = np.array([label not in found.doubts.labels for label in result.names])
    untold = _PERCENT * float(result.wrong[:, sure].sum()) / result.present
    return [
        *shares,
        Check(f"{name}: wrong and not told", untold, 0.1, "<=", "%"),
        Check(f"{name}: time / duration", seconds / duration_s(trial), math.inf, "<="),
    ]


def kneeling_rows(folder: Path) -> list[Check]:
    """The unlabelled capture of a kneeling person who gets up and runs."""
    raw = read_capture(folder / KNEELING)
    begin = perf_counter()
    found, subject = label_unscaled(raw, PROTOCOL, mass_kg=MASS_KG)
    seconds = perf_counter() - begin
    worn = sum(marker.kind != "computed" for marker in load_protocol(PROTOCOL).markers)
    named = _PERCENT * float(found.markers.present.sum()) / (worn * found.markers.frames)
    pieces = kept_shares(raw.markers, found.label_of_point, 0.0)
    tracks = kept_shares(raw.markers, found.label_of_point, LEAP_M)
    columns = kept_shares(raw.markers, found.label_of_point, math.inf)
    result = reconstruct(labelled_capture(raw, found), subject, settings=ReconstructSettings(smooth=False))
    distance = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)
    ordered, clusters = in_order(subject, folder / MARKER_SET)
    name = "S09_KneeltoRun02"
    return [
        Check(f"{name}: marker-frames assigned, of {worn} markers", named, 95.0, ">=", "%"),
        Check(
            f"{name}: least share of one label in {len(pieces)} pieces", pieces.min(), LEAST_SHARE, ">=", "%"
        ),
        Check(
            f"{name}: least share of one label in {len(tracks)} tracks", tracks.min(), LEAST_SHARE, ">=", "%"
        ),
        Check(
            f"{name}: columns, leaps and all, with one label in {LEAST_SHARE:.0f} %",
            float((columns >= LEAST_SHARE).sum()),
            math.inf,
            "<=",
            f"of {len(columns)}",
        ),
        Check(f"{name}: clusters ordered as in {MARKER_SET}", float(ordered), float(clusters), ">="),
        Check(f"{name}: marker RMS", 1e3 * float(np.sqrt(np.nanmean(distance**2))), 15.0, "<=", "mm"),
        Check(f"{name}: time / duration", seconds * raw.markers.rate_hz / raw.markers.frames, math.inf, "<="),
    ]


def kept_shares(markers: MarkerTrajectories, labels: Indices, leap_m: float) -> Array:
    """For every track the share in % of its frames that have its commonest label; none counts as a label.

    A column is cut into tracks at gaps over which its point moves further than ``leap_m``.

    Args:
        markers: The points as stored, one column per track.
        labels: (T, C) label of each point.
        leap_m: Largest movement over a gap within a track, m.
    """
    shares = []
    for column in range(labels.shape[1]):
        positions = markers.positions_m[:, column]
        seen = np.flatnonzero(~np.isnan(positions[:, 0]))
        moved = np.linalg.norm(np.diff(positions[seen], axis=0), axis=1)
        cuts = np.flatnonzero((np.diff(seen) > 1) & (moved > leap_m)) + 1
        for track in np.split(seen, cuts):
            counts = np.bincount(labels[track, column] - HIDDEN)
            shares.append(_PERCENT * counts.max() / len(track))
    return np.array(shares)


def in_order(subject: Subject, marker_set: Path) -> tuple[int, int]:
    """How many clusters of the subject have their markers where the marker set's file has them, and how many there are.

    Three or four markers with names alike but for the last letters are a cluster. They are in order where no exchange
    of their names brings them, about their middle, nearer to the file's places; axes are alike but for their names.
    """
    generic = {}
    for marker in ElementTree.parse(marker_set).iter("Marker"):
        forward, up, right = (float(x) for x in (marker.findtext("location") or "").split())
        generic[marker.get("name")] = np.array([forward, -right, up])
    own = {m.name: m.position_m for m in subject.markers if m.name in (subject.scaled_markers or ())}
    found = [cluster for cluster in _clusters(subject) if all(name in own for name in cluster)]
    right = 0
    for cluster in found:
        here = np.array([own[name] for name in cluster])
        there = np.array([generic[name] for name in cluster])
        here, there = here - here.mean(axis=0), there - there.mean(axis=0)
        orders = list(permutations(range(len(cluster))))
        misfit = [float(((here[list(order)] - there) ** 2).sum()) for order in orders]
        right += orders[int(np.argmin(misfit))] == tuple(range(len(cluster)))
    return right, len(found)


def _clusters(subject: Subject) -> list[list[str]]:
    """Names of the markers of each cluster: those of a segment that share their first letters."""
    groups: dict[tuple[str, str], list[str]] = {}
    for marker in subject.markers:
        stem = marker.name[1:] if marker.segment == "head" else marker.name[:3]
        stem = stem[:2] if marker.segment in ("pelvis", "torso") else stem
        groups.setdefault((marker.segment, stem), []).append(marker.name)
    return [names for names in groups.values() if len(names) in CLUSTER_MARKERS]
