"""Synthetic persons made from our own body, judged as foreign ones are: the truth that agrees with the filter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.dynamic.methods import tared
from benchmarks.foreign.errors import GROUPS, Judged, Series
from mbkf.io.results import Reconstruction
from mbkf.io.truth import Truth
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
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
        person = synthesise_subject(one.seed)
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
            )
            for name, made in trials.items()
        ]


def against(person: str, motion: str, found: Reconstruction, truth: Truth) -> Judged:
    """Errors of angles of a reconstruction.

    Args:
        person: Name of the person.
        motion: Name of the motion.
        found: The reconstruction.
        truth: The truth in the same frames.
    """
    clinical = ClinicalAngles(HumanModel.of(found.subject))
    exact = np.where(found.tracked[:, None], clinical.angles(truth.q), np.nan)
    series = []
    for group, names in GROUPS.items():
        for name in names:
            away = found.angle(name) - exact[:, clinical.names.index(name)]
            error = np.degrees(np.arctan2(np.sin(away), np.cos(away)))
            sds = (np.degrees(found.angle_sd(name, part)) for part in ("total", "varying"))
            series.append(Series(person, motion, group, name, error, *sds))
    return Judged(person, motion, tuple(series), (), {})
