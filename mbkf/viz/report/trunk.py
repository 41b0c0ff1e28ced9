"""The report's section on the trunk: net moments at levels of the spine, top-down and bottom-up."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.dimensions import AXES
from mbkf.io.results import Reconstruction
from mbkf.viz.markup import folded, key, paragraph, section, table
from mbkf.viz.report.cells import Cell
from mbkf.viz.report.motion import charts, is_long, time_chart
from mbkf.viz.report.spreads import Curve
from mbkf.viz.svg import number
from mbkf.viz.wording import TRUNK_POSITIVE

WAYS = {"top_down": "r", "bottom_up": "l"}
"""Colour by way."""

NOTE = (
    "Net moment of the part of the body below the level on the part above it, about the axes of the trunk's angles. "
    "Top-down it follows from the motion of trunk, head and arms and the loads on them; bottom-up from the measured "
    "reactions on the feet and the motion of legs and pelvis. A load in the hands that is not found makes the first "
    "wrong, not the second. Both have the same motion, so that errors of markers may move both."
)


def trunk_section(r: Reconstruction) -> str:
    """Moments at the levels of the spine; empty for a body without levels and where no moment is known."""
    if r.trunk_moments is None or not np.isfinite(r.trunk_moments).any():
        return ""
    legend = key(
        ("swatch r", "top-down"), ("swatch l", "bottom-up"), ("swatch band", "± 2 standard deviations")
    )
    *others, lowest = r.level_names
    parts = [paragraph(NOTE), legend, _drawn(r, lowest)]
    parts += [folded(f"The same at {level}", _drawn(r, level)) for level in reversed(others)]
    return section("trunk", "Trunk moments at levels of the spine", *parts, _differences(r))


def _drawn(r: Reconstruction, level: str) -> str:
    cells, per_kg = [], 1.0 / r.subject.mass_kg
    for turn in AXES["turn"].labels:
        curves = {
            side: Curve(*(per_kg * read(level, turn, way) for read in (r.trunk_moment, r.trunk_moment_sd)))
            for way, side in WAYS.items()
        }
        known = {side: one for side, one in curves.items() if np.isfinite(one.values).any()}
        cells.append(Cell(f"{level} {turn}", "N m/kg", TRUNK_POSITIVE[turn], known))
    return charts([cells], lambda cell: time_chart(r.times_s, cell), is_long(r))


def _differences(r: Reconstruction) -> str:
    """Peaks of extension and difference of the ways by level."""
    rows = []
    for level in reversed(r.level_names):
        down, up = (r.trunk_moment(level, way=way)[r.tracked] / r.subject.mass_kg for way in WAYS)
        both = np.isfinite(down) & np.isfinite(up)
        apart = number(float(np.sqrt(np.mean((down - up)[both] ** 2))), 2) if both.any() else "–"
        rows.append((level, *(_peak(one) for one in (down, up)), apart))
    heads = ("extension, N m/kg", "largest, top-down", "largest, bottom-up", "difference, RMS")
    return table(heads, rows)


def _peak(values: Array) -> str:
    known = values[np.isfinite(values)]
    return number(float(known[np.argmax(np.abs(known))]), 2) if known.size else "–"
