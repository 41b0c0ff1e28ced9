"""Rows of the cells: NEES by quantity, and coverage of every clinical angle and torque."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from benchmarks.checks import Check, information, within
from benchmarks.intervals.trials import QUANTITIES, Judged

MEAN_NEES, CELL_NEES = (0.8, 1.25), (0.6, 1.6)
COVER_PERCENT = (90.0, 98.0)


def cell_rows(found: Sequence[Judged]) -> list[Check]:
    """NEES of each cell over its persons, their mean by quantity, and coverage by angle and torque over all cells."""
    cells: dict[tuple[bool, str, float, str], list[Judged]] = defaultdict(list)
    for one in found:
        cells[one.smoothed, one.key.motion, one.key.skin_m, one.key.body].append(one)
    rows: list[Check] = []
    for smoothed in sorted({one.smoothed for one in found}):
        label = "smoothed" if smoothed else "causal"
        mine = {cell: ones for cell, ones in cells.items() if cell[0] == smoothed}
        means = {cell: np.nanmean([one.nees for one in ones], axis=0) for cell, ones in mine.items()}
        for k, quantity in enumerate(QUANTITIES):
            rows += within(
                f"{label}, NEES of {quantity}, mean",
                float(np.mean([m[k] for m in means.values()])),
                *MEAN_NEES,
            )
            for (_, motion, skin_m, body), mean in means.items():
                name = f"{label}, NEES of {quantity}: {motion}, skin {1e3 * skin_m:.0f} mm, {body}"
                rows += within(name, float(mean[k]), *CELL_NEES)
        rows += _cover_rows(label, [one for ones in mine.values() for one in ones])
        for (_, motion, skin_m, body), ones in mine.items():
            rms = float(np.sqrt(np.mean([one.angle_rms_deg**2 for one in ones])))
            name = f"{label}, RMS error of angles: {motion}, skin {1e3 * skin_m:.0f} mm, {body}"
            rows.append(information(name, rms, "deg"))
    return rows


def _cover_rows(label: str, found: Sequence[Judged]) -> list[Check]:
    rows: list[Check] = []
    for kind in ("angle", "torque"):
        covers = 100.0 * np.mean([getattr(one, f"{kind}_cover") for one in found], axis=0)
        for name, cover in zip(found[0].names, covers, strict=True):
            rows += within(f"{label}, 95 % interval covers {kind} {name}", float(cover), *COVER_PERCENT, "%")
    return rows
