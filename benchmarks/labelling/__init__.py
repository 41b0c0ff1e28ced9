"""Labelling: captures with names stripped and points shuffled in every frame, labelled and compared with the truth.

Real captures come with the subject scaled from their static trial. In HC032A's walk the file has the names of LHFB and
LTUB exchanged, 7 cm apart on the left shank: a row measures that against the static trial. Bounds are on the walk with
these two names put right; rows with the file as it stands are beside them for information.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.dynamic.captures import SOURCES
from benchmarks.labelling.any_attitude import rows as any_attitude_rows
from benchmarks.labelling.rows import Trial, crossing_rows, hard_rows, loss_rows, plain_rows
from benchmarks.labelling.speed import speed_rows
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

REAL = ("biomechzoo HC032A", "biomechzoo HC044A", "gaitalytics", "rajagopal walk", "rajagopal run")
CONTRADICTORY, EXCHANGED = "biomechzoo HC032A", {"LHFB": "LTUB", "LTUB": "LHFB"}
"""A walk in which two markers have each other's name, and the names exchanged."""

KNEE, SAME_PLACE_M = "LKNE", 0.012
"""A marker of the same shank or thigh, and how far their distances may differ between two trials."""

SYNTHETIC = ("walk", "squat", "jump")
QUICK = ("gaitalytics", "synthetic walk")

SEEDS, QUICK_SEEDS = 3, 1


def run(context: Context) -> list[Check]:
    """All rows of the labelling table."""
    seeds = range(QUICK_SEEDS if context.quick else SEEDS)
    checks: list[Check] = []
    for trial in trials(context.require_data(), context.quick):
        rows = [*plain_rows(trial), *hard_rows(trial, seeds), *crossing_rows(trial), *loss_rows(trial)]
        checks += rows if trial.judged else [replace(row, bound=math.inf, relation="<=") for row in rows]
    if not context.quick:
        checks = [*exchange_rows(context.require_data()), *checks]
    checks += any_attitude_rows(context, trials(context.require_data(), context.quick))
    return [*checks, *speed_rows()]


def trials(data: Path, quick: bool) -> Iterator[Trial]:
    """The captures of the table."""
    for name in REAL:
        if not quick or name in QUICK:
            source = SOURCES[name]
            folder = data / source.folder
            capture = read_capture(folder / source.trial)
            static = None if source.static is None else read_capture(folder / source.static)
            subject = scale(static, [capture] if static is None else [], mass_kg=source.mass_kg)
            if name == CONTRADICTORY:
                yield Trial(f"{name}, names as in the file", capture, subject, judged=False)
                capture = renamed(capture, EXCHANGED)
            yield Trial(name, capture, subject)
    for motion in SYNTHETIC:
        if not quick or f"synthetic {motion}" in QUICK:
            person, made = synthesise(motion)
            yield Trial(f"synthetic {motion}", made.trial, scale(made.static, mass_kg=person.mass_kg))


def renamed(capture: Capture, names: Mapping[str, str]) -> Capture:
    """The capture with some markers under other names."""
    own = tuple(names.get(name, name) for name in capture.markers.names)
    return replace(capture, markers=replace(capture.markers, names=own))


def exchange_rows(data: Path) -> list[Check]:
    """How far from the knee the two markers of the contradictory capture are, against its static trial."""
    source = SOURCES[CONTRADICTORY]
    assert source.static is not None, "the capture has a static trial"
    walk, static = (read_capture(data / source.folder / file) for file in (source.trial, source.static))
    rows = []
    for name, other in EXCHANGED.items():
        expected = knee_distance_m(static, name)
        wrong, right = (abs(knee_distance_m(walk, one) - expected) for one in (name, other))
        label_ = f"{CONTRADICTORY}, distance {name} to {KNEE} in the walk less that in the static trial"
        rows += [
            Check(f"{label_}, names as in the file", 1e3 * wrong, math.inf, "<=", "mm"),
            Check(f"{label_}, names put right", 1e3 * right, 1e3 * SAME_PLACE_M, "<=", "mm"),
        ]
    return rows


def knee_distance_m(capture: Capture, name: str) -> float:
    """Median distance of a marker from the knee's."""
    positions, names = capture.markers.positions_m, capture.markers.names
    away = positions[:, names.index(name)] - positions[:, names.index(KNEE)]
    return float(np.nanmedian(np.linalg.norm(away, axis=1)))
