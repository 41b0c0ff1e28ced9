"""Tables of a session's report: its trials, and measures of right and left with their difference and the norm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

import numpy as np

from mbkf.io.norms import Norms
from mbkf.io.session import TrialKind
from mbkf.study.session.comparison import MeasurePair, measure_mean
from mbkf.study.session.means import Mean, difference_of, paired_difference
from mbkf.study.session.records import Measure, Session
from mbkf.viz.markup import folded, table
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import number

DIGITS = {
    "steps/min": 1,
    "m/s": 2,
    "m": 3,
    "s": 3,
    "%": 1,
    "cm": 1,
    "W/kg": 1,
    "BW": 2,
    "deg": 1,
    "N m/kg": 2,
}


def trials_table(session: Session, terms: Terms) -> str:
    """A row for each trial, and below it what checks remarked."""
    cycles = {
        name: [
            sum(c.trial == name and (c.measured or not only) for c in side.cycles)
            for only in (False, True)
            for side in gait.sides
        ]
        for gait in session.gaits
        for name in gait.trials
    }
    rows = []
    for trial in session.trials:
        right, left, right_measured, left_measured = cycles.get(trial.name, [0, 0, 0, 0])
        counted = trial.name in cycles
        rows.append(
            (
                trial.name,
                terms.say(trial.kind.value),
                number(trial.seconds, 1),
                f"{right} + {left}" if counted else "–",
                f"{right_measured} + {left_measured}" if counted else "–",
                terms.say(trial.verdict),
                str(len(trial.remarks)) if trial.remarks else "–",
            )
        )
    heads = [
        terms.say(one)
        for one in ("trial", "kind", "length", "cycles", "measured_cycles", "quality", "remarks")
    ]
    remarks = [
        f"<h4>{escape(trial.name)}</h4><ul>"
        + "".join(f"<li>{escape(r)}</li>" for r in trial.remarks)
        + "</ul>"
        for trial in session.trials
        if trial.remarks
    ]
    told = f'<div class="on-screen">{folded(terms.say("remarks"), *remarks)}</div>' if remarks else ""
    return table(heads, rows, "trials") + told


def measures_table(
    measures: Sequence[Measure], terms: Terms, norms: Norms | None = None, kind: TrialKind | None = None
) -> str:
    """Right, left, their difference with its interval, and the norm; measures of the whole body in a table before.

    Args:
        measures: They.
        terms: The report's words.
        norms: The laboratory's own; None without.
        kind: The movement, for the norms.
    """
    whole = [one for one in measures if "" in one.values]
    if whole and len(whole) < len(measures):
        sided_ones = [one for one in measures if "" not in one.values]
        return "".join(measures_table(some, terms, norms, kind) for some in (whole, sided_ones))
    sided = not whole
    heads = [
        "",
        *(terms.say(one) for one in (("right", "left", "difference", "symmetry") if sided else ("both",))),
    ]
    known = {} if norms is None or kind is None else norms.measures
    with_norm = any((kind.value, one.name) in known for one in measures) if kind else False
    rows = []
    for one in measures:
        digits = DIGITS.get(one.unit, 2)
        row = [f"{terms.measure(one.name)}, {terms.unit(one.unit)}"]
        if "r" in one.values or "l" in one.values:
            right, left = measure_mean(one, "r"), measure_mean(one, "l")
            row += [_told(right, digits), _told(left, digits), *_apart(one, right, left, digits)]
        else:
            row.append(_told(measure_mean(one, ""), digits))
        if with_norm and kind is not None:
            band = known.get((kind.value, one.name))
            row.append(
                "–" if band is None else f"{number(band.mean[0], digits)} ± {number(band.sd[0], digits)}"
            )
        rows.append(row)
    return table([*heads, *([terms.say("norm")] if with_norm else [])], rows)


def changes_table(pairs: Sequence[MeasurePair], terms: Terms) -> str:
    """Measures before and after, and the change with its interval; one that does not hold 0 is bold.

    Args:
        pairs: Measures of both sessions.
        terms: The report's words.
    """
    sides: dict[str, Callable[[], str]] = {"r": lambda: terms.say("right"), "l": lambda: terms.say("left")}
    body = []
    for one in pairs:
        digits = DIGITS.get(one.unit, 2)
        apart, half = float(one.difference.difference[0]), float(one.difference.half_width[0])
        side = f", {sides[one.side]()}" if one.side else ""
        told = (
            f"{number(apart, digits)} ± {number(half, digits)}"
            if np.isfinite(half)
            else number(apart, digits)
        )
        if np.isfinite(half) and abs(apart) > half:
            told = f"<b>{told}</b>"
        cells = (
            escape(f"{terms.measure(one.name)}{side}, {terms.unit(one.unit)}"),
            _told(one.before, digits),
            _told(one.after, digits),
            told,
        )
        body.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    heads = "".join(
        f"<th>{escape(h)}</th>" for h in ("", *(terms.say(w) for w in ("before", "after", "change")))
    )
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{''.join(body)}</tbody></table>"


def _told(mean: Mean | None, digits: int) -> str:
    if mean is None:
        return "–"
    spread = "" if np.isnan(mean.sd[0]) else f" ± {number(float(mean.sd[0]), digits)}"
    return number(float(mean.mean[0]), digits) + spread


def _apart(measure: Measure, right: Mean | None, left: Mean | None, digits: int) -> tuple[str, str]:
    """Right less left with half of its interval, and in per cent of their mean; trials are compared one by one."""
    if right is None or left is None:
        return "–", "–"
    sides = [(measure.values[side], measure.trials[side]) for side in "rl"]
    apart = paired_difference(*sides[0], *sides[1]) or difference_of(right, left, same_body=True)
    value, half = float(apart.difference[0]), float(apart.half_width[0])
    middle = 0.5 * float(right.mean[0] + left.mean[0])
    told = f"{number(value, digits)} ± {number(half, digits)}" if np.isfinite(half) else number(value, digits)
    return told, f"{number(100.0 * value / middle, 1)} %" if middle else "–"
