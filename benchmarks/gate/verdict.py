"""Metrics against the baseline, one by one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from benchmarks.gate.baseline import Baseline, Held
from benchmarks.gate.metrics import HIGHER, NEAR_ONE, Metric


class Kind(StrEnum):
    """What a comparison finds."""

    PASS = "pass"
    BETTER = "better"
    WORSE = "WORSE"
    NEW = "NEW"
    GONE = "GONE"


@dataclass(frozen=True)
class Verdict:
    """A metric against its baseline.

    Attributes:
        name: The metric.
        kind: What was found.
        value: Now; NaN for one that is gone.
        held: The baseline's; None for a new one.
        worse_by: By how much it got worse, in its unit; negative where it got better.
    """

    name: str
    kind: Kind
    value: float
    held: Held | None
    worse_by: float = math.nan

    @property
    def passed(self) -> bool:
        """Whether the gate opens for it."""
        return self.kind in (Kind.PASS, Kind.BETTER)


def verdicts(metrics: Sequence[Metric], baseline: Baseline) -> list[Verdict]:
    """Every metric, then those of the baseline that are gone."""
    found = [verdict(metric, baseline.metrics.get(metric.name)) for metric in metrics]
    measured = {metric.name for metric in metrics}
    gone = [
        Verdict(name, Kind.GONE, math.nan, one)
        for name, one in baseline.metrics.items()
        if name not in measured
    ]
    return found + gone


def verdict(metric: Metric, held: Held | None) -> Verdict:
    """One metric against what it was; what is not a number is worse."""
    if held is None:
        return Verdict(metric.name, Kind.NEW, metric.value, None)
    worse_by = _badness(metric.value, held.better) - _badness(held.value, held.better)
    kind = Kind.PASS
    if not worse_by <= held.tolerance:
        kind = Kind.WORSE
    elif worse_by < -held.tolerance:
        kind = Kind.BETTER
    return Verdict(metric.name, kind, metric.value, held, worse_by)


def _badness(value: float, better: str) -> float:
    """A number that grows as the metric gets worse, in its unit."""
    if better == NEAR_ONE:
        return abs(value - 1.0)
    return -value if better == HIGHER else value
