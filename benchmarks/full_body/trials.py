"""The trials of the study: a person, a movement, what cameras and plates recorded of it, and the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.dynamic.methods import corrected, tared
from benchmarks.full_body.persons import subject_of
from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotConverged
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of
from mbkf.trial.synth import synthesise

WALK, GENERAL, SQUAT, LOST, JUMP = "walk", "general movement", "squat", "squat, knee lost", "jump"
MOVEMENTS = (WALK, GENERAL, SQUAT, LOST, JUMP)
"""The five movements of the study."""

BESIDE, HEAVY = "general, a step beside the plates", "general, mass 5 % too large"
VARIANTS = (BESIDE, HEAVY)
"""The general movement of each person's first seed once more, with a plate taken away, and with a wrong mass."""

MASS_FACTOR = 1.05

SYNTHESISED = {WALK: ("walk", 3.0), GENERAL: ("general", 10.0), SQUAT: ("squat", 4.0), JUMP: ("jump", 3.0)}
"""Registered motion and duration in s; the squat with lost markers is the same trial once more."""

KNEE_MARKERS = ("RTHI", "RKNE", "RTUB")
"""Lost in the squat. Without these three the thigh and the shank can turn about the line from hip to ankle unseen."""

LOST_FRAMES = 100
LOAD_N = 50.0
"""Load from which a plate counts as stood on."""

ATTEMPTS, NEXT_SEED = 5, 1000
"""A person who cannot perform the motion of a seed is given that of another one."""


@dataclass(frozen=True)
class Trial:
    """One trial.

    Attributes:
        movement: One of :data:`MOVEMENTS` or :data:`VARIANTS`.
        person: Place in :data:`benchmarks.full_body.persons.PERSONS`.
        seed: Chooses motion and noise.
        subject: The true person, marker positions corrected on this trial as `mbkf reconstruct` does.
        capture: What was recorded.
        truth: The true motion.
        stretch: (T,) frames of a squat in which its twin loses the knee markers; none in other movements.
    """

    movement: str
    person: int
    seed: int
    subject: Subject
    capture: Capture
    truth: Truth
    stretch: BoolArray


def make_trials(movement: str, person: int, seed: int) -> list[Trial]:
    """The trial of a movement, and those that are made from it: lost knee markers, a lost plate, a wrong mass.

    Args:
        movement: A key of :data:`SYNTHESISED`.
        person: Place in :data:`benchmarks.full_body.persons.PERSONS`.
        seed: Chooses motion and noise.
    """
    given = subject_of(person)
    with single_threaded():
        capture, truth = _performed(movement, given, seed)
    nowhere = np.zeros(len(truth.times_s), dtype=bool)
    trial = Trial(movement, person, seed, corrected(given, capture), capture, truth, nowhere)
    if movement == SQUAT:
        trial = replace(trial, stretch=deepest_stretch(given, truth))
        shown = without_markers(capture, trial.stretch)
        return [trial, replace(trial, movement=LOST, capture=shown, subject=corrected(given, shown))]
    if movement == GENERAL and not seed:
        beside = replace(capture, plates=without_a_step(capture.plates))
        heavy = replace(trial.subject, mass_kg=MASS_FACTOR * given.mass_kg)
        return [
            trial,
            replace(trial, movement=BESIDE, capture=beside),
            replace(trial, movement=HEAVY, subject=heavy),
        ]
    return [trial]


def _performed(movement: str, given: Subject, seed: int) -> tuple[Capture, Truth]:
    motion, seconds = SYNTHESISED[movement]
    for own in range(seed, seed + ATTEMPTS * NEXT_SEED, NEXT_SEED):
        try:
            _, made = synthesise(motion, seconds=seconds, seed=own, subject=given, settings=CaptureSettings())
        except NotConverged:
            continue
        return tared(made.trial), made.truth
    raise NotConverged(
        f"{movement}: a person of {given.mass_kg:g} kg cannot perform it with {ATTEMPTS} seeds"
    )


def knee_bend(subject: Subject, q: Array) -> Array:
    """(T,) angle of the right knee's rotation, rad.

    Args:
        subject: The person.
        q: (T, nq) configurations.
    """
    part = body_of(subject).joint("right_shank").q
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(q[:, part][:, :3], axis=1), np.abs(q[:, part][:, 3])))


def deepest_stretch(subject: Subject, truth: Truth) -> BoolArray:
    """(T,) the :data:`LOST_FRAMES` about the deepest bend of the knee, inside the trial."""
    frames = len(truth.times_s)
    first = int(np.argmax(knee_bend(subject, truth.q))) - LOST_FRAMES // 2
    first = min(max(first, 0), max(frames - LOST_FRAMES, 0))
    found = np.zeros(frames, dtype=bool)
    found[first : first + LOST_FRAMES] = True
    return found


def without_markers(capture: Capture, gap: BoolArray) -> Capture:
    """The capture without :data:`KNEE_MARKERS` in the frames (T,) of a gap."""
    markers = capture.markers
    positions = markers.positions_m.copy()
    own = np.isin(markers.names, KNEE_MARKERS)
    positions[gap[:, None] & own] = np.nan
    return replace(capture, markers=replace(markers, positions_m=positions))


def without_a_step(plates: tuple[PlateReadings, ...]) -> tuple[PlateReadings, ...]:
    """The plates without the one that carries most of those stepped on in the course of the trial.

    Args:
        plates: The plates, without offset.
    """
    vertical = [plate.force_n[:, 2] for plate in plates]
    stepped = [force[0] < LOAD_N for force in vertical]
    impulse = [float(force.sum()) if later else 0.0 for force, later in zip(vertical, stepped, strict=True)]
    taken = int(np.argmax(impulse))
    return tuple(plate for k, plate in enumerate(plates) if k != taken)
