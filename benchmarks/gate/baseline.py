"""The committed baseline: what each metric was, by how much it may get worse, and why it was last changed."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.gate.metrics import HIGHER, LOWER, NEAR_ONE, Metric
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.atomic import replacing

FILE = Path(__file__).with_name("baseline.toml")

SHARE, TIME_SHARE = 0.03, 0.4
"""By which share a metric may get worse; one of time, which computers do not share, by the second."""

LEAST: Mapping[str, float] = {
    "mm": 0.02,
    "°": 0.005,
    "N": 0.2,
    "N m": 0.02,
    "rad/s": 0.002,
    "%": 0.5,
    "": 0.02,
    "P": 0.0,
}
"""By how much in any case, in each unit: what rounding may do to a number near zero."""


@dataclass(frozen=True)
class Held:
    """A metric of the baseline.

    Attributes:
        value: What it was.
        unit: Its unit.
        better: Which way it is better.
        tolerance: By how much it may get worse, in its unit.
    """

    value: float
    unit: str
    better: str
    tolerance: float


@dataclass(frozen=True)
class Update:
    """A change of the baseline: when, and why."""

    date: str
    reason: str


@dataclass(frozen=True)
class Baseline:
    """All metrics by name, and the changes so far, the oldest first."""

    metrics: Mapping[str, Held]
    updates: tuple[Update, ...] = ()


def held(metric: Metric) -> Held:
    """A metric as the baseline holds it."""
    share = TIME_SHARE if metric.is_time else SHARE
    off = abs(metric.value)
    if metric.better == NEAR_ONE:
        off = abs(metric.value - 1.0)
    elif metric.better == HIGHER and metric.unit == "%":
        off = 100.0 - metric.value
    tolerance = max(share * off, LEAST.get(metric.unit, 0.0))
    return Held(_short(metric.value), metric.unit, metric.better, _short(tolerance))


def updated(
    before: Baseline, metrics: Sequence[Metric], reason: str, now: datetime | None = None
) -> Baseline:
    """The baseline with these metrics instead.

    Args:
        before: The one so far.
        metrics: The new ones.
        reason: Why it changes.
        now: When; now by default.

    Raises:
        InvalidInput: There is no reason, or a metric is not a number.
    """
    if not reason.strip():
        raise InvalidInput("a new baseline needs a reason: --update-baseline 'WHY IT CHANGED'")
    unknown = [metric.name for metric in metrics if not math.isfinite(metric.value)]
    if unknown:
        raise InvalidInput(f"no baseline is made of what is not a number: {', '.join(unknown)}")
    date = (now or datetime.now(UTC)).date().isoformat()
    found = {metric.name: held(metric) for metric in metrics}
    return Baseline(found, (*before.updates, Update(date, " ".join(reason.split()))))


def read_baseline(file: Path = FILE) -> Baseline:
    """Reads a baseline; an empty one where there is none.

    Raises:
        FileFormatError: It is damaged.
    """
    if not file.exists():
        return Baseline({})
    try:
        found = tomllib.loads(file.read_text(encoding="utf-8"))
        metrics = {
            one["name"]: Held(float(one["value"]), one["unit"], one["better"], float(one["tolerance"]))
            for one in found.get("metric", [])
        }
        updates = tuple(Update(one["date"], one["reason"]) for one in found.get("update", []))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise FileFormatError(file, f"is no baseline ({error})") from error
    strange = [name for name, one in metrics.items() if one.better not in (LOWER, HIGHER, NEAR_ONE)]
    if strange:
        raise FileFormatError(file, f"does not say which way these are better: {', '.join(strange)}")
    return Baseline(metrics, updates)


def write_baseline(baseline: Baseline, file: Path = FILE) -> None:
    """Writes a baseline as TOML, a table per metric.

    Raises:
        OSError: It cannot be written.
    """
    parts = ["# Made by: python -m benchmarks --update-baseline REASON\n"]
    parts += [
        f"[[update]]\ndate = {_text(one.date)}\nreason = {_text(one.reason)}\n" for one in baseline.updates
    ]
    parts += [
        f"[[metric]]\nname = {_text(name)}\nvalue = {one.value!r}\nunit = {_text(one.unit)}\n"
        f"better = {_text(one.better)}\ntolerance = {one.tolerance!r}\n"
        for name, one in baseline.metrics.items()
    ]
    with replacing(file, edits=True) as partial:
        partial.write_text("\n".join(parts), encoding="utf-8")


def _text(value: str) -> str:
    """A string of TOML, which JSON's are."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _short(value: float) -> float:
    """Six digits: more are noise in a committed file."""
    return float(f"{value:.6g}")
