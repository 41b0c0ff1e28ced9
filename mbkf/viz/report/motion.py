"""The report's curves: joint angles, torques and reactions, over gait cycles and against time."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, SIDES, Array
from mbkf.io.results import Reconstruction
from mbkf.model.human import reference_body
from mbkf.numerics.runs import spread_indices
from mbkf.trial.gait.convention import BY_MODEL, Convention
from mbkf.trial.gait.cycles import POINTS, Gait, over_cycle
from mbkf.viz.convention_words import moment_note, notes
from mbkf.viz.language import ENGLISH
from mbkf.viz.markup import folded, grid, key, paragraph, section
from mbkf.viz.report.cells import (
    Cell,
    angle_cells,
    joint_names,
    leg_angle_cells,
    reaction_cells,
    torque_cells,
)
from mbkf.viz.report.ranges import ranges
from mbkf.viz.report.reading import Reading
from mbkf.viz.report.spreads import band_key, cycle_sd, offsets_known, spread_note
from mbkf.viz.svg import WIDTH, Line, Mark, chart
from mbkf.viz.wording import SIDE_NAMES

MOST_SINGLE = 8
"""Most cycles that are drawn one by one, evenly chosen; the mean is that of all."""

LONG_S, BROAD = 15.0, 1110.0
"""Curves over a longer time, s, are drawn with this width."""


def motion_section(r: Reconstruction, gait: Gait | None, convention: Convention = BY_MODEL) -> str:
    """Angles and torques: over the gait cycle if there is gait, then against time.

    Args:
        r: The results.
        gait: The gait; None without.
        convention: Axes and signs of angles and torques.
    """
    read = Reading.of(r, convention)
    told = [paragraph(one) for one in notes(ENGLISH, convention, (read.angles.axes,))]
    body = [_unobserved(r), *told, paragraph(spread_note(r)), ranges(r, read)]
    if gait is not None:
        drawn = partial(cycle_chart, r.times_s, gait)
        body += _curves(r, read, "over the gait cycle", drawn, gait, broad=False)
    against = _curves(r, read, "against time", partial(time_chart, r.times_s), None, broad=is_long(r))
    body += [folded("Angles and torques against time", *against)] if gait and is_long(r) else against
    return section("motion", "Joint angles and torques", *body)


def _curves(
    r: Reconstruction, read: Reading, how: str, draw: Callable[[Cell], str], gait: Gait | None, broad: bool
) -> list[str]:
    names, parts = joint_names(reference_body(r.subject)), []
    sense = paragraph(moment_note(ENGLISH, read.convention, _TORQUE_NOTE))
    for what, note, cells, lower in (
        ("angles", _key(r, gait), angle_cells, leg_angle_cells(r, names.legs, read)),
        ("torques", sense, torque_cells, torque_cells(r, names.loaded, read)),
    ):
        parts += [f"<h3>Joint {what} {how}</h3>", note, charts(lower, draw, broad)]
        if names.upper:
            upper = charts(cells(r, names.upper, read), draw, broad)
            parts.append(folded(f"Trunk, head and arms: {what}", upper))
    return parts


_TORQUE_NOTE = (
    "Torques of the muscles and ligaments about the axis of each angle, positive in the angle's direction, per kg of "
    "body mass: pushing off with the foot is a negative ankle dorsiflexion torque."
)


def reaction_section(r: Reconstruction, gait: Gait | None) -> str:
    """Ground reactions of both feet."""
    body = []
    if gait is not None:
        cells = reaction_cells(r, 100.0 / (r.subject.mass_kg * GRAVITY_M_S2), "% body weight")
        over_cycles = charts([cells], partial(cycle_chart, r.times_s, gait), False)
        body += ["<h3>Over the gait cycle</h3>", over_cycles]
    against = charts([reaction_cells(r, 1.0, "N")], partial(time_chart, r.times_s), is_long(r))
    body += ["<h3>Against time</h3>", against]
    return section("reactions", "Ground reactions", _key(r, gait), *body)


def charts(rows: list[list[Cell]], draw: Callable[[Cell], str], broad: bool) -> str:
    """Charts, three in a row, or wide ones below each other.

    Args:
        rows: The cells of each row.
        draw: Makes a cell's chart.
        broad: True for charts as wide as the page.
    """
    if not rows:
        return paragraph("Not known: no force plate measured this trial.")
    if broad:
        return grid((draw(cell) for row in rows for cell in row), columns=1)
    return grid(chart for row in rows for chart in [*(draw(cell) for cell in row), "", ""][:3])


def time_chart(times_s: Array, cell: Cell) -> str:
    """A cell against time; as wide as the page in a long trial."""
    lines = [
        Line(times_s, one.values, one.sd, side, inner_sd=one.inner_sd) for side, one in cell.curves.items()
    ]
    span = (float(times_s[0]), float(max(times_s[-1], times_s[0] + 1e-3)))
    width = BROAD if span[1] - span[0] > LONG_S else WIDTH
    note = _positive(cell)
    return chart(cell.title, cell.unit, lines, span, "s", note=note, width=width, caption=cell.caption)


def _positive(cell: Cell) -> str:
    return f"positive: {cell.positive}" if cell.positive else ""


def cycle_chart(times_s: Array, gait: Gait, cell: Cell) -> str:
    """A cell over 0–100 % of the cycles of each side: every cycle lightly, their mean with its band.

    The midline is shown over the cycles of the right foot, or of the left if the right has no cycle.

    Args:
        times_s: (T,) times of the frames, s.
        gait: The gait cycles of both sides.
        cell: The curves to draw.
    """
    percent = np.linspace(0.0, 100.0, POINTS)
    thin, bold, marks = [], [], []
    for side, curve in cell.curves.items():
        cycles = gait.of(SIDES.index(side)) if side else gait.of(0) or gait.of(1)
        if not cycles:
            continue
        each = np.array([over_cycle(times_s, curve.values, cycle) for cycle in cycles])
        wide, inner = (cycle_sd(times_s, sd, cycles) for sd in (curve.sd, curve.inner_sd))
        if len(cycles) > 1:
            some = spread_indices(len(cycles), MOST_SINGLE)
            thin += [Line(percent, one, None, side, thin=True) for one in each[some]]
        bold.append(Line(percent, each.mean(axis=0), wide, side, inner_sd=inner))
        if side:
            marks.append(Mark(float(np.mean([cycle.off_percent for cycle in cycles])), side))
    note, lines = _positive(cell), [*thin, *bold]
    return chart(
        cell.title, cell.unit, lines, (0.0, 100.0), "%", marks=marks, note=note, caption=cell.caption
    )


def is_long(r: Reconstruction) -> bool:
    """True if curves against time are drawn as wide as the page."""
    return float(np.ptp(r.times_s)) > LONG_S


def _key(r: Reconstruction, gait: Gait | None) -> str:
    entries = [("swatch r", "right"), ("swatch l", "left"), *band_key(offsets_known(r))]
    if gait is not None:
        counts = " and ".join(f"{_some(len(gait.of(i)))} {SIDE_NAMES[side]}" for i, side in enumerate(SIDES))
        if len(gait.cycles) > 2:
            entries.append(("swatch thin", f"single cycles ({counts}), their mean in bold"))
        entries.append(("swatch off", "toe-off"))
    return key(*entries)


def _some(count: int) -> str:
    return str(count) if count <= MOST_SINGLE else f"{MOST_SINGLE} of {count}"


def _unobserved(r: Reconstruction) -> str:
    if not r.unobserved_dofs:
        return ""
    segments = sorted({name.rpartition("_")[0].replace("_", " ") for name in r.unobserved_dofs})
    return paragraph(f"Not shown, because neither markers nor sensors observe them: {', '.join(segments)}.")
