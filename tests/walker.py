"""A synthetic person walking for little more than a second, made once for all tests that label or follow the points."""

from dataclasses import dataclass
from functools import cache

from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.pipelines.scale import scale
from mbkf.pipelines.synth import synthesise

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
