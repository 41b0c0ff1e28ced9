"""Tables of a session's report: its trials, and measures of right and left with their difference and the norm."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from mbkf.io.norms import Norms
from mbkf.io.session import TrialKind
from mbkf.study.session.comparison import MeasurePair, measure_mean
from mbkf.study.session.means import Mean, difference_of, paired_difference
from mbkf.study.session.records import Measure, Session
from mbkf.viz.markup import Html, folded, kept, paragraph, table
from mbkf.viz.sentences import said
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import number

DIGITS = {
    **{"m": 3, "s": 3, "m/s": 2, "BW": 2, "N m/kg": 2},
    **dict.fromkeys(("steps/min", "%", "cm", "W/kg", "deg"), 1),
}


def trials_table(session: Session, terms: Terms) -> str:
    """A row for each trial, and the remarks of checks below."""
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
                Html(f"<span translate='no'>{escape(trial.name)}</span>"),
                terms.say(trial.kind.value),
                number(trial.seconds, 1),
                f"{right} + {left}" if counted else "–",
                f"{right_measured} + {left_measured}" if counted else "–",
                terms.say(trial.verdict.replace(" ", "_")),
                str(len(trial.remarks)) if trial.remarks else "–",
            )
        )
    heads = ("trial", "kind", "length", "cycles", "measured_cycles", "verdict", "remarks")
    remarks = [
        f"<h4 translate='no'>{escape(', '.join(names))}</h4><ul>{''.join(f'<li>{escape(r)}</li>' for r in texts)}</ul>"
        for names, texts in _remarks(session).items()
    ]
    below = f'<div class="remarks">{folded(terms.say("remarks"), *remarks)}</div>' if remarks else ""
    out = [
        kept(terms.say("left_out", trial.name, said(trial.left_out, terms.language)))
        for trial in session.trials
        if trial.left_out
    ]
    against = [
        paragraph(f"{terms.say(one.word.replace(' ', '_'))}: {one.sentence}") for one in session.disagreements
    ]
    return "".join(against) + table([terms.say(one) for one in heads], rows, "trials") + "".join(out) + below


def _remarks(session: Session) -> dict[tuple[str, ...], list[str]]:
    """Remarks by the names of the trials that they concern; each stands once."""
    concerned: dict[str, list[str]] = {}
    for trial in session.trials:
        for remark in trial.remarks:
            concerned.setdefault(remark, []).append(trial.name)
    found: dict[tuple[str, ...], list[str]] = {}
    for remark, names in concerned.items():
        found.setdefault(tuple(names), []).append(remark)
    return found


def measures_table(
    measures: Sequence[Measure], terms: Terms, norms: Norms | None = None, kind: TrialKind | None = None
) -> str:
    """Right, left, their difference with its interval, and the norm; first a table of measures of the whole body.

    Args:
        measures: The measures.
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
            row += [mean_text(right, digits), mean_text(left, digits), *_apart(one, right, left, digits)]
        else:
            row.append(mean_text(measure_mean(one, ""), digits))
        if with_norm and kind is not None:
            band = known.get((kind.value, one.name))
            row.append(
                "–" if band is None else f"{number(band.mean[0], digits)} ± {number(band.sd[0], digits)}"
            )
        rows.append(row)
    return table([*heads, *([terms.say("norm")] if with_norm else [])], rows)


def changes_table(pairs: Sequence[MeasurePair], terms: Terms, headings: tuple[str, str] | None = None) -> str:
    """Measures before and after, and the change with its interval, bold where that excludes 0.

    Args:
        pairs: The measures.
        terms: The report's words.
        headings: Of both columns; None: "before" and "after".
    """
    old, new = headings or (terms.say("before"), terms.say("after"))
    sides = {"r": f", {terms.say('right')}", "l": f", {terms.say('left')}", "": ""}
    rows = []
    for one in pairs:
        digits = DIGITS.get(one.unit, 2)
        apart, half = float(one.difference.difference[0]), float(one.difference.half_width[0])
        change = _with_half(apart, half, digits)
        rows.append(
            (
                f"{terms.measure(one.name)}{sides[one.side]}, {terms.unit(one.unit)}",
                mean_text(one.before, digits),
                mean_text(one.after, digits),
                Html(f"<b>{change}</b>") if np.isfinite(half) and abs(apart) > half else change,
            )
        )
    return table(["", old, new, terms.say("change")], rows)


def _with_half(value: float, half: float, digits: int) -> str:
    """A difference with half of its interval, if that is known."""
    return number(value, digits) + (f" ± {number(half, digits)}" if np.isfinite(half) else "")


def mean_text(mean: Mean | None, digits: int) -> str:
    """A mean ± the standard deviation between cycles; a dash where it is not known.

    Args:
        mean: The mean of a measure.
        digits: Decimals.
    """
    if mean is None:
        return "–"
    spread = "" if np.isnan(mean.sd[0]) else f" ± {number(float(mean.sd[0]), digits)}"
    return number(float(mean.mean[0]), digits) + spread


def _apart(measure: Measure, right: Mean | None, left: Mean | None, digits: int) -> tuple[str, str]:
    """Right minus left with half of its interval, and in per cent of their mean; trials are compared one by one."""
    if right is None or left is None:
        return "–", "–"
    sides = [(measure.values[side], measure.trials[side]) for side in "rl"]
    apart = paired_difference(*sides[0], *sides[1]) or difference_of(right, left, same_body=True)
    value, half = float(apart.difference[0]), float(apart.half_width[0])
    middle = 0.5 * float(right.mean[0] + left.mean[0])
    return _with_half(value, half, digits), f"{number(100.0 * value / middle, 1)} %" if middle else "–"
