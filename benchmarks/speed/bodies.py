"""Cost of a person's body: choosing trials and scaling from them, and errors by the body of an estimate.

The first is a ratio to scaling the standing trial alone, both in turn, the least time of each. The second is in P,
measured between the evaluations. Before skin, joint centres and segment masses were part of a body's errors an
evaluation took 3.1 P for the made adult; the bound is 1.5 times that.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.checks import Check
from benchmarks.foreign.truth import foreigners
from benchmarks.speed.products import Stopwatch
from mbkf.filters.body_errors import BodyErrors
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.study.scaling.session import SessionTrial, scale_from_session
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

SCALING, ERRORS_P = 4.0, 4.7
RUNS, ROUNDS, FRAMES = 3, 30, 20

REAL = {
    "rajagopal": ("rajagopal_walk_run", "static_walk_1.trc", "motion_capture_walk.trc", 75.0),
    "functional walk": ("functional_walk", "FunctionalStatic.c3d", "FunctionalWalk.c3d", 70.0),
    "gait2354": ("gait2354_walk", "subject01_static.trc", "subject01_walk1.trc", 72.6),
    "unipd": ("unipd_walk", "Static1.c3d", "Walking1.c3d", 70.0),
}
"""Folder, standing trial, other trial and mass of public persons."""

Session = tuple[Capture, dict[str, Capture], float]
"""Standing trial, the others by name, and mass."""


def rows(data: Path | None) -> list[Check]:
    """Costs of scaling for each session, and of errors by the body for one person scaled in both ways.

    Args:
        data: Folder of the public captures; None for a synthetic person alone.
    """
    sessions = _sessions(data)
    found = [Check(f"{name}: {ROW}", _scaling(*one), SCALING, "<=") for name, one in sessions.items()]
    static, trials, mass_kg = next(iter(sessions.values()))
    for title, used in (("standing", ()), ("standing and two trials", tuple(trials.values())[:2])):
        body = scale(static, used, mass_kg=mass_kg)
        cost = _errors(body, next(iter(trials.values())))
        found.append(Check(f"errors by the body, scaled from {title}", cost, ERRORS_P, "<=", "P"))
    return found


ROW = "scaling with the choice of trials / standing alone"


def _sessions(data: Path | None) -> dict[str, Session]:
    """Sessions by name."""
    if data is None:
        person, made = synthesise("walk", seed=1)
        _, squat = synthesise("squat", seed=1)
        return {"synthetic": (made.static, {"walk": made.trial, "squat": squat.trial}, person.mass_kg)}
    found: dict[str, Session] = {
        f"made {one.name}": (one.static(), {name: one.trial(name) for name in one.motions}, one.mass_kg)
        for one in foreigners(data / "foreign_truth")
    }
    for name, (folder, static, trial, mass_kg) in REAL.items():
        moving = read_capture(data / folder / trial)
        found[name] = (read_capture(data / folder / static), {trial: moving}, mass_kg)
    return found


def _scaling(static: Capture, trials: dict[str, Capture], mass_kg: float) -> float:
    """Processor time of scaling from a session over that from its standing trial."""
    by = partial(scale, mass_kg=mass_kg)
    standing = SessionTrial("standing", partial(_same, static))
    others = [SessionTrial(name, partial(_same, one)) for name, one in trials.items()]
    alone, session = [], []
    for _ in range(RUNS):
        alone.append(_seconds(lambda: scale_from_session(standing, (), by)))
        session.append(_seconds(lambda: scale_from_session(standing, others, by)))
    return min(session) / min(alone)


def _same(capture: Capture) -> Capture:
    return capture


def _seconds(work: Callable[[], object]) -> float:
    begin = process_time()
    work()
    return process_time() - begin


def _errors(subject: Subject, trial: Capture) -> float:
    """Cost of an evaluation in P: the median over frames."""
    settings = ReconstructSettings(checks=False, smooth=False)
    found = reconstruct(trial, subject, settings=settings)
    turned = checked_for_subject(trial, found.subject)
    markers = subject_markers(turned.markers, found.subject)
    with single_threaded():
        body = trial_inputs(markers, turned.plates, found.subject, settings)[0].body
        assert body is not None
        frames = np.linspace(0, found.frames - 1, FRAMES).astype(int)
        motions = [(found.q[t], found.v[t], found.a[t], np.nan_to_num(found.foot_wrench[t])) for t in frames]
        return _in_products(body, motions)


def _in_products(body: BodyErrors, motions: Sequence[tuple[np.ndarray, ...]]) -> float:
    watch = Stopwatch()
    for _ in range(ROUNDS):
        for q, v, a, wrenches in motions:
            watch.frame()
            watch.part("errors", body.at, q, v, a, wrenches, None)
    return watch.times().in_products("errors")
