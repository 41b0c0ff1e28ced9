"""Marker sets inferred: on which segment every marker is, of captures whose protocol is withheld.

Markers are renamed M01, M02, … or keep their names; every shipped set that knows more than half of them is left out of
the density of places. A marker on a joint's line counts on either side; the strict share is shown as well. The angles
and the marker RMS that follow from the inferred sets are compared with those of the right protocol.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.any_capture.marked import CAPTURES, Known, beside, hidden_names, known, renamed
from benchmarks.any_capture.set_angles import Compared, angle_rows, compared, reference
from benchmarks.checks import Check, information
from mbkf.errors import MbkfError
from mbkf.trial.protocol.inferred import InferredSet, infer_marker_set

SURE = 0.9
"""A wrong marker of at least this probability was not told; the program's own bound does not move this one."""

LEAST_WITH_STATIC, LEAST_WITHOUT, LEAST_NAMED = 0.95, 0.85, 0.99
MOST_UNTOLD = 0.01
MOST_SECONDS = 20.0


@dataclass(frozen=True)
class Score:
    """What came out of one capture.

    Attributes:
        markers: How many it has.
        right: Of those, on their segment or on the other side of its joint.
        strict: On their segment.
        untold: Wrong, with a probability of :data:`SURE` or more.
        seconds: Time that the inference took.
    """

    markers: int
    right: int
    strict: int
    untold: int
    seconds: float

    @property
    def share(self) -> float:
        """Share of the right ones."""
        return self.right / self.markers


@dataclass(frozen=True)
class Judged:
    """Scores and comparisons, each by the capture's name."""

    static: Mapping[str, Score]
    moving: Mapping[str, Score]
    named: Mapping[str, Score]
    hidden_angles: Mapping[str, Compared]
    named_angles: Mapping[str, Compared]


def marker_set_rows(data: Path, *, quick: bool = False) -> list[Check]:
    """The rows of the table.

    Args:
        data: Folder of the reference captures.
        quick: Whether to judge few captures.
    """
    return rows_of(judged(data, quick=quick))


def judged(data: Path, *, quick: bool = False, told: Callable[[str], object] = str) -> Judged:
    """All captures inferred and compared.

    Args:
        data: Folder of the reference captures.
        quick: Whether to judge few captures.
        told: Called with what came out of each, in a line.
    """
    found = Judged({}, {}, {}, {}, {})
    static, moving, named = dict(found.static), dict(found.moving), dict(found.named)
    hidden_angles, named_angles = dict(found.hidden_angles), dict(found.named_angles)
    for marked in CAPTURES:
        if quick and not marked.quick:
            continue
        one = known(marked, data)
        truth = reference(one) if marked.walks else None
        for case, scores, angles, use_names, with_static in (
            ("hidden", static if one.static else moving, hidden_angles, False, True),
            ("no static", moving, None, False, False),
            ("named", named, named_angles, True, True),
        ):
            if case == "no static" and one.static is None:
                continue
            score, inferred, names = inferred_score(one, use_names=use_names, with_static=with_static)
            scores[one.name] = score
            line = f"{one.name}, {case}: {score.right}/{score.markers} right, {score.strict} strict"
            line += f", {score.untold} untold, {score.seconds:.1f} s; {wrong(one, inferred, names)}"
            if angles is not None and truth is not None:
                angles[one.name] = compared(one, inferred, truth)
                line += f"; {angles[one.name]}"
            told(line)
    return Judged(static, moving, named, hidden_angles, named_angles)


def inferred_score(
    one: Known, *, use_names: bool, with_static: bool
) -> tuple[Score, InferredSet | None, Mapping[str, str]]:
    """The score of one capture, what was inferred (None where nothing was), and its names then by the true ones.

    Args:
        one: The capture.
        use_names: Whether it keeps its names.
        with_static: Whether its standing trial is used.
    """
    names = hidden_names(one)
    if use_names:
        names = {name: name for name in names}
    trial = renamed(one.trial, names)
    static = renamed(one.static, names) if one.static is not None and with_static else None
    if static is None:
        names = {name: names[name] for name in one.trial.markers.names}
    start = time.perf_counter()
    try:
        inferred = infer_marker_set(static, [trial], leave_out=one.withheld)
    except MbkfError:
        inferred = None
    seconds = time.perf_counter() - start
    pairs = found_segments(one, inferred, names)
    return (
        Score(
            len(pairs),
            sum(beside(found, true) for found, true, _ in pairs),
            sum(found == true for found, true, _ in pairs),
            sum(not beside(found, true) and sure >= SURE for found, true, sure in pairs),
            seconds,
        ),
        inferred,
        names,
    )


def found_segments(
    one: Known, inferred: InferredSet | None, names: Mapping[str, str]
) -> list[tuple[str, str, float]]:
    """Segment found, true segment and probability of every marker; "" and 0 where it was found on none.

    Args:
        one: The capture.
        inferred: What was inferred; None where it was refused.
        names: The names that it was inferred from, by the true ones.
    """
    segments = one.segments
    markers = {} if inferred is None else {marker.name: marker for marker in inferred.protocol.markers}
    pairs = []
    for true, name in names.items():
        marker = markers.get(name)
        if marker is None:
            pairs.append(("", segments[true], 0.0))
        else:
            pairs.append((marker.segment, segments[true], marker.probability))
    return pairs


def wrong(one: Known, inferred: InferredSet | None, names: Mapping[str, str]) -> str:
    """The wrong markers, in words.

    Args:
        one: The capture.
        inferred: What was inferred; None where it was refused.
        names: The names that it was inferred from, by the true ones.
    """
    found = zip(names, found_segments(one, inferred, names), strict=True)
    return ", ".join(
        f"{name} {segment or 'none'} ({sure:.2f}) not {true}"
        for name, (segment, true, sure) in found
        if not beside(segment, true)
    )


def rows_of(found: Judged) -> list[Check]:
    """The rows of what was judged."""
    every = [*found.static.values(), *found.moving.values()]
    rows = [
        *_share_rows("hidden names, static and trial", found.static, LEAST_WITH_STATIC),
        *_share_rows("hidden names, no static", found.moving, LEAST_WITHOUT),
        Check("marker sets, hidden names: wrong and not told", _untold(every), MOST_UNTOLD, "<="),
        *_share_rows("own names", found.named, LEAST_NAMED),
        Check("marker sets, own names: wrong and not told", _untold(list(found.named.values())), 0.0, "<="),
        *angle_rows("hidden names", found.hidden_angles),
        *angle_rows("own names", found.named_angles),
    ]
    slowest = max((score.seconds for score in [*every, *found.named.values()]), default=0.0)
    return [*rows, Check("marker sets: longest inference", slowest, MOST_SECONDS, "<=", "s")]


def _share_rows(case: str, scores: Mapping[str, Score], least: float) -> list[Check]:
    if not scores:
        return []
    markers = sum(score.markers for score in scores.values())
    worst = min(scores, key=lambda name: scores[name].share)
    return [
        Check(
            f"marker sets, {case}: right",
            sum(score.right for score in scores.values()) / markers,
            least,
            ">=",
        ),
        information(
            f"marker sets, {case}: right, strictly",
            sum(score.strict for score in scores.values()) / markers,
        ),
        information(f"marker sets, {case}: right, worst ({worst})", scores[worst].share),
    ]


def _untold(scores: Sequence[Score]) -> float:
    return sum(score.untold for score in scores) / max(sum(score.markers for score in scores), 1)
