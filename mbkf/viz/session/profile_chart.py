"""The Movement Analysis Profile (Baker 2009): a column for each score, right and left side by side, the norm behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from mbkf.viz.svg import number, ticks

WIDTH, HEIGHT, LEFT, TOP, BOTTOM, RIGHT = 1000.0, 230.0, 40.0, 22.0, 34.0, 8.0
BAR = 20.0
"""Measures of the drawing; width of a bar."""

Pair = tuple[float, float]
"""A score, and half of its interval or the norm's standard deviation."""


@dataclass(frozen=True)
class ProfileRow:
    """A column of the profile; None for a side or a norm that is not known."""

    title: str
    right: Pair | None
    left: Pair | None
    norm: Pair | None


def profile_chart(title: str, rows: Sequence[ProfileRow], unit: str) -> str:
    """The profile as an SVG element.

    Args:
        title: Written above, with the unit.
        rows: Its columns.
        unit: Of the scores.
    """
    tops = [sum(pair) for row in rows for pair in (row.right, row.left, row.norm) if pair is not None]
    high = 1.05 * max(tops, default=1.0)
    step = (WIDTH - LEFT - RIGHT) / max(len(rows), 1)
    parts = [_levels(high)]
    for k, row in enumerate(rows):
        middle = LEFT + (k + 0.5) * step
        parts.append(_norm(row.norm, middle, step, high))
        parts += [
            _bar(pair, middle + shift, high, side)
            for pair, shift, side in ((row.left, -0.6 * BAR, "l"), (row.right, 0.6 * BAR, "r"))
            if pair is not None
        ]
        parts.append(_label(row.title, middle))
    return (
        f'<svg class="profile" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{escape(title)}">'
        f'<text class="title" x="2" y="12">{escape(title)}<tspan class="unit"> {escape(unit)}</tspan></text>'
        f"{''.join(parts)}</svg>"
    )


def _y(value: float, high: float) -> float:
    return HEIGHT - BOTTOM - value / high * (HEIGHT - TOP - BOTTOM)


def _levels(high: float) -> str:
    found, digits = ticks(0.0, high, 5)
    return "".join(
        f'<path class="grid" d="M{LEFT:g} {_y(value, high):.1f}H{WIDTH - RIGHT:g}"/>'
        f'<text class="y" x="{LEFT - 5:g}" y="{_y(value, high) + 3.2:.1f}">{number(value, digits)}</text>'
        for value in found
    )


def _norm(pair: Pair | None, middle: float, step: float, high: float) -> str:
    """A pale band of the norm's mean plus and minus its standard deviation."""
    if pair is None:
        return ""
    top, bottom = _y(sum(pair), high), _y(max(pair[0] - pair[1], 0.0), high)
    half = 0.42 * step
    size = f'width="{2 * half:.1f}" height="{bottom - top:.1f}"'
    return f'<rect class="norm" x="{middle - half:.1f}" y="{top:.1f}" {size}/>'


def _bar(pair: Pair, middle: float, high: float, side: str) -> str:
    """A bar with a whisker of the interval."""
    top, floor = _y(pair[0], high), _y(0.0, high)
    low, up = _y(max(pair[0] - pair[1], 0.0), high), _y(sum(pair), high)
    return (
        f'<rect class="span {side}" x="{middle - 0.5 * BAR:.1f}" y="{top:.1f}" width="{BAR:g}" '
        f'height="{floor - top:.1f}"/><path class="whisker" d="M{middle:.1f} {low:.1f}V{up:.1f}"/>'
    )


def _label(title: str, middle: float) -> str:
    """The title below, on two lines where it has two words or more."""
    first, _, rest = title.partition(" ")
    y = HEIGHT - BOTTOM + 13
    return "".join(
        f'<text class="x" x="{middle:.1f}" y="{y + 11 * k:g}">{escape(line)}</text>'
        for k, line in enumerate((first, rest))
        if line
    )
