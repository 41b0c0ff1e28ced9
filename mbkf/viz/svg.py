"""Curves with bands of ±2 standard deviations as small inline SVG; colours come from the page's style sheet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.runs import runs

WIDTH, HEIGHT = 340.0, 150.0
LEFT, RIGHT, TOP, BOTTOM = 40.0, 8.0, 24.0, 20.0
BARS_WIDTH, BARS_NAME, BARS_ROW = 1000.0, 60.0, 20.0
"""Measures of a chart of bars: width, room for the names, height of a row."""


@dataclass(frozen=True)
class Line:
    """One curve of a chart.

    Attributes:
        x, y: (N,) points; NaN breaks the line.
        sd: (N,) standard deviations for the band of ±2, or None.
        inner_sd: (N,) part of them for a darker band inside, or None.
        side: "r", "l" or "" for its colour.
        thin: Drawn lightly, as one of several.
        dashed: Drawn with dashes.
        scales: True if the axis makes room for it; otherwise points outside lie on the frame's edge.
    """

    x: Array
    y: Array
    sd: Array | None = None
    side: str = ""
    thin: bool = False
    inner_sd: Array | None = None
    dashed: bool = False
    scales: bool = True


@dataclass(frozen=True)
class Mark:
    """A dashed vertical line at ``x`` in the colour of a side."""

    x: float
    side: str = ""


@dataclass(frozen=True)
class Span:
    """A bar above the curves from one x to another, in the row and the colour of a side."""

    first: float
    last: float
    side: str


SPAN_HEIGHT, SPAN_ROWS = 3.0, {"r": 0, "l": 1}
"""Height of such a bar, and the row of each side from the top."""


def chart(
    title: str,
    unit: str,
    lines: Sequence[Line],
    x_range: tuple[float, float],
    x_unit: str,
    *,
    marks: Sequence[Mark] = (),
    spans: Sequence[Span] = (),
    level: float | None = None,
    note: str = "",
    caption: str = "",
    width: float = WIDTH,
    height: float = HEIGHT,
) -> str:
    """A chart as an SVG element.

    Args:
        title: Written above, with the unit.
        unit: Of y.
        lines: Curves, drawn in order.
        x_range: First and last x shown.
        x_unit: Written after the last tick.
        marks: Vertical lines.
        spans: Bars above the curves.
        level: Height of a horizontal line: a bound, or an expected value.
        note: Text shown while the pointer rests on the chart.
        caption: Small text above the frame, on the right.
        width: In the drawing's own units, which the page scales.
        height: In the same units.
    """
    low, high = _y_range([line for line in lines if line.scales], level)
    box = _Box(width, height, x_range, (low, high))
    parts = [_grid(box, x_unit)]
    if level is not None:
        parts.append(f'<path class="level" d="M{LEFT:g} {box.y(level):.1f}H{width - RIGHT:g}"/>')
    parts += [
        f'<path class="mark {_side(m.side)}" d="M{box.x(m.x):.1f} {TOP:g}V{height - BOTTOM:g}"/>'
        for m in marks
        if x_range[0] <= m.x <= x_range[1]
    ]
    parts += [
        f'<rect class="span {one.side}" x="{box.x(one.first):.1f}" '
        f'y="{TOP - (2 - SPAN_ROWS[one.side]) * (SPAN_HEIGHT + 0.5):g}" '
        f'width="{box.x(one.last) - box.x(one.first):.1f}" height="{SPAN_HEIGHT:g}"/>'
        for one in spans
    ]
    parts += [_band(box, one, one.sd, "band" if one.inner_sd is None else "band outer") for one in lines]
    parts += [_band(box, one, one.inner_sd, "band inner") for one in lines]
    parts += [_path(box, line) for line in lines]
    if caption:
        parts.append(f'<text class="caption" x="{width - RIGHT:g}" y="{TOP - 3:g}">{escape(caption)}</text>')
    hint = f"<title>{escape(note)}</title>" if note else ""
    return (
        f'<svg class="chart" viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{escape(title)}">{hint}'
        f'<text class="title" x="2" y="12">{escape(title)}<tspan class="unit"> {escape(unit)}</tspan></text>'
        f"{''.join(parts)}</svg>"
    )


@dataclass(frozen=True)
class Bar:
    """A stretch of time: its row, its ends in s, and the classes that give it colour and style."""

    row: int
    start_s: float
    end_s: float
    style: str


def bar_chart(label: str, names: Sequence[str], bars: Sequence[Bar], span_s: tuple[float, float]) -> str:
    """Bars over time, a row for each name, as an SVG element.

    Args:
        label: Description of the chart for screen readers.
        names: Names of the rows.
        bars: The bars.
        span_s: First and last time shown.
    """
    first, last = span_s
    per_second = (BARS_WIDTH - BARS_NAME - 10.0) / (last - first)
    parts = [
        f'<text class="name" x="{BARS_NAME - 8:g}" y="{BARS_ROW * row + 13:g}">{escape(name)}</text>'
        for row, name in enumerate(names)
    ]
    parts += [
        f'<rect class="{bar.style}" x="{BARS_NAME + (bar.start_s - first) * per_second:.1f}" '
        f'y="{BARS_ROW * bar.row + 4:g}" width="{(bar.end_s - bar.start_s) * per_second:.1f}" '
        f'height="{BARS_ROW - 8:g}" rx="2"/>'
        for bar in bars
    ]
    found, digits = ticks(first, last, 10)
    bottom = BARS_ROW * len(names)
    for value in found:
        unit = " s" if value == found[-1] else ""
        x = BARS_NAME + (value - first) * per_second
        parts.append(f'<text class="x" x="{x:.1f}" y="{bottom + 12:g}">{number(value, digits)}{unit}</text>')
    return (
        f'<svg class="feet" viewBox="0 0 {BARS_WIDTH:g} {bottom + 16:g}" role="img" '
        f'aria-label="{escape(label)}">{"".join(parts)}</svg>'
    )


def ticks(low: float, high: float, wanted: int) -> tuple[list[float], int]:
    """Round numbers for an axis, and the decimals they need.

    Args:
        low: Lower end of the axis.
        high: Upper end of the axis.
        wanted: Approximate number of ticks.
    """
    raw = (high - low) / max(1, wanted)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if s * power >= 0.999 * raw)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    if last < first:
        return ticks(low, high, 2 * wanted)
    return [k * step for k in range(first, last + 1)], max(0, -math.floor(math.log10(step) + 1e-9))


def number(value: float, digits: int) -> str:
    """A number with a real minus sign and no negative zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


