"""The page on several visits: charts of scores and parameters over the days, and their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from html import escape

import numpy as np

from mbkf.study.session.means import half_width
from mbkf.study.session.trend import Trend, TrendLine
from mbkf.viz.markup import Html, grid, key, paragraph, table
from mbkf.viz.session.letterhead import condition_name
from mbkf.viz.session.tables import DIGITS
from mbkf.viz.session.terms import Terms
from mbkf.viz.session.trend_chart import TrendRow, trend_chart
from mbkf.viz.svg import number

MOST_COLUMNS = 5
"""Visits in the table: the first one and the last ones; the charts show all."""


def trend_part(found: Trend, terms: Terms) -> str:
    """Charts and table of a trend.

    Args:
        found: The trend.
        terms: The report's words.
    """
    condition = condition_name(found.gait.condition, terms.language)
    gait = ": ".join(text for text in (terms.say(found.gait.kind.value), condition) if text)
    entries = [("swatch r", terms.say("right")), ("swatch l", terms.say("left"))]
    if any(not line.side for line in found.lines):
        entries.append(("swatch m", terms.say("both")))
    if any(line.norm is not None for line in found.lines):
        entries.append(("swatch norm", terms.sheet("trend_norm")))
    names = dict.fromkeys(line.name for line in found.lines)
    charts = [_chart(found, [line for line in found.lines if line.name == name], terms) for name in names]
    return "".join(
        (
            f"<h3>{escape(gait)}</h3>",
            paragraph(terms.sheet("trend_note", len(found.visits))),
            key(*entries),
            grid(charts),
            _table(found, terms),
        )
    )


def _chart(found: Trend, lines: Sequence[TrendLine], terms: Terms) -> str:
    rows = [
        TrendRow(
            line.side,
            [_ordinal(one.day) for one in line.points],
            [float(one.mean.mean[0]) for one in line.points],
            [float(half_width(one.mean)[0]) for one in line.points],
        )
        for line in lines
    ]
    first, labels = lines[0], [(_ordinal(day), day) for day in dict.fromkeys(found.visits)]
    norm = None if first.norm is None else (float(first.norm.mean[0]), float(first.norm.sd[0]))
    return trend_chart(_title(first, terms), terms.unit(first.unit), rows, labels, norm)


def _table(found: Trend, terms: Terms) -> str:
    """The numbers of the first and the last visits, and the change from first to last."""
    days = list(dict.fromkeys(found.visits))
    shown = days if len(days) <= MOST_COLUMNS else [days[0], *days[1 - MOST_COLUMNS :]]
    sides = {"r": f", {terms.say('right')}", "l": f", {terms.say('left')}", "": ""}
    rows = []
    for line in found.lines:
        digits = DIGITS.get(line.unit, 1)
        by_day = {
            one.day: _with_half(one.mean.mean[0], half_width(one.mean)[0], digits) for one in line.points
        }
        change, half = float(line.change.difference[0]), float(line.change.half_width[0])
        text = _with_half(change, half, digits)
        unit = f", {terms.unit(line.unit)}" if line.unit else ""
        sure = np.isfinite(half) and abs(change) > half
        cells = [by_day.get(day, "–") for day in shown]
        rows.append(
            (_title(line, terms) + sides[line.side] + unit, *cells, Html(f"<b>{text}</b>") if sure else text)
        )
    return table(["", *shown, terms.sheet("trend_change")], rows, "trend")


def _title(line: TrendLine, terms: Terms) -> str:
    return terms.score(line.name) if line.name.isupper() else terms.measure(line.name)


def _with_half(value: float, half: float, digits: int) -> str:
    return number(float(value), digits) + (f" ± {number(float(half), digits)}" if np.isfinite(half) else "")


def _ordinal(day: str) -> int:
    return date.fromisoformat(day).toordinal()
