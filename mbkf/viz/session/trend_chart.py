"""Values over the days of visits as an SVG: points with intervals, right and left side by side, the norm behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from mbkf.viz.svg import number, ticks

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 250.0, 130.0, 36.0, 14.0, 22.0, 20.0
APART = {"r": 2.5, "": 0.0, "l": -2.5}
"""Shift of a side's points, so that intervals of both stay visible."""

LABEL = 58.0
"""Width of a day that is written below, with a gap."""


@dataclass(frozen=True)
class TrendRow:
    """Values of a side.

    Attributes:
        side: "r", "l", or "" for both.
        days: Of the visits, as ordinals.
        values: One for each visit.
        halves: Half of each interval; NaN where not known.
    """

    side: str
    days: Sequence[int]
    values: Sequence[float]
    halves: Sequence[float]


def trend_chart(
    title: str,
    unit: str,
    rows: Sequence[TrendRow],
    labels: Sequence[tuple[int, str]],
    norm: tuple[float, float] | None,
) -> str:
    """The chart as an SVG element.

    Args:
        title: Written above, with the unit.
        unit: Of the values.
        rows: One for each side.
        labels: Day and its text of every visit, in their order.
        norm: Mean and standard deviation; None without.
    """
    box = _Box(labels[0][0], labels[-1][0], *_range(rows, norm))
    band = ""
    if norm is not None:
        top, bottom = (box.y(norm[0] + sign * norm[1]) for sign in (1.0, -1.0))
        size = f'width="{WIDTH - LEFT - RIGHT:g}" height="{bottom - top:.1f}"'
        band = f'<rect class="norm" x="{LEFT:g}" y="{top:.1f}" {size}/>'
    parts = [band, _levels(box), _days(box, labels), *(_row(box, one) for one in rows)]
    return (
        f'<svg class="trend" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{escape(title)}">'
        f'<text class="title" x="2" y="12">{escape(title)}<tspan class="unit"> {escape(unit)}</tspan></text>'
        f"{''.join(parts)}</svg>"
    )


@dataclass(frozen=True)
class _Box:
    first: int
    last: int
    low: float
    high: float

    def x(self, day: int) -> float:
        """Place of a day; a margin of 6 units keeps the first and last points inside."""
        return (
            LEFT + 6.0 + (day - self.first) / max(self.last - self.first, 1) * (WIDTH - LEFT - RIGHT - 12.0)
        )

    def y(self, value: float) -> float:
        """Place of a value."""
        return HEIGHT - BOTTOM - (value - self.low) / (self.high - self.low) * (HEIGHT - TOP - BOTTOM)


def _range(rows: Sequence[TrendRow], norm: tuple[float, float] | None) -> tuple[float, float]:
    ends = [
        value + sign * (half if np.isfinite(half) else 0.0)
        for row in rows
        for value, half in zip(row.values, row.halves, strict=True)
        for sign in (-1.0, 1.0)
    ]
    ends += [] if norm is None else [norm[0] - norm[1], norm[0] + norm[1]]
    low, high = min(ends), max(ends)
    margin = max(0.08 * (high - low), 0.02 * abs(high), 1e-3)
    return low - margin, high + margin


def _levels(box: _Box) -> str:
    found, digits = ticks(box.low, box.high, 4)
    return "".join(
        f'<path class="grid" d="M{LEFT:g} {box.y(value):.1f}H{WIDTH - RIGHT:g}"/>'
        f'<text class="y" x="{LEFT - 5:g}" y="{box.y(value) + 3.2:.1f}">{number(value, digits)}</text>'
        for value in found
    )


def _days(box: _Box, labels: Sequence[tuple[int, str]]) -> str:
    """Days below the frame, the first and the last always, others where there is room."""
    shown = [labels[0]]
    for day, text in labels[1:-1]:
        if box.x(day) - box.x(shown[-1][0]) >= LABEL <= box.x(labels[-1][0]) - box.x(day):
            shown.append((day, text))
    shown.append(labels[-1])
    places = [min(max(box.x(day), 0.5 * LABEL), WIDTH - 0.5 * LABEL) for day, _ in shown]
    texts = "".join(
        f'<text class="x" x="{x:.1f}" y="{HEIGHT - 6:g}">{escape(text)}</text>'
        for x, (_, text) in zip(places, shown, strict=True)
    )
    marks = "".join(
        f'<path class="grid" d="M{box.x(day):.1f} {TOP:g}V{HEIGHT - BOTTOM:g}"/>' for day, _ in labels
    )
    return marks + texts


def _row(box: _Box, row: TrendRow) -> str:
    side = row.side or "m"
    places = [
        (box.x(day) + APART[row.side], box.y(value)) for day, value in zip(row.days, row.values, strict=True)
    ]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    whiskers = "".join(
        f'<path class="interval {side}" d="M{x:.1f} {box.y(value - half):.1f}V{box.y(value + half):.1f}"/>'
        for (x, _), value, half in zip(places, row.values, row.halves, strict=True)
        if np.isfinite(half)
    )
    dots = "".join(f'<circle class="{side}" cx="{x:.1f}" cy="{y:.1f}" r="2.6"/>' for x, y in places)
    return f'<polyline class="trend-line {side}" points="{line}"/>{whiskers}{dots}'
