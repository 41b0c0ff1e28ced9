"""The report's contacts: each part that bore load with its times and peak, and the forces on parts besides the feet."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from mbkf.io.contacts import ContactInterval, bearing
from mbkf.io.results import Reconstruction
from mbkf.trial.gait.facing import facing
from mbkf.trial.verdict.judge import verdict_of
from mbkf.viz.markup import folded, key, paragraph, section, table
from mbkf.viz.report.cells import Cell, force_cells
from mbkf.viz.report.motion import charts, is_long, time_chart
from mbkf.viz.report.spreads import Curve, band_key
from mbkf.viz.svg import Bar, bar_chart, number
from mbkf.viz.wording import part_wording

MOST_ROWS = 24
"""A longer table is folded."""

HOW = {
    "measured": "measured by a plate of its own",
    "shared": "share of a plate under both feet, by their places",
    "estimated": "estimated from the motion",
}


def contact_section(r: Reconstruction) -> str:
    """The chart and the table of contacts, and the forces on parts besides the feet."""
    contacts = r.contacts
    if not contacts:
        return section("contacts", "Contacts", paragraph("No load on the body is known."), *_unexplained(r))
    heads = ("", "from, s", "to, s", "peak, N", "± 2 standard deviations, N", "")
    rows = table(heads, [_row(one) for one in contacts], "contacts")
    return section(
        "contacts",
        "Contacts",
        key(*((how, text) for how, text in HOW.items() if any(one.how == how for one in contacts))),
        contact_chart(r, contacts),
        folded(f"All {len(contacts)} contacts", rows) if len(contacts) > MOST_ROWS else rows,
        *_unexplained(r),
        *_forces(r),
    )


def contact_chart(r: Reconstruction, contacts: Sequence[ContactInterval]) -> str:
    """Bars over time, a row for each part that ever bore load; their style shows the source of the load."""
    parts = [name for name in r.loads.names if any(one.part == name for one in contacts)]
    bars = [
        Bar(parts.index(one.part), one.from_s, one.to_s, f"{part_wording(one.part).side or 'm'} {one.how}")
        for one in contacts
    ]
    span = (float(r.times_s[0]), float(max(r.times_s[-1], r.times_s[0] + 1e-3)))
    return bar_chart(
        "Contacts of each part over time",
        [part_wording(name).full_title.lower() for name in parts],
        bars,
        span,
    )


def support_cells(r: Reconstruction) -> list[list[Cell]]:
    """Charts of the forces on parts besides the feet that ever bear load, one row for each kind of part."""
    axes, bears = facing(r), bearing(r.support_wrench)
    kinds: dict[str, dict[str, Curve]] = {}
    for k, name in enumerate(r.support_names):
        if bears[:, k].any():
            words = part_wording(name)
            sd = np.where(bears[:, [k]], r.support_wrench_sd[:, k, :3], np.nan)
            kinds.setdefault(words.title, {})[words.side] = Curve(r.support_wrench[:, k, :3], sd)
    return [force_cells(axes, forces, 1.0, "N", title) for title, forces in kinds.items()]


def _forces(r: Reconstruction) -> list[str]:
    cells = support_cells(r)
    if not cells:
        return []
    there = {side for row in cells for cell in row for side in cell.curves}
    sides = (("r", "right"), ("l", "left"), ("", "middle"))
    entries = [(f"swatch {side or 'm'}", word) for side, word in sides if side in there]
    return [
        "<h3>Forces on parts besides the feet, against time</h3>",
        key(*entries, *band_key(False)),
        charts(cells, partial(time_chart, r.times_s), is_long(r)),
    ]


def _unexplained(r: Reconstruction) -> list[str]:
    """The table of forces that no contact explains."""
    if not r.unexplained:
        return []
    remedies = {one.do for one in verdict_of(r).reasons}  # stated above
    heads = ("direction", "from, s", "to, s", "mean, N", "± 2 standard deviations, N", "% of body weight", "")
    rows = [
        (
            one.direction,
            number(one.from_s, 2),
            number(one.to_s, 2),
            number(one.force_n, 0),
            number(2.0 * one.sd_n, 0),
            number(100.0 * one.share, 0),
            "" if one.hint in remedies else one.hint,
        )
        for one in r.unexplained
    ]
    return ["<h3>Forces that no contact explains</h3>", table(heads, rows, "unexplained")]


def _row(one: ContactInterval) -> tuple[str, ...]:
    return (
        part_wording(one.part).full_title,
        number(one.from_s, 2),
        number(one.to_s, 2),
        number(one.peak_n, 0),
        number(2.0 * one.sd_n, 0) if np.isfinite(one.sd_n) else "–",
        HOW[one.how],
    )
