"""Other contacts than the feet's, against exact truth: a chair, a rail, a knee and a hand on the floor.

Plates lie under the feet only. What the parts bear is found and estimated from the motion; persons 0 to 2 were looked
at while the search was made, 3 and 4 only afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.checks import Check, Context, information, within
from benchmarks.contact.shared import PASSES, rms
from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.synthesis.capture import SyntheticCapture
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.synth import synthesise

PERSONS = (0, 2, 3, 4)
FORCE_PERCENT = {"sit_to_stand": 6.0, "kneel": 10.0, "rail": 10.0}
TORQUE_NM_KG, FOUND_S = 0.15, 0.1
SPREAD, COVER = (0.7, 1.3), (90.0, 98.0)
SEATED_PERCENT, SEATED_FROM = 95.0, 0.01
"""A seat is found for so much of the time in which it bears more than this share of body weight."""

OTHER_MASSES = (0.96, 1.04)
"""Stated over true mass of persons who are weighed with their shoes, or remember what they weighed."""

BEARS_SHARE = 0.05
"""Share of body weight from which a part bears, for its beginning and end to be judged by."""


class Trial(NamedTuple):
    """A reconstructed trial with its truth."""

    subject: Subject
    truth: Truth
    found: Reconstruction


def other_rows(context: Context) -> list[Check]:
    """Every motion and pass, and how far the stated spreads hold over all of them."""
    persons = PERSONS[:1] if context.quick else PERSONS
    rows: list[Check] = []
    over_sd: dict[str, list[Array]] = {name: [] for name in PASSES}
    for motion in FORCE_PERCENT:
        made = [synthesise(motion, seed=person) for person in persons]
        for name, smooth in PASSES.items():
            settings = ReconstructSettings(smooth=smooth)
            trials = [Trial(s, c.truth, reconstruct(c.trial, s, settings=settings)) for s, c in made]
            if smooth:  # a causal filter opens contacts on its way: `python -m benchmarks loads`
                rows += _motion_rows(motion, name, trials)
            if smooth and motion == "sit_to_stand":
                rows += _other_mass_rows(f"{motion}, {name}", made, settings)
            over_sd[name] += [_over_sd(trial) for trial in trials]
    for name, several in over_sd.items():
        errors = np.concatenate(several)
        rows += within(f"other contacts, {name}: error over stated sd", rms(errors), *SPREAD)
        cover = 100.0 * float((np.abs(errors) <= 1.96).mean())
        rows += within(f"other contacts, {name}: errors within their 95 % intervals", cover, *COVER, "%")
    return rows


def _motion_rows(motion: str, name: str, trials: list[Trial]) -> Iterator[Check]:
    title = f"{motion}, {name}"
    named = [set(t.truth.support_names) <= {one.part for one in t.found.contacts} for t in trials]
    yield Check(f"{title}: trials whose supports are named", 100.0 * float(np.mean(named)), 100.0, ">=", "%")
    force = max(max(support_percent(t).values()) for t in trials)
    yield Check(f"{title}: force on a part, worst", force, FORCE_PERCENT[motion], "<=", "% BW")
    feet = max(_feet_percent(t) for t in trials)
    yield Check(f"{title}: force on a foot, worst", feet, FORCE_PERCENT[motion], "<=", "% BW")
    late = max(abs(s) for t in trials for s in lateness_s(t))
    torque = max(leg_torque(t) for t in trials)
    if motion == "sit_to_stand":
        yield Check(f"{title}: hip and knee torque, worst", torque, TORQUE_NM_KG, "<=", "N m/kg")
        yield Check(f"{title}: seat found and lost, worst", late, FOUND_S, "<=", "s")
        seated, beyond = zip(*(seated_percent(t) for t in trials), strict=True)
        yield Check(f"{title}: time on the seat that is found, least", min(seated), SEATED_PERCENT, ">=", "%")
        yield Check(
            f"{title}: seat found beyond that time, most", max(beyond), 100.0 - SEATED_PERCENT, "<=", "%"
        )
    else:
        yield information(f"{title}: hip and knee torque, worst", torque, "N m/kg")
        yield information(f"{title}: parts found and lost, worst", late, "s")


def _other_mass_rows(
    title: str, made: Sequence[tuple[Subject, SyntheticCapture]], settings: ReconstructSettings
) -> Iterator[Check]:
    """The seat where the mass is wrong by 4 %."""
    for factor in OTHER_MASSES:
        persons = [(replace(s, mass_kg=factor * s.mass_kg), c) for s, c in made]
        trials = [Trial(s, c.truth, reconstruct(c.trial, s, settings=settings)) for s, c in persons]
        seated, beyond = zip(*(seated_percent(t) for t in trials), strict=True)
        words = f"{title}, mass {100.0 * (factor - 1.0):+.0f} %"
        yield Check(f"{words}: time on the seat that is found, least", min(seated), SEATED_PERCENT, ">=", "%")
        yield Check(
            f"{words}: seat found beyond that time, most", max(beyond), 100.0 - SEATED_PERCENT, "<=", "%"
        )


def _errors(trial: Trial) -> dict[str, tuple[Array, Array, Array]]:
    """True vertical force, error and stated deviation (T,) of every part that bears in truth."""
    found, truth = trial.found, trial.truth
    known = {}
    for k, part in enumerate(truth.support_names):
        true = truth.support_wrench[:, k, 2]
        own = found.support_names.index(part) if part in found.support_names else None
        estimate = np.zeros_like(true) if own is None else np.nan_to_num(found.support_wrench[:, own, 2])
        sd = np.zeros_like(true) if own is None else np.nan_to_num(found.support_wrench_sd[:, own, 2])
        known[part] = true, estimate - true, sd
    return known


def support_percent(trial: Trial) -> dict[str, float]:
    """RMS of the vertical force on every part while it bears, % of body weight."""
    weight_n = trial.subject.mass_kg * GRAVITY_M_S2
    return {part: 100.0 * rms(off[true > 0.0]) / weight_n for part, (true, off, _) in _errors(trial).items()}


def seated_percent(trial: Trial) -> tuple[float, float]:
    """Share of the time on a part in which it is found, and of the time in which it is found beyond, %; the worst part.

    A part bears from :data:`SEATED_FROM` of body weight on; the time beyond begins where it bears nothing.
    """
    weight_n = trial.subject.mass_kg * GRAVITY_M_S2
    within, beyond = [], []
    for true, off, _ in _errors(trial).values():
        bears, seen = true > SEATED_FROM * weight_n, true + off != 0.0
        within.append(100.0 * float(seen[bears].mean()))
        beyond.append(100.0 * float((seen & (true <= 0.0)).sum() / bears.sum()))
    return min(within), max(beyond)


def _feet_percent(trial: Trial) -> float:
    """RMS of the vertical force on the worse foot, % of body weight."""
    off = (trial.found.foot_wrench - trial.truth.foot_wrench)[:, :, 2]
    return 100.0 * max(rms(off[:, foot]) for foot in (0, 1)) / (trial.subject.mass_kg * GRAVITY_M_S2)


def _over_sd(trial: Trial) -> Array:
    """Vertical error over stated deviation of every part wherever it is said to bear, and bears in truth."""
    both = [
        off[(sd > 0.0) & (true > 0.0)] / sd[(sd > 0.0) & (true > 0.0)]
        for true, off, sd in _errors(trial).values()
    ]
    return np.concatenate(both)


def lateness_s(trial: Trial) -> list[float]:
    """How late, s, each part is found to begin and end, against where it bears the share of weight that counts.

    A part found before it bears that much, but after it has begun to bear, is not early.
    """
    weight_n, times = trial.subject.mass_kg * GRAVITY_M_S2, trial.truth.times_s
    late = []
    for true, off, _ in _errors(trial).values():
        touches, bears, seen = true > 0.0, true > BEARS_SHARE * weight_n, true + off != 0.0
        for outer, inner in zip(_edges(touches), _edges(bears), strict=True):
            edges = _edges(seen)
            if not edges:
                late.append(float("inf"))
                continue
            at = min(edges, key=lambda edge: abs(edge - inner))
            nearest = min(max(at, min(outer, inner)), max(outer, inner))
            late.append(float((at - nearest) * (times[1] - times[0])))
    return late


def _edges(mask: BoolArray) -> list[int]:
    """Frames at which a mask (T,) changes."""
    return (np.flatnonzero(np.diff(mask.astype(int))) + 1).tolist()


def leg_torque(trial: Trial) -> float:
    """RMS of the sagittal hip and knee torques over body mass, N m/kg, the worst of four."""
    names = trial.found.dof_names
    legs = [f"{side}_{segment}_y" for side in ("right", "left") for segment in ("thigh", "shank")]
    off = (trial.found.tau - trial.truth.tau)[:, [names.index(name) for name in legs]]
    return float(np.nanmax(np.sqrt(np.nanmean(off**2, axis=0)))) / trial.subject.mass_kg
