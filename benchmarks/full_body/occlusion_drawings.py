"""Figures of the occlusion study: error over the share hidden and over gap length, and the stated intervals' cover."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.dynamic.losses import CAPTURES
from benchmarks.full_body.filters import COLOURS, DYNAMIC, FCDI
from benchmarks.full_body.occlusion import (
    AFTER,
    DYNAMIC_SMOOTHED,
    FCDI_SMOOTHED,
    GAPS_S,
    NOMINAL,
    RIGID,
    RIGID_NEAR,
    SPLINE,
    SYNTHETIC,
    Point,
    over_gap,
    over_share,
)
from benchmarks.thesis_report.figures import GREEN, GREY, TRUTH, Drawing, axes, labelled, legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RIGID_FILLING = "rigid body"
"""Better of rigid-body filling from a segment's own markers and with its neighbours'."""

STYLES = {
    FCDI: (COLOURS[FCDI], "-"),
    FCDI_SMOOTHED: (COLOURS[FCDI], "--"),
    DYNAMIC: (COLOURS[DYNAMIC], "-"),
    DYNAMIC_SMOOTHED: (COLOURS[DYNAMIC], "--"),
    SPLINE: (GREY, "-"),
    RIGID_FILLING: (GREEN, "-"),
}

Value = Callable[[Point, str], float]


def occlusion_drawings(points: Sequence[Point]) -> Iterator[Drawing]:
    """All figures of what was measured."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    note = "Dashed: later frames are used. The spline and rigid-body filling use them, too."
    for title, chosen, by_gap in (
        ("Hidden markers over the share hidden", over_share(points), False),
        ("Lost markers over gap length", over_gap(points), True),
    ):
        names = [name for name in (*CAPTURES, SYNTHETIC) if any(p.capture == name for p in chosen)]
        figure, all_axes = axes(-(-len(names) // 2), min(len(names), 2))
        for name, one in zip(names, all_axes, strict=False):
            _curves(one, [p for p in chosen if p.capture == name], by_gap, _hidden)
            labelled(one, _horizontal(by_gap), "hidden markers (mm)")
            one.set_title(name, fontsize=9, loc="left")
            one.set_yscale("log")
            one.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            one.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            one.yaxis.set_minor_formatter(NullFormatter())
        figure.legend(
            *all_axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=8
        )
        for spare in all_axes[len(names) :]:
            spare.remove()
        yield Drawing("own", title, figure, note)
    if any(p.capture == SYNTHETIC for p in points):
        yield _truth_drawing([p for p in points if p.capture == SYNTHETIC])


def _truth_drawing(points: Sequence[Point]) -> Drawing:
    figure, (share, gap, share_cover, gap_cover) = axes(2, 2)
    for above, below, chosen, by_gap in (
        (share, share_cover, over_share(points), False),
        (gap, gap_cover, over_gap(points), True),
    ):
        _curves(above, chosen, by_gap, _angle)
        _curves(below, chosen, by_gap, _cover)
        below.axhline(100 * NOMINAL, color=TRUTH, lw=0.8, ls=":")
        labelled(above, "", "joint angles (°)")
        labelled(below, _horizontal(by_gap), "within 1.96 sd (%)")
    legend(gap, 3)
    return Drawing(
        "own",
        "Joint angles and their stated intervals",
        figure,
        "Synthetic walks. The line is the nominal 95 %. After filling, the kinematic filter takes the filled markers "
        "for measured ones: what it states then does not know of the gap.",
    )


def _curves(one: Axes, points: Sequence[Point], by_gap: bool, value: Value) -> None:
    x = [p.condition.gap_s if by_gap else 100 * p.condition.share for p in points]
    for name, (colour, style) in STYLES.items():
        one.plot(
            x, [value(p, name) for p in points], style, color=colour, marker="o", ms=3, lw=1.4, label=name
        )
    if by_gap:
        one.set_xscale("log")
        one.set_xticks(GAPS_S, [f"{gap:g}" for gap in GAPS_S])
        one.minorticks_off()


def _horizontal(by_gap: bool) -> str:
    return "gap (s)" if by_gap else "hidden (%)"


def _hidden(point: Point, name: str) -> float:
    if name == RIGID_FILLING:
        return min(point.hidden_mm(RIGID), point.hidden_mm(RIGID_NEAR))
    return point.hidden_mm(name)


def _angle(point: Point, name: str) -> float:
    if name == RIGID_FILLING:
        return float(np.min([point.scores[one + AFTER].angle_deg for one in (RIGID, RIGID_NEAR)]))
    return point.scores[name if name in point.scores else name + AFTER].angle_deg


def _cover(point: Point, name: str) -> float:
    if name == RIGID_FILLING:
        better = min((RIGID, RIGID_NEAR), key=lambda one: point.scores[one + AFTER].angle_deg)
        return 100 * point.scores[better + AFTER].cover
    return 100 * point.scores[name if name in point.scores else name + AFTER].cover
