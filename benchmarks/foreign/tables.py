"""Tables of scores for the terminal: one row a scaling and filter, and one a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from benchmarks.foreign.errors import Judged
from benchmarks.foreign.score import HIP_FLEXION, Score

COLUMNS = (
    "raw °", "offset °", "shift °", "range °", "varying °", "cover", "varying", "ECE", "sd °",
    "hip", "knee", "ankle mm", "N m/kg", "cover", "NEES",
)  # fmt: skip
GROUP_COLUMNS = ("raw °", "varying °", "cover", "varying", "ECE", "sd °")


def score_table(title: str, scores: dict[str, Score]) -> Table:
    """The legs' scores, one row each.

    Args:
        title: Title of the table.
        scores: Scores by name of the row.
    """
    table = _table(title, COLUMNS)
    for name, one in scores.items():
        legs, offsets, centres = one.legs, one.offsets, one.centres_mm
        table.add_row(
            name, f"{legs.raw:.2f}", f"{offsets.size:.1f}", f"{offsets.shift:.1f}", f"{offsets.widest:.1f}",
            f"{legs.varying:.2f}", f"{legs.cover:.2f}", f"{legs.varying_cover:.2f}", f"{one.angles.calibration:.3f}",
            f"{one.angles.sharpness:.2f}", *(f"{centres[joint]:.0f}" for joint in ("hip", "knee", "ankle")),
            f"{one.moment:.3f}", f"{one.moment_cover:.2f}", f"{one.moment_nees:.2f}",
        )  # fmt: skip
    return table


def group_table(title: str, scores: dict[str, Score]) -> Table:
    """Scores of every group of angles.

    Args:
        title: Title of the table.
        scores: Scores by name of the rows.
    """
    table = _table(title, GROUP_COLUMNS)
    for name, score in scores.items():
        for group, one in score.groups.items():
            numbers = (one.raw, one.varying, one.cover, one.varying_cover, one.calibration, one.sharpness)
            table.add_row(f"{name}, {group}", *(f"{number:.2f}" for number in numbers))
    return table


def offset_table(title: str, found: Sequence[Judged]) -> Table:
    """Mean error and varying RMS of hip flexion, one row a motion of a person.

    Args:
        title: Title of the table.
        found: Motions.
    """
    table = _table(title, ("right °", "left °", "varying right °", "left °"))
    for one in found:
        hips = [series for name in HIP_FLEXION for series in one.angles if series.name == name]
        offsets = [f"{series.offset:.1f}" for series in hips]
        table.add_row(f"{one.person}, {one.motion}", *offsets, *(f"{np.nanstd(s.error):.1f}" for s in hips))
    return table


def _table(title: str, columns: Sequence[str]) -> Table:
    table = Table("", title=title, title_justify="left")
    for column in columns:
        table.add_column(column, justify="right")
    return table
