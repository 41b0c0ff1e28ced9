"""Joint angles against truth: the body scaled from standing, from standing and the trial, and the true one."""

from __future__ import annotations

from collections.abc import Sequence
from time import process_time

import numpy as np

from benchmarks.better_body.persons import Trial, normalised, scaled, trial, with_true_lengths
from benchmarks.checks import Check, information
from benchmarks.references import rms
from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.synthesis.person import body_of
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

MOST_OF_TRUE = 1.3
START_S = 0.2
"""At first the filter finds the body."""

SETTINGS = ReconstructSettings(checks=False, other_contacts=False)
"""The causal filter as by default; what is left out has no part in angles."""


def angle_rows(motion: str, seeds: Sequence[int], careless: float = 1.0) -> list[Check]:
    """The rows of one motion.

    Args:
        motion: Name of the motion.
        seeds: Persons and trials.
        careless: Factor on how far markers are from the protocol's places; of careless hands, the true body is no
            bound but shows what these cost.
    """
    trials = [trial(motion, seed, careless) for seed in seeds]
    most = MOST_OF_TRUE if careless == 1.0 else np.inf
    start = process_time()
    static = [scaled(one, moving=False) for one in trials]
    middle = process_time()
    both = [scaled(one, moving=True) for one in trials]
    seconds = (process_time() - middle) / max(middle - start, 1e-9)
    true = _pooled(trials, [one.person for one in trials])
    alone, together = _pooled(trials, static), _pooled(trials, both)
    lengths = _pooled(trials, [with_true_lengths(one) for one in trials])
    name = f"{motion}, {len(seeds)} persons" + (", markers 10 mm off" if careless > 1.0 else "")
    squares = [
        float(np.mean([normalised(found, one.person) for found, one in zip(bodies, trials, strict=True)]))
        for bodies in (static, both)
    ]
    return [
        information(f"{name}: joint angles, true body, RMS", true[0], "°"),
        information(f"{name}: static alone", alone[0], "°"),
        information(f"{name}: static and trial", together[0], "°"),
        information(f"{name}: static alone, constant part", alone[1], "°"),
        information(f"{name}: static and trial, constant part", together[1], "°"),
        Check(f"{name}: static and trial / static alone", together[0] / alone[0], 1.0, "<="),
        Check(f"{name}: static and trial / true body", together[0] / true[0], most, "<="),
        information(f"{name}: the same with the true lengths", lengths[0] / true[0]),
        information(f"{name}: squared normalised error of factors, static", squares[0]),
        information(f"{name}: the same, static and trial", squares[1]),
        information(f"{name}: time of scaling, static and trial / static", seconds),
    ]


def _pooled(trials: Sequence[Trial], bodies: Sequence[Subject]) -> tuple[float, float]:
    """RMS error of all joint angles, and of each trial's mean errors, degrees."""
    errors = [joint_angle_errors(one, body) for one, body in zip(trials, bodies, strict=True)]
    means = np.array([np.nanmean(error, axis=0) for error in errors])
    return rms(np.concatenate(errors)), rms(means)


def joint_angle_errors(one: Trial, body: Subject) -> Array:
    """(T, angles) errors of the joint angles in degrees once the filter has found the body."""
    found = reconstruct(one.moving, body, settings=SETTINGS)
    reading = ClinicalAngles(body_of(one.person))
    joints = reading.rotational.copy()
    joints[reading.root_angles] = False
    assert found.angles_lab is not None
    away = np.rad2deg((found.angles_lab - reading.angles(one.truth.q))[:, joints])
    return (away[round(START_S * found.rate_hz) :] + 180.0) % 360.0 - 180.0
