"""The packages that mbkf hands a body to: their numbers against Pinocchio's.

CasADi: every function of :func:`mbkf.casadi_dynamics` at random states, and the example of optimal control.
"""

from __future__ import annotations

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.packages.assisted_squat import example_rows
from benchmarks.packages.casadi_agreement import agreement
from benchmarks.packages.persons import person
from mbkf.numerics.threads import single_threaded

STATES = 100
AGREEMENT = 1e-10


def run(context: Context) -> list[Check]:
    """All rows."""
    with single_threaded():
        return [*agreement_rows(10 if context.quick else STATES, context.seed), *example_rows(context.out)]


def agreement_rows(states: int, seed: int) -> list[Check]:
    """CasADi against Pinocchio, a row for each output.

    Args:
        states: Number of random states.
        seed: Of the person and the states.
    """
    worst = agreement(person(seed), states, np.random.default_rng(seed))
    name = f"CasADi against Pinocchio, {states} random states"
    return [Check(f"{name}: {part}", value, AGREEMENT, "<=", "relative") for part, value in worst.items()]