@dataclass(frozen=True)
class _Box:
    """From values to places on the drawing."""

    width: float
    height: float
    x_range: tuple[float, float]
    y_range: tuple[float, float]

    def x(self, value: Any) -> Any:
        """Place of x values from the left."""
        first, last = self.x_range
        return LEFT + (value - first) / ((last - first) or 1.0) * (self.width - LEFT - RIGHT)

    def y(self, value: Any) -> Any:
        """Place of y values from the top."""
        low, high = self.y_range
        return self.height - BOTTOM - (value - low) / (high - low) * (self.height - TOP - BOTTOM)

    def path(self, x: Array, y: Array) -> str:
        """A path in tenths of a unit, each point relative to the last one (the shortest text).

        Points outside the frame are drawn on its edge.
        """
        places = np.column_stack([self.x(x), self.y(np.clip(y, *self.y_range))])
        tenths = np.round(10.0 * places).astype(int)
        steps = np.diff(tenths, axis=0).ravel()
        start = f"M{tenths[0, 0]} {tenths[0, 1]}l"
        return start + "".join(f"{n}" if n < 0 else f" {n}" for n in steps.tolist())


def _y_range(lines: Sequence[Line], level: float | None) -> tuple[float, float]:
    """Range of all curves and of most bands: a band may leave the frame where it is far wider than usual."""
    values = [line.y[np.isfinite(line.y)] for line in lines]
    values += [np.array([] if level is None else [level])]
    for line in lines:
        if line.sd is not None and np.isfinite(line.sd).any():
            wide = 2.0 * line.sd[np.isfinite(line.sd)]
            usual = min(float(wide.max()), 3.0 * float(np.median(wide)))
            known = np.isfinite(line.sd) & np.isfinite(line.y)
            around = np.minimum(2.0 * line.sd[known], usual)
            values += [line.y[known] - around, line.y[known] + around]
    every = np.concatenate(values) if values else np.empty(0)
    if not every.size:
        return -1.0, 1.0
    low, high = float(every.min()), float(every.max())
    margin = max(0.06 * (high - low), 0.01 * max(abs(low), abs(high)), 1e-3)
    return low - margin, high + margin


def _grid(box: _Box, x_unit: str) -> str:
    bottom, right = box.height - BOTTOM, box.width - RIGHT
    parts = []
    found, digits = ticks(*box.y_range, wanted=max(2, round((bottom - TOP) / 26)))
    for value in found:
        y = box.y(value)
        parts.append(
            f'<path class="{"zero" if value == 0 else "grid"}" d="M{LEFT:g} {y:.1f}H{right:g}"/>'
            f'<text class="y" x="{LEFT - 5:g}" y="{y + 3.2:.1f}">{number(value, digits)}</text>'
        )
    found, digits = ticks(*box.x_range, wanted=max(2, round((right - LEFT) / 62)))
    for value in found:
        x = box.x(value)
        unit = f" {x_unit}" if value == found[-1] else ""
        end = ' class="x end"' if x > right - 12 else ' class="x"'
        parts.append(
            f'<path class="grid" d="M{x:.1f} {TOP:g}V{bottom:g}"/>'
            f'<text{end} x="{min(x, right):.1f}" y="{bottom + 13:g}">{number(value, digits)}{unit}</text>'
        )
    return "".join(parts)


def _side(side: str) -> str:
    return side or "m"


_TENTHS = 'transform="scale(.1)"'


def _path(box: _Box, line: Line) -> str:
    known = np.isfinite(line.y)
    d = "".join(box.path(*_thinned(line.x[a:b], line.y[a:b], box.width)) for a, b in runs(known))
    kind, dashed = "thin" if line.thin else "line", " dashed" if line.dashed else ""
    return f'<path {_TENTHS} class="{kind} {_side(line.side)}{dashed}" d="{d}"/>' if d else ""


def _band(box: _Box, line: Line, sd: Array | None, kind: str) -> str:
    if sd is None:
        return ""
    d = ""
    for first, end in runs(np.isfinite(line.y) & np.isfinite(sd)):
        if end - first < 2:
            continue
        run, step = slice(first, end), max(1, 2 * (end - first) // round(box.width))
        x, y, wide = line.x[run][::step], line.y[run][::step], 2.0 * sd[run][::step]
        d += box.path(np.concatenate([x, x[::-1]]), np.concatenate([y + wide, (y - wide)[::-1]])) + "z"
    return f'<path {_TENTHS} class="{kind} {_side(line.side)}" d="{d}"/>' if d else ""


def _thinned(x: Array, y: Array, width: float) -> tuple[Array, Array]:
    """A curve with at most a least and a greatest value for each unit of width."""
    bins = round(width)
    if len(x) <= 2 * bins:
        return x, y
    edges = np.linspace(0, len(x), bins + 1).astype(int)
    kept = sorted({int(i) for a, b in pairwise(edges) for i in (a + y[a:b].argmin(), a + y[a:b].argmax())})
    return x[kept], y[kept]
