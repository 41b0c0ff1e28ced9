"""Persons made from our own body, draws from the spreads that the filter states, judged as foreign ones are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.dynamic.methods import tared
from benchmarks.foreign.errors import GROUPS, Judged, Series
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.anatomy import true_angles
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

SKIN = CaptureSettings(skin_sd_m=0.003)
SCALED_FROM, MOTIONS = ("walk", "squat"), ("walk", "squat", "jump")


@dataclass(frozen=True)
class OwnBody:
    """A synthetic person by the seed."""

    seed: int


def judged_own(one: OwnBody) -> list[Judged]:
    """Errors of the motions of one synthetic person, scaled from standing, a walk and a squat.

    Args:
        one: The person.
    """
    with single_threaded():
        person = synthesise_subject(one.seed, varied=True)
        trials = {name: synthesise(name, seed=one.seed, settings=SKIN, subject=person)[1] for name in MOTIONS}
        moving = [tared(trials[name].trial) for name in SCALED_FROM]
        subject = scale(trials["walk"].static, moving, mass_kg=person.mass_kg, protocol=person.protocol)
        settings = ReconstructSettings(checks=False)
        return [
            against(
                f"seed {one.seed}",
                name,
                reconstruct(tared(made.trial), subject, settings=settings),
                made.truth,
                person,
            )
            for name, made in trials.items()
        ]


def against(name: str, motion: str, found: Reconstruction, truth: Truth, person: Subject) -> Judged:
    """Errors of angles of a reconstruction.

    Args:
        name: Name of the person.
        motion: Name of the motion.
        found: The reconstruction.
        truth: The truth in the same frames.
        person: The true person.
    """
    exact = np.where(found.tracked[:, None], true_angles(person, truth.q), np.nan)
    series = []
    for group, angles in GROUPS.items():
        for angle in angles:
            away = found.angle(angle) - exact[:, found.coordinate_names.index(angle)]
            error = np.degrees(np.arctan2(np.sin(away), np.cos(away)))
            sds = (np.degrees(found.angle_sd(angle, part)) for part in ("total", "varying"))
            series.append(Series(name, motion, group, angle, error, *sds))
    return Judged(name, motion, tuple(series), (), {})
