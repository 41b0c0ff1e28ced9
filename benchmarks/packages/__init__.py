"""The packages that mbkf hands a body to: their numbers against Pinocchio's.

CasADi: every function of :func:`mbkf.casadi_dynamics` at random states, and the example of optimal control. MeshCat:
a person and a result in a headless browser. URDF: a person's file in Pinocchio, MuJoCo and PyBullet, and read back.
"""

from __future__ import annotations

import numpy as np

import mbkf
from benchmarks.checks import Check, Context
from benchmarks.packages.assisted_squat import example_rows
from benchmarks.packages.casadi_agreement import agreement
from benchmarks.packages.meshcat_scene import meshcat_rows
from benchmarks.packages.urdf_readers import urdf_rows
from mbkf.io.results import Reconstruction
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.person import synthesise_subject

STATES = 100
AGREEMENT = 1e-10


def run(context: Context) -> list[Check]:
    """All rows."""
    with single_threaded():
        return [
            *agreement_rows(10 if context.quick else STATES, context.seed),
            *example_rows(context.out),
            *meshcat_rows(_result(context.seed), context.out),
            *urdf_rows(synthesise_subject(context.seed), context.out, np.random.default_rng(context.seed)),
        ]


def _result(seed: int) -> Reconstruction:
    """A second of a squat, reconstructed causally."""
    subject, recorded = mbkf.synthesise("squat", seconds=1.0, seed=seed)
    return mbkf.reconstruct(recorded.trial, subject, settings=mbkf.ReconstructSettings(smooth=False))


def agreement_rows(states: int, seed: int) -> list[Check]:
    """CasADi against Pinocchio, a row for each output.

    Args:
        states: Number of random states.
        seed: Of the person and the states.
    """
    worst = agreement(synthesise_subject(seed), states, np.random.default_rng(seed))
    name = f"CasADi against Pinocchio, {states} random states"
    return [Check(f"{name}: {part}", value, AGREEMENT, "<=", "relative") for part, value in worst.items()]
