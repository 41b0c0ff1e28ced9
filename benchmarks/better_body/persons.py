"""Persons in front of cameras, and the bodies that are scaled from their trials."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.dynamic.methods import tared
from mbkf.conventions import read_only
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.model.human import reference_body
from mbkf.model.protocol import load_protocol
from mbkf.scaling import fit
from mbkf.scaling.problem import ScalingProblem
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

NOISE = CaptureSettings(skin_sd_m=0.003)
"""3 mm of skin movement; cameras, occlusion and plates as `mbkf synth` has them."""

CARELESS = 2.5
"""Markers this many times as far from the protocol's places as `mbkf synth` puts them: 10 mm of anatomical ones, which
is what the protocol states, and what examiners reach (U. Della Croce et al., Gait Posture 21 (2005) 226-237)."""


KNOWN_SD = 1e-5
"""Spread of a length that is known."""


@dataclass(frozen=True)
class Trial:
    """A person's trial.

    Attributes:
        person: The true person.
        static, moving: The captures.
        truth: The true motion of ``moving``.
    """

    person: Subject
    static: Capture
    moving: Capture
    truth: Truth


@cache
def trial(motion: str, seed: int, careless: float = 1.0) -> Trial:
    """The trial of a motion and a seed.

    Args:
        motion: Name of the motion.
        seed: Chooses person, motion and noise.
        careless: Factor on how far markers are from the protocol's places.
    """
    person = _placed(synthesise_subject(seed), careless)
    person, made = synthesise(motion, seed=seed, settings=NOISE, subject=person)
    return Trial(person, made.static, tared(made.trial), made.truth)


def _placed(person: Subject, careless: float) -> Subject:
    model = body_of(person)
    expected = {
        marker.name: model.axis_scale(model.description.segment(marker.segment)) * marker.position_m
        for marker in load_protocol(person.protocol).markers
    }
    markers = tuple(
        replace(m, position_m=read_only(expected[m.name] + careless * (m.position_m - expected[m.name])))
        for m in person.markers
    )
    return replace(person, markers=markers)


def scaled(from_trial: Trial, *, moving: bool) -> Subject:
    """The person scaled from the static trial, and the moving one."""
    trials = [from_trial.moving] if moving else []
    return scale(from_trial.static, trials, mass_kg=from_trial.person.mass_kg)


def with_true_lengths(from_trial: Trial) -> Subject:
    """The person scaled from both trials by someone who knows every length: only markers are to be found."""
    made = fit.scaling_problem

    def knowing(*given: Any) -> ScalingProblem:
        problem = made(*given)
        factors = problem.body.scale(from_trial.person.scale_factors)
        exactly = KNOWN_SD**2 * np.eye(len(factors))
        return problem.with_prior(replace(problem.prior, factors=factors, factor_covariance=exactly))

    with patch.object(fit, "scaling_problem", knowing):
        return scaled(from_trial, moving=True)


def normalised(found: Subject, person: Subject) -> float:
    """Mean square of the factors' errors over their standard errors."""
    table = found.report["factors"]
    assert isinstance(table, dict)
    body = reference_body(person)
    true = dict(zip(body.scale_factors, body.scale(person.scale_factors), strict=True))
    away = [(found.scale_factors[name] - true[name]) / one["standard_error"] for name, one in table.items()]
    return float(np.mean(np.square(away)))
