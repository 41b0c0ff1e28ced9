"""The packages that mbkf hands a body to: their numbers against Pinocchio's.

CasADi: every function of :func:`mbkf.casadi_dynamics` at random states.
"""

from __future__ import annotations

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.packages.casadi_agreement import agreement
from benchmarks.packages.persons import person

STATES = 100
AGREEMENT = 1e-10


def run(context: Context) -> list[Check]:
    """All rows."""
    states = 10 if context.quick else STATES
    worst = agreement(person(context.seed), states, np.random.default_rng(context.seed))
    name = f"CasADi against Pinocchio, {states} random states"
    return [Check(f"{name}: {part}", value, AGREEMENT, "<=", "relative") for part, value in worst.items()]
