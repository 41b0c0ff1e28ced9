"""Rows of words: their share on right trials, and wrong results under "use" among faulty ones."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from benchmarks.checks import Check, information
from benchmarks.verdict.trials import Judged

MOST_LEFT, MOST_LOOK, MOST_WRONG = 1.0, 15.0, 2.0
"""Right trials under "do not use" and under "look", and wrong results under "use", per cent."""


def right_rows(kind: str, found: Sequence[Judged]) -> Iterator[Check]:
    """Rows of right trials.

    Args:
        kind: Whether bounds were chosen or shown on them.
        found: The trials.
    """
    words = Counter(one.word for one in found)
    for one in found:
        if one.word != "use":
            yield information(f"right, {kind}: {one.label}: {one.line}", float("nan"))
    name = f"right trials ({kind}, {len(found)})"
    yield Check(f"{name} under do not use", 100.0 * words["do not use"] / len(found), MOST_LEFT, "<=", "%")
    yield Check(f"{name} under look", 100.0 * words["look"] / len(found), MOST_LOOK, "<=", "%")


def faulty_rows(kind: str, found: Sequence[Judged]) -> Iterator[Check]:
    """Rows of trials with a fault.

    Args:
        kind: Whether bounds were chosen or shown on them.
        found: The trials.
    """
    for one in found:
        if one.word == "use":
            errors = f"{one.angle_deg:.1f}°, {one.torque_nm_per_kg:.2f} N m/kg"
            yield information(f"faulty, {kind}: {one.label}: use ({errors})", float("nan"))
    words = Counter(one.word for one in found)
    for word in ("use", "look", "do not use", "refused"):
        yield information(f"faulty trials ({kind}, {len(found)}) under {word}", words[word])
    wrong = sum(one.wrong_in_use for one in found)
    share = 100.0 * wrong / len(found)
    yield Check(
        f"wrong results under use of {len(found)} faulty trials ({kind})", share, MOST_WRONG, "<=", "%"
    )
