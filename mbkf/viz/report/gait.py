"""The report's spatiotemporal parameters, right against left, and the stance of each foot over time."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.trial.gait.cycles import Gait, GaitParameter
from mbkf.trial.gait.events import FootEvents
from mbkf.viz.markup import paragraph, section, table
from mbkf.viz.svg import Bar, bar_chart, number
from mbkf.viz.wording import SIDE_NAMES

NO_GAIT = (
    "No gait cycle was found: a cycle needs two strikes of a foot, with its toe-off and the other foot's strike in "
    "between."
)

DIGITS = {"steps/min": 1, "m/s": 2, "m": 3, "s": 3, "%": 1}


def gait_section(gait: Gait | None, times_s: Array) -> str:
    """Stance phases and the table, or a sentence without gait."""
    if gait is None:
        return section("gait", "Gait", paragraph(NO_GAIT))
    rows = [_row(parameter) for parameter in gait.parameters]
    ground = f"On a treadmill at {gait.belt_m_s:.2f} m/s. " if gait.belt_m_s else ""
    counts = ", ".join(f"{len(gait.of(side))} {name}" for side, name in ((0, "right"), (1, "left")))
    note = (
        f"{ground}Whole cycles: {counts}. Mean ± standard deviation between cycles. Strikes and toe-offs come from the "
        "feet's loads if these are known, else from their motion. A step belongs to the foot that ends it."
    )
    heads = ("", "right", "left", "difference")
    return section("gait", "Gait", paragraph(note), stance_chart(gait, times_s), table(heads, rows))


def stance_chart(gait: Gait, times_s: Array) -> str:
    """Stance of each foot as bars over time; a stance that the trial cuts off is pale."""
    first, last = float(times_s[0]), float(max(times_s[-1], times_s[0] + 1e-3))
    bars = [
        Bar(row, start, end, side if whole else f"{side} cut")
        for row, (side, events) in enumerate(zip(SIDES, gait.events, strict=True))
        for start, end, whole in _stances(events, first, last)
    ]
    names = [f"{SIDE_NAMES[side]} foot" for side in SIDES]
    return bar_chart("Stance of each foot over time", names, bars, (first, last))


def _stances(events: FootEvents, first: float, last: float) -> list[tuple[float, float, bool]]:
    """Start, end, and True if both lie in the trial."""
    found = []
    for strike in events.strikes_s:
        after = events.offs_s[events.offs_s > strike]
        found.append((float(strike), float(after[0]) if len(after) else last, bool(len(after))))
    if len(events.offs_s) and not (events.strikes_s < events.offs_s[0]).any():
        found.insert(0, (first, float(events.offs_s[0]), False))
    return found


def _row(parameter: GaitParameter) -> tuple[str, str, str, str]:
    digits = DIGITS[parameter.unit]
    right, left = parameter.values
    return (
        f"{parameter.name}, {parameter.unit}",
        _mean(right, digits),
        _mean(left, digits),
        _difference(right, left),
    )


def _mean(values: Array, digits: int) -> str:
    known = values[np.isfinite(values)]
    if not len(known):
        return "–"
    spread = f" ± {number(float(known.std(ddof=1)), digits)}" if len(known) > 1 else ""
    return number(float(known.mean()), digits) + spread


def _difference(right: Array, left: Array) -> str:
    """Right minus left over their mean."""
    right, left = right[np.isfinite(right)], left[np.isfinite(left)]
    if not len(right) or not len(left):
        return "–"
    middle = 0.5 * (right.mean() + left.mean())
    return f"{number(100.0 * float(right.mean() - left.mean()) / middle, 1)} %" if middle else "–"
