"""Trials that a body was scaled from, and the reasons of the others, as a subject's report states them."""

from __future__ import annotations

from mbkf.conventions import JsonTable
from mbkf.study.scaling.choice import Choice, Part

SCALED_FROM_KEY = "scaled_from"
"""Key of a subject's report for the trials that the body was scaled from: ``trial``, ``part`` and ``why`` of each."""

LEFT_OUT_KEY = "not_scaled_from"
"""Key of a subject's report for the session's other trials: the reason by name."""

STANDING = "standing"
"""Contribution of the standing trial."""


def as_report(static: str, choice: Choice) -> dict[str, object]:
    """Plain data for a subject's report.

    Args:
        static: Name of the standing trial; empty without one.
        choice: The others.
    """
    standing = [{"trial": static, "part": STANDING, "why": ""}] if static else []
    chosen = [{"trial": one.name, "part": one.part.value, "why": one.why} for one in choice.chosen]
    found: dict[str, object] = {SCALED_FROM_KEY: [*standing, *chosen]}
    if choice.left_out:
        found[LEFT_OUT_KEY] = dict(choice.left_out)
    return found


def scaled_from(report: JsonTable) -> list[str]:
    """A line about each trial that a body was scaled from and about each other one.

    Args:
        report: A subject's report.
    """
    lines = []
    for one in report.get(SCALED_FROM_KEY) or ():
        why = f": {one['why']}" if one["why"] else ""
        lines.append(f"scaled from {one['trial']} ({one['part']}{why})")
    left_out = report.get(LEFT_OUT_KEY) or {}
    return [*lines, *(f"not scaled from {name}: {why}" for name, why in left_out.items())]


def used_trials(report: JsonTable) -> list[str]:
    """Names of the trials that a body was scaled from, the standing one first; empty where not known.

    Args:
        report: A subject's report.
    """
    return [str(one["trial"]) for one in report.get(SCALED_FROM_KEY) or ()]


def bends_deeply(report: JsonTable) -> bool:
    """True for a subject that was scaled from a deep flexion, too.

    Args:
        report: Its report.
    """
    return any(one["part"] == Part.DEEP for one in report.get(SCALED_FROM_KEY) or ())
