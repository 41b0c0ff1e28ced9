"""Synthetic persons whose segments are 10 % off the table, and what the estimate saves of the torque errors.

Off the table: every segment has 10 % more or less mass, and its centre of mass lies 10 % nearer to its joint or further
from it, at random; right and left are alike and the whole mass stays. Motions obey Newton's law with those segments.
Lengths and markers are the person's own; markers are corrected on each trial, as `mbkf reconstruct` does. Segments are
estimated from one walk and one squat, and judged on other trials.

Torques: inverse dynamics of the true motion under the true reactions, so that the body's inertia is all that is wrong.
Of reconstructed torques inertia is a small part; those rows say how much the true segments themselves would save.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.methods import Method, corrected, pooled, tared
from benchmarks.dynamic.synthetic import differences
from benchmarks.full_body.persons import subject_of
from benchmarks.references import rms
from mbkf.conventions import Array, read_only
from mbkf.errors import NotConverged
from mbkf.io.inertia import SegmentInertia
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of
from mbkf.trial.inertia.estimate import InertiaEstimate, estimate_inertia
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.synth import synthesise

PERSONS = (1, 2, 5, 7)
"""Places in :data:`benchmarks.full_body.persons.PERSONS`; what is estimated and its prior were set on 0, 3 and 6."""

SKIN_M = (0.003, 0.0)
OFF = 0.1
SHOWN, JUDGED = (
    (("walk", 3.0), ("squat", 4.0)),
    (("walk", 3.0), ("squat", 4.0), ("jump", 3.0), ("general", 10.0)),
)
"""Motions and durations in s that segments are estimated from, and judged on."""

BOUND = 0.7
ATTEMPTS, NEXT_SEED = 5, 1000
SMOOTHED = Method("dynamic", smooth=True)


@dataclass(frozen=True)
class Errors:
    """Torque RMS of a trial over joints, N m: by inertia alone, by the table and by the estimate."""

    table_nm: float
    estimate_nm: float

    @property
    def ratio(self) -> float:
        """With over without the estimate."""
        return self.estimate_nm / self.table_nm


def off_the_table(subject: Subject, seed: int) -> Subject:
    """The person with segments off the table, masses and centres by ± :data:`OFF`.

    Args:
        subject: The person by the table.
        seed: Chooses the signs.
    """
    rng, model, signs = np.random.default_rng([seed, 77]), body_of(subject), {}
    inertia = {}
    for segment in model.description.segments:
        both = segment.name.removeprefix("right_").removeprefix("left_")
        if both not in signs:
            signs[both] = rng.choice([-1.0, 1.0], size=2)
        heavier, further = OFF * signs[both]
        centre = np.array(model.pin_model.inertias[model.joint(segment.name).joint_id].lever)
        inertia[segment.name] = SegmentInertia(1.0 + heavier, read_only(further * centre))
    return replace(subject, inertia=inertia)


def performed(
    person: Subject, motion: tuple[str, float], seed: int, settings: CaptureSettings
) -> tuple[Capture, Truth]:
    """A trial of a person.

    Args:
        person: The true person.
        motion: Name and duration in s.
        seed: Chooses the motion and the noise; one that the person cannot perform gives way to another.
        settings: Errors of the instruments.

    Raises:
        NotConverged: The person can perform none.
    """
    name, seconds = motion
    for own in range(seed, seed + ATTEMPTS * NEXT_SEED, NEXT_SEED):
        try:
            with single_threaded():
                _, made = synthesise(name, seconds=seconds, seed=own, subject=person, settings=settings)
        except NotConverged:
            continue
        return tared(made.trial), made.truth
    raise NotConverged(f"{name}: a person of {person.mass_kg:g} kg cannot perform it")


def estimated(person: Subject, table: Subject, settings: CaptureSettings) -> InertiaEstimate:
    """Segments from the trials that are shown.

    Args:
        person: The true person.
        table: The same by the table.
        settings: Errors of the instruments.
    """
    return estimate_inertia(table, [performed(person, motion, 1, settings)[0] for motion in SHOWN])


def by_inertia(truth: Truth, person: Subject, other: Subject) -> Array:
    """(T, joint dofs) torques that another body asks for less the true ones, in the true motion, N m.

    Args:
        truth: The motion.
        person: The true person.
        other: The same with other segments.
    """
    bodies = body_of(other), body_of(person)
    asked = [
        [body.inverse_dynamics(*now) for now in zip(truth.q, truth.v, truth.a, strict=True)]
        for body in bodies
    ]
    return (np.array(asked[0]) - np.array(asked[1]))[:, ROOT_DOFS:]


def synthetic_rows(quick: bool) -> list[Check]:
    """Rows of persons off the table at each skin noise, of persons of the table, and of reconstructed torques."""
    persons = PERSONS[:1] if quick else PERSONS
    rows: list[Check] = []
    for skin_m in SKIN_M[: 1 if quick else None]:
        rows += _off_rows(persons, CaptureSettings(skin_sd_m=skin_m), f"{1e3 * skin_m:.0f} mm skin")
    kept = [estimated(subject_of(k), subject_of(k), CaptureSettings()) for k in persons]
    rows.append(Check("persons of the table: estimates written", sum(e.supported for e in kept), 0, "<="))
    most = max(one.log_ratio for one in kept)
    return [*rows, information("persons of the table: ln evidence ratio, greatest", most, "nats")]


def _off_rows(persons: Sequence[int], settings: CaptureSettings, name: str) -> list[Check]:
    errors: dict[str, list[Errors]] = defaultdict(list)
    found, scores, rebuilt = [], [], []
    for k in persons:
        table = subject_of(k)
        person = off_the_table(table, k)
        one = estimated(person, table, settings)
        found.append(one)
        scores.append(_squared_scores(one.subject, person))
        for motion in JUDGED:
            capture, truth = performed(person, motion, 2, settings)
            pair = [rms(by_inertia(truth, person, body)) for body in (table, one.subject)]
            errors[motion[0]].append(Errors(*pair))
            if motion[0] == "walk" and k == persons[0]:
                rebuilt = [_rebuilt(capture, truth, body) for body in (table, one.subject, person)]
    rows = []
    for moved, trials in errors.items():
        table_nm, ours_nm = pooled(e.table_nm for e in trials), pooled(e.estimate_nm for e in trials)
        rows += [
            information(f"{name}, {moved}: torque RMS by inertia, table", table_nm, "N m"),
            Check(
                f"{name}, {moved}: torque RMS by inertia, estimate / table", ours_nm / table_nm, BOUND, "<="
            ),
            information(f"{name}, {moved}: … worst person", max(e.ratio for e in trials)),
        ]
    return [
        *rows,
        Check(
            f"{name}: estimates written",
            100.0 * sum(e.supported for e in found) / len(found),
            100.0,
            ">=",
            "%",
        ),
        information(f"{name}: ln evidence ratio, least", min(e.log_ratio for e in found), "nats"),
        information(f"{name}: squared error over stated variance, mean", float(np.mean(scores))),
        information(f"{name}, walk, smoothed dynamic: torque RMS by the table", rebuilt[0], "N m"),
        information(f"{name}, walk, smoothed dynamic: estimate / table", rebuilt[1] / rebuilt[0]),
        information(f"{name}, walk, smoothed dynamic: true segments / table", rebuilt[2] / rebuilt[0]),
    ]


def _rebuilt(capture: Capture, truth: Truth, subject: Subject) -> float:
    """Torque RMS of a reconstruction, N m."""
    return rms(differences(SMOOTHED.run(capture, corrected(subject, capture)), truth)[2])


def _squared_scores(found: Subject, person: Subject) -> Array:
    """Squared errors of masses and centres over their stated variances."""
    bodies, scores = (body_of(found), body_of(person)), []
    for name, own in found.inertia.items():
        ours, true = (body.pin_model.inertias[body.joint(name).joint_id] for body in bodies)
        scores.append((own.mass_factor * (1.0 - true.mass / ours.mass) / own.mass_factor_sd) ** 2)
        scores += list(((ours.lever - true.lever) / own.centre_shift_sd_m) ** 2)
    return np.array(scores)
