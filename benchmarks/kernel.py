"""The compiled kernel against its reference: whole synthetic trials, every array of their results.

Smoothing enlarges rounding, and residuals are small differences of large forces: there 1e-9 of the largest value is
less than what the reference itself changes by when its input moves by the last binary digit. Each array's difference
is therefore told as a multiple of that, too (at least of 1e-9).

The same for all captures is ``python -m benchmarks.equality --kernels``, which takes an hour.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.equality.compare import BOUND, difference
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.kernel.loading import COMPILED, REFERENCE, SWITCH, library
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.synth import synthesise

MOTIONS = (
    "squat",
    "walk",
    "jump",
    "turn",
    "one_foot",
    "reach",
    "step_up",
    "general",
    "sit_to_stand",
    "kneel",
)
SEEDS, QUICK_SEEDS, QUICK_MOTIONS = 6, 1, ("squat", "jump")

SECONDS: float | None = None
"""Length of a trial; None for the motion's usual one."""

TIMES = ("step_seconds",)
"""Arrays of wall time, which differ from run to run."""


@contextmanager
def using(kernel: str) -> Iterator[None]:
    """Inside, filters are made with one of the kernels.

    Args:
        kernel: ``compiled`` or ``reference``.
    """
    before = os.environ.get(SWITCH)
    os.environ[SWITCH] = kernel
    library.cache_clear()
    try:
        yield
    finally:
        os.environ.pop(SWITCH)
        if before is not None:
            os.environ[SWITCH] = before
        library.cache_clear()


NEAR = 10.0
"""Up to how many times the reference's own rounding a difference is rounding."""


def run(context: Context) -> list[Check]:
    """Every motion and seed, causal and smoothed; the largest difference of each motion."""
    quick, worst = context.quick, dict[str, Apart]()
    trials = list(product(QUICK_MOTIONS if quick else MOTIONS, range(QUICK_SEEDS if quick else SEEDS)))
    for (motion, seed), smooth in product(trials, (False, True)):
        name = f"{motion}, {'smoothed' if smooth else 'causal'}"
        found = apart(motion, seed, ReconstructSettings(smooth=smooth, checks=False))
        worst[name] = found if name not in worst else worst[name].or_worse(found)
    share, times = "share of each array's largest value", "over the last digit's effect on the reference"
    return [
        *(Check(f"{name}: difference, {share}", one.share, BOUND, "<=") for name, one in worst.items()),
        *(
            Check(f"{name}: difference, {times}", one.over_rounding, NEAR, "<=")
            for name, one in worst.items()
        ),
        information("synthetic trials", len(trials)),
    ]


class Apart(NamedTuple):
    """The largest differences of arrays.

    Attributes:
        share: As a share of the array's largest value.
        over_rounding: Over the reference's own rounding.
        stable: The share, of arrays that the reference itself keeps within half the bound when its input moves by the
            last digit: both computations round.
    """

    share: float
    over_rounding: float
    stable: float = 0.0

    def or_worse(self, other: Apart) -> Apart:
        """The larger of both."""
        return Apart(*(max(mine, theirs) for mine, theirs in zip(self, other, strict=True)))


def apart(motion: str, seed: int, settings: ReconstructSettings) -> Apart:
    """How far the kernels are apart on one trial.

    Args:
        motion: The synthetic motion.
        seed: Of the person and the motion.
        settings: How it is reconstructed.
    """
    subject, made = synthesise(motion, seconds=SECONDS, seed=seed)
    with using(COMPILED):
        compiled = reconstruct(made.trial, subject, settings=settings)
    with using(REFERENCE):
        reference, *nudged = (
            reconstruct(made.trial, one, settings=settings)
            for one in (subject, moved(subject, np.inf), moved(subject, -np.inf))
        )
    shares = differences(reference, compiled)
    rounding = [differences(reference, one) for one in nudged]
    own = {name: max(one[name] for one in rounding) for name in shares}
    over = [share / max(BOUND, own[name]) for name, share in shares.items()]
    stable = max(share for name, share in shares.items() if own[name] < BOUND / 2.0)
    return Apart(max(shares.values()), max(over), stable)


def moved(subject: Subject, towards: float) -> Subject:
    """The subject with its markers' places and their noise moved by the last binary digit.

    Rounding of covariances does not depend on what is measured, but on how it is weighed.

    Args:
        subject: The person.
        towards: Infinity of one sign or the other.
    """
    markers = (
        replace(
            one,
            position_m=np.nextafter(one.position_m, towards),
            noise_m=float(np.nextafter(one.noise_m, towards)),
        )
        for one in subject.markers
    )
    return replace(subject, markers=tuple(markers))


def differences(one: Reconstruction, other: Reconstruction) -> dict[str, float]:
    """Of each array by its name, as a share of its largest value; infinite where NaN differ."""
    arrays = {part.name: getattr(one, part.name) for part in fields(one) if part.name not in TIMES}
    return {
        name: difference(values, getattr(other, name))[0]
        for name, values in arrays.items()
        if isinstance(values, np.ndarray)
    }
