"""Scores and spatiotemporal parameters of one person over several visits, each with its 95 % interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

from mbkf.errors import InvalidInput
from mbkf.io.norms import Band, Norms
from mbkf.study.session.comparison import is_same_body, measure_mean
from mbkf.study.session.means import Difference, Mean, difference_of
from mbkf.study.session.norm_selection import speed_of
from mbkf.study.session.records import MovementGroup, Session
from mbkf.study.session.scores import GPS, GaitScores, gait_scores

GDI = "GDI"

PARAMETERS = ("Speed", "Cadence", "Step length", "Step width", "Single support", "Double support")
"""Parameters shown where the laboratory chooses no others."""

LEAST_VISITS = 3
"""Two visits are compared curve by curve instead."""


@dataclass(frozen=True)
class TrendPoint:
    """A value of one visit.

    Attributes:
        day: Of the visit, e.g. "2025-03-31".
        mean: The mean over its cycles.
    """

    day: str
    mean: Mean


@dataclass(frozen=True)
class TrendLine:
    """A quantity over the visits that know it.

    Attributes:
        name: "GPS", "GDI" or the parameter's name.
        unit: Of the values; empty for the GDI.
        side: "r", "l", or "" for both sides together.
        points: In the order of the days.
        change: Last less first visit, with its interval.
        norm: Of the norms' persons; None without.
    """

    name: str
    unit: str
    side: str
    points: tuple[TrendPoint, ...]
    change: Difference
    norm: Band | None = None

    @property
    def days(self) -> tuple[int, ...]:
        """Days since the first of its visits."""
        ordinals = [date.fromisoformat(one.day).toordinal() for one in self.points]
        return tuple(one - ordinals[0] for one in ordinals)


@dataclass(frozen=True)
class Trend:
    """A person's visits.

    Attributes:
        visits: Days of all visits with the gait that is followed, in their order.
        gait: That gait in the last visit.
        lines: Scores first, then parameters.
    """

    visits: tuple[str, ...]
    gait: MovementGroup
    lines: tuple[TrendLine, ...]


def trend(sessions: Sequence[Session], norms: Norms | None = None, names: Sequence[str] = ()) -> Trend | None:
    """The trend of the last visit's first gait; None where fewer than three visits have it.

    Args:
        sessions: Visits of one person in any order.
        norms: For scores; None without.
        names: Parameters; empty for the usual ones.

    Raises:
        InvalidInput: A visit states no date.
    """
    undated = [one.name for one in sessions if not one.visit.date]
    if undated:
        raise InvalidInput(
            f"{', '.join(undated)}: the date of the visit is not stated; a trend needs the date of each visit"
        )
    ordered = sorted(sessions, key=lambda one: one.visit.date)
    last = next(iter(ordered[-1].gaits), None) if ordered else None
    if last is None:
        return None
    found = [(one, gait) for one in ordered if (gait := one.gait(last.kind, last.condition)) is not None]
    if len(found) < LEAST_VISITS:
        return None
    norms = norms.at_speed(speed_of(last)) if norms is not None else None
    lines = [*_scores(found, norms), *_parameters(found, norms, names or PARAMETERS)]
    return Trend(tuple(one.visit.date for one, _ in found), last, tuple(lines))


_Visits = Sequence[tuple[Session, MovementGroup]]


def _scores(visits: _Visits, norms: Norms | None) -> list[TrendLine]:
    """Scores of visits whose curves have the convention and the axes of the norms."""
    if norms is None:
        return []
    alike = [(one, gait) for one, gait in visits if norms.read == (one.convention.name, *one.axes)]
    each = [(one, gait_scores(gait, norms)) for one, gait in alike]
    known = [(one, scores) for one, scores in each if scores is not None]
    gps = [norms.measures.get((gait.kind.value, GPS)) for _, gait in visits][-1]
    lines = [
        _line(GPS, "deg", side, [(one, _gps(scores, side)) for one, scores in known], gps)
        for side in ("", "r", "l")
    ]
    lines += [_line(GDI, "", side, [(one, _gdi(scores, side)) for one, scores in known]) for side in "rl"]
    return [line for line in lines if line is not None]


def _gps(scores: GaitScores, side: str) -> Mean | None:
    if not side:
        return scores.gps
    own = scores.sides["rl".index(side)]
    return None if own is None else own.gps


def _gdi(scores: GaitScores, side: str) -> Mean | None:
    own = scores.sides["rl".index(side)]
    return None if own is None else own.gdi


def _parameters(visits: _Visits, norms: Norms | None, names: Sequence[str]) -> list[TrendLine]:
    lines = []
    for name in names:
        measures = [(one, gait.measure(name)) for one, gait in visits]
        unit = next((measure.unit for _, measure in measures if measure is not None), "")
        band = None if norms is None else norms.measures.get((visits[-1][1].kind.value, name))
        for side in "rl":
            means = [(one, None if m is None else measure_mean(m, side)) for one, m in measures]
            lines.append(_line(name, unit, side, means, band))
    return [line for line in lines if line is not None]


def _line(
    name: str, unit: str, side: str, means: Sequence[tuple[Session, Mean | None]], norm: Band | None = None
) -> TrendLine | None:
    """The line of the visits that know a value; None for fewer than two."""
    known = [(one, mean) for one, mean in means if mean is not None]
    if len(known) < 2:
        return None
    (first, before), (last, after) = known[0], known[-1]
    change = difference_of(after, before, is_same_body(first.subject, last.subject))
    return TrendLine(
        name, unit, side, tuple(TrendPoint(one.visit.date, mean) for one, mean in known), change, norm
    )
