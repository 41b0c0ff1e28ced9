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
from time import perf_counter

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.dynamic_captures import SOURCES
from benchmarks.labelling_any_attitude import rows as any_attitude_rows
from benchmarks.labelling_rows import Trial, crossing_rows, hard_rows, loss_rows, plain_rows
from benchmarks.speed import PRODUCT_SIZE
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import KinematicFollower
from mbkf.filters.prediction import expected_markers
from mbkf.filters.settings import KinematicSettings
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.labelling.running import RunningLabeller
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.scale import scale
from mbkf.pipelines.synth import synthesise
from mbkf.sensors.markers import MarkerSensor

REAL = ("biomechzoo HC032A", "biomechzoo HC044A", "gaitalytics", "rajagopal walk", "rajagopal run")
CONTRADICTORY, EXCHANGED = "biomechzoo HC032A", {"LHFB": "LTUB", "LTUB": "LHFB"}
"""A walk in which two markers have each other's name, and the names exchanged."""

KNEE, SAME_PLACE_M = "LKNE", 0.012
"""A marker of the same shank or thigh, and how far their distances may differ between two trials."""

SYNTHETIC = ("walk", "squat", "jump")
QUICK = ("gaitalytics", "synthetic walk")

SEEDS, QUICK_SEEDS = 3, 1
MARKERS, POINTS = 36, 50


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


def speed_rows() -> list[Check]:
    """Time of one frame's labels in P, for 36 markers and 50 points; prediction and memory counted, filter not."""
    person, made = synthesise("walk")
    model = HumanModel.scaled(person.scale_factors, person.mass_kg, person.body)
    sensor = MarkerSensor(
        model, [m.segment for m in person.markers], np.array([m.position_m for m in person.markers])
    )
    noise = np.array([m.noise_m for m in person.markers])
    markers = made.trial.markers
    follower = KinematicFollower(
        KinematicFilter(
            sensor, noise, 1.0 / markers.rate_hz, np.zeros(model.nv, dtype=bool), KinematicSettings()
        )
    )
    recording = Recording(markers.positions_m, np.zeros((markers.frames, 0, 6)), 1.0 / markers.rate_hz)
    labeller = RunningLabeller(noise, np.full(len(noise), 0.005), recording.dt_s)
    rng = np.random.default_rng(1)
    factor = rng.normal(size=(PRODUCT_SIZE, PRODUCT_SIZE))
    rows = []
    with single_threaded():
        estimate = follower.start(recording, 0, None)
        assert estimate is not None, "the synthetic walk starts"
        for t in range(1, markers.frames):
            shown = markers.positions_m[t]
            shown = shown[~np.isnan(shown).any(axis=1)]
            extra = shown.mean(axis=0) + rng.uniform(-0.8, 0.8, (POINTS - len(shown), 3))
            points = rng.permutation(np.concatenate([shown, extra]))
            ticks = [perf_counter()]
            np.matmul(factor, factor)
            ticks.append(perf_counter())
            expected = expected_markers(follower, estimate, sensor)
            ticks.append(perf_counter())
            labels = labeller.label(expected, points)
            ticks.append(perf_counter())
            estimate = follower.step(estimate, recording, t)
            ticks.append(perf_counter())
            on_body = sensor.positions(estimate.q) if labeller.learns else points[:0]
            labeller.remember(labels, points, on_body)
            ticks.append(perf_counter())
            rows.append(np.diff(ticks))
    parts = np.array(rows)
    product = float(np.median(parts[:, 0]))
    own = parts[:, [1, 2, 4]]
    name = f"labels of {MARKERS} markers among {POINTS} points"
    return [
        Check(f"{name}, all told, median", float(np.median(own.sum(axis=1))) / product, 0.25, "<=", "P"),
        Check(f"{name}, all told, mean", float(own.sum(axis=1).mean()) / product, math.inf, "<=", "P"),
        *(
            Check(f"{name}: {part}, median", float(np.median(seconds)) / product, math.inf, "<=", "P")
            for part, seconds in zip(("prediction", "assignment", "memory"), own.T, strict=True)
        ),
    ]
