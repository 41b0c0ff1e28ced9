"""A synthetic person walking for little more than a second, made once for all tests that label or follow the points."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.synthesis.cameras import without_labels
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

SECONDS = 1.2


@dataclass(frozen=True)
class Walker:
    """The labelled and the unlabelled trial, the truth, and the subject as scaled from the standing trial."""

    trial: Capture
    raw: Capture
    truth: Truth
    subject: Subject


@cache
def walker() -> Walker:
    person, made = synthesise("walk", seconds=SECONDS)
    return Walker(made.trial, made.raw, made.truth, scale(made.static, mass_kg=person.mass_kg))


def unlabelled(trial: Capture, positions: np.ndarray, seed: int = 0, shuffle: bool = True) -> Capture:
    """The trial with points at these positions (T, N, 3) m and without names; shuffled in every frame if asked."""
    if shuffle:
        positions = without_labels(positions, np.random.default_rng(seed))
    names = tuple(f"*{k}" for k in range(positions.shape[1]))
    return replace(trial, markers=replace(trial.markers, names=names, positions_m=positions))
