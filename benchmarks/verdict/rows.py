"""Rows of words: their share on right trials, and wrong results under "use" among faulty ones."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from benchmarks.checks import Check, information
from benchmarks.verdict.spoilt import Found, by_kind
from benchmarks.verdict.trials import Judged

MOST_LEFT, MOST_LOOK, MOST_WRONG = 1.0, 15.0, 2.0
"""Right trials under "do not use" and under "look", and wrong results under "use", per cent."""

WORDS = ("use", "look", "do not use", "refused")


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
    left = words["do not use"] + words["refused"]
    yield Check(f"{name} under do not use", 100.0 * left / len(found), MOST_LEFT, "<=", "%")
    yield Check(f"{name} under look", 100.0 * words["look"] / len(found), MOST_LOOK, "<=", "%")


def faulty_rows(kind: str, found: Sequence[Found]) -> Iterator[Check]:
    """Rows of trials with a fault.

    Args:
        kind: Whether bounds were chosen or shown on them.
        found: The trials.
    """
    for one in (each.judged for each in found):
        if one.wrong_in_use:
            errors = f"{one.angle_deg:.1f}°, {one.torque_nm_per_kg:.2f} N m/kg"
            yield information(f"faulty, {kind}: {one.label}: use ({errors})", float("nan"))
    for fault, of_kind in by_kind(found).items():
        words = Counter(one.judged.word for one in of_kind)
        wrong = sum(one.judged.wrong_in_use for one in of_kind)
        counts = ", ".join(f"{words[word]} {word}" for word in WORDS if words[word])
        yield information(f"{fault}, {kind} ({len(of_kind)}: {counts}): wrong under use", wrong)
    wrong = sum(one.judged.wrong_in_use for one in found)
    yield Check(
        f"wrong results under use of {len(found)} faulty trials ({kind})",
        100.0 * wrong / len(found),
        MOST_WRONG,
        "<=",
        "%",
    )


def reason_rows(found: Sequence[Found]) -> Iterator[Check]:
    """Rows of reasons: the share of the trials with a reason whose results are wrong, if they were used.

    Args:
        found: The trials with a fault.
    """
    counts: Counter[tuple[str, str]] = Counter()
    wrong: Counter[tuple[str, str]] = Counter()
    for one in found:
        for reason in one.reasons:
            counts[reason] += 1
            wrong[reason] += one.wrong
    for (word, means), number in sorted(counts.items()):
        yield information(
            f"{word}: '{means}' ({number} faulty trials): wrong", 100.0 * wrong[word, means] / number, "%"
        )
