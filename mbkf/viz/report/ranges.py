"""The report's table of least and greatest angles and torques, of the frames in which they are known."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.io.results import Reconstruction
from mbkf.model.human import reference_body
from mbkf.viz.markup import paragraph, table
from mbkf.viz.report.cells import angle_cells, joint_names, torque_cells
from mbkf.viz.report.reading import Reading
from mbkf.viz.report.spreads import Curve, offsets_known
from mbkf.viz.svg import number
from mbkf.viz.wording import SIDE_NAMES

COUNTING = "Moments count in the frames in which all loads on the body are known."


def ranges(r: Reconstruction, read: Reading) -> str:
    """Least and greatest angle and torque of the main angle of each joint of the legs, as a table.

    Angles count in tracked frames, torques in valid ones: beyond these a load that no plate reads, such as of a foot
    that lands as the trial ends, leaves the torques unknown.

    Args:
        r: The results.
        read: Angles and signs.
    """
    rows = []
    loaded = joint_names(reference_body(r.subject)).loaded
    loads = {torque.name: torque.curves for torque, *_ in torque_cells(r, loaded, read)}
    for angle, *_ in angle_cells(r, loaded, read):
        for side, name in SIDE_NAMES.items():
            load = _extremes(loads.get(angle.name, {}).get(side), r.valid & r.tracked, 2)
            rows.append((f"{angle.title}, {name}", *_extremes(angle.curves.get(side), r.tracked, 1), *load))
    if not rows:
        return ""
    kind = "extension moment" if read.convention.reversed_moments else "torque"
    heads = ("", "least angle °", "greatest angle °", f"least {kind} N m/kg", f"greatest {kind} N m/kg")
    shift = "; in brackets, its part that repeats in the same posture" if offsets_known(r) else ""
    return f"<h3>Ranges (± 2 standard deviations{shift})</h3>" + table(heads, rows) + paragraph(COUNTING)


def _extremes(curve: Curve | None, counts: BoolArray, digits: int) -> tuple[str, str]:
    if curve is None or not np.isfinite(curve.values[counts]).any():
        return "–", "–"
    values = np.where(counts, curve.values, np.nan)
    found = []
    for at in (int(np.nanargmin(values)), int(np.nanargmax(values))):
        band = "" if not np.isfinite(curve.sd[at]) else f" ± {number(2 * curve.sd[at], digits)}"
        if band and curve.offset is not None:
            band += f" ({number(2 * curve.offset[at], digits)})"
        found.append(number(float(values[at]), digits) + band)
    return found[0], found[1]
