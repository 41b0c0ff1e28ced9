"""Processor time of a trial through `mbkf batch`: copies of one walk on two workers, in products.

Start of the processes, scaling of the persons, tables and reports of progress are counted; so are the walk's eleven
plates at 1 kHz.
"""

from __future__ import annotations

from pathlib import Path

from benchmarks.batch.study import fresh, study
from benchmarks.checks import Check, information
from benchmarks.speed.consumed import consumed
from benchmarks.speed.offline import product_s

PERSONS, TRIALS, SECONDS = 2, 8, 5.0
REFERENCE_P, SHARE = 17_600.0, 0.45
"""A trial's time in products at commit b0b67396 on a quiet machine, the mean of two runs 4 % apart, and the share of it
that is the bound."""


def rows(folder: Path, persons: int = PERSONS, trials: int = TRIALS) -> list[Check]:
    """Time of a trial.

    Args:
        folder: For captures and results.
        persons: How many.
        trials: Walks of each.
    """
    source, count = study(folder / "study", persons, trials, SECONDS), persons * trials
    before = product_s()
    used = consumed("batch", source, "--out", fresh(folder / "results"), "--workers", "2")
    product = min(before, product_s())
    name = f"batch of {count} walks of {SECONDS:g} s on two workers"
    return [
        Check(
            f"{name}, processor time of a trial",
            used.seconds / count / product,
            SHARE * REFERENCE_P,
            "<=",
            "P",
        ),
        information("… in seconds", used.seconds / count, "s"),
    ]
