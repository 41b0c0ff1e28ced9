"""Charts of a session's cycles: every cycle thin, the mean bold with its band, the norm behind; and of two sessions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES
from mbkf.io.norms import Band, Norms
from mbkf.io.session import TrialKind
from mbkf.model.description import BodyDescription
from mbkf.numerics.runs import spread_indices
from mbkf.study.session.chosen import Chosen, chosen_curves
from mbkf.study.session.comparison import CurvePair
from mbkf.study.session.cycles import FORCES, PERCENT, POWER, REACTION, Key, SideCycles
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import Line, Mark, chart
from mbkf.viz.wording import wordings

MOST_SINGLE = 12
"""Of more cycles than this, so many are drawn one by one, evenly chosen; the mean is that of all."""


@dataclass(frozen=True)
class Shown:
    """A quantity as it is titled.

    Attributes:
        key: The quantity.
        title: E.g. "Knee flexion".
        positive: What a positive value means.
    """

    key: Key
    title: str
    positive: str


def joint_rows(
    body: BodyDescription, joints: Sequence[str], quantity: str, terms: Terms
) -> list[list[Shown]]:
    """The coordinates of joints, one row for each.

    Args:
        body: The body.
        joints: Names without sides.
        quantity: "angle" or "torque".
        terms: The report's words.
    """
    known = wordings(body.clinical_joints)
    rows = []
    for joint in joints:
        entry = next((one for one in body.clinical_joints if one.name in (joint, f"{joint}_r")), None)
        if entry is None:
            continue
        row = []
        for angle in entry.angles:
            own, name = known[angle.name], angle.name.removesuffix("_r")
            told = terms.positive(name, own.positive)
            row.append(Shown(Key(quantity, name), terms.coordinate(name, own.title), told))
        rows.append(row)
    return rows


def power_rows(joints: Sequence[str], terms: Terms) -> list[list[Shown]]:
    """The powers of whole joints, three in a row.

    Args:
        joints: Names without sides.
        terms: The report's words.
    """
    shown = [Shown(Key(POWER, joint), terms.joint(joint), "") for joint in joints]
    return [shown[k : k + 3] for k in range(0, len(shown), 3)]


def reaction_rows(terms: Terms) -> list[list[Shown]]:
    """The components of the reactions."""
    return [[Shown(Key(REACTION, name), terms.say(name).capitalize(), "") for name in reversed(FORCES)]]


def session_chart(sides: tuple[SideCycles, SideCycles], shown: Shown, norm: Band | None, terms: Terms) -> str:
    """A quantity over both sides' cycles; an empty text where neither knows it.

    Args:
        sides: Cycles of right and left.
        shown: The quantity.
        norm: The laboratory's reference; None without.
        terms: The report's words.
    """
    thin, bold, marks, unit, estimated = [], [], [], "", False
    for side in sides:
        if shown.key not in side.curves:
            continue
        chosen = chosen_curves(side, shown.key)
        if chosen.mean is None:
            continue
        letter, unit = SIDES[side.side], side.curves[shown.key].unit
        estimated = estimated or chosen.estimated
        thin += _single(chosen, letter)
        band = None if np.isnan(chosen.mean.sd).all() else 0.5 * chosen.mean.sd
        bold.append(Line(PERCENT, chosen.mean.mean, band, letter, dashed=chosen.estimated))
        marks.append(Mark(chosen.off_percent, letter))
    if not bold:
        return ""
    behind = [] if norm is None or norm.unit != unit else [_norm_line(norm)]
    note = f"+ {shown.positive}" if shown.positive else ""
    return chart(
        shown.title, terms.unit(unit), [*behind, *thin, *bold], (0.0, 100.0), "%", marks=marks, note=note
    )


def norm_of(norms: Norms | None, kind: TrialKind, key: Key) -> Band | None:
    """The reference of a curve; None without.

    Args:
        norms: Those of the report.
        kind: Of the movement.
        key: The curve.
    """
    return None if norms is None else norms.curves.get((kind.value, key.quantity, key.name))


def pair_charts(pairs: Mapping[tuple[Key, int], CurvePair], shown: Shown, terms: Terms) -> list[str]:
    """A quantity in two sessions: right, left, and the changes of both with their intervals; nothing where not known.

    Args:
        pairs: The curves of a comparison.
        shown: The quantity.
        terms: The report's words.
    """
    known = {side: pairs[(shown.key, side)] for side in range(2) if (shown.key, side) in pairs}
    if not known:
        return []
    charts = []
    for side in range(2):
        pair = known.get(side)
        charts.append("" if pair is None else _pair_chart(pair, shown, terms))
    unit = next(iter(known.values())).unit
    lines = [
        Line(PERCENT, pair.difference.difference, 0.5 * pair.difference.half_width, SIDES[side])
        for side, pair in known.items()
    ]
    title = f"{shown.title}: {terms.say('change')}"
    charts.append(chart(title, terms.unit(unit), lines, (0.0, 100.0), "%", level=0.0))
    return charts


def _pair_chart(pair: CurvePair, shown: Shown, terms: Terms) -> str:
    lines, marks = [], []
    for chosen, style in ((pair.before, "b"), (pair.after, SIDES[pair.side])):
        assert chosen.mean is not None
        band = None if np.isnan(chosen.mean.sd).all() else 0.5 * chosen.mean.sd
        lines.append(Line(PERCENT, chosen.mean.mean, band, style, dashed=chosen.estimated))
        marks.append(Mark(chosen.off_percent, style))
    title = f"{shown.title}, {terms.say('left' if pair.side else 'right')}"
    return chart(title, terms.unit(pair.unit), lines, (0.0, 100.0), "%", marks=marks)


def _single(chosen: Chosen, letter: str) -> list[Line]:
    """Cycles one by one; estimated ones beside measured ones do not widen the axis."""
    lines = []
    if len(chosen.counted) > 1:
        some = spread_indices(len(chosen.counted), MOST_SINGLE)
        lines = [Line(PERCENT, one, None, letter, thin=True) for one in chosen.counted[some]]
    lines += [
        Line(PERCENT, one, None, letter, thin=True, dashed=True, scales=False)
        for one in chosen.others[:MOST_SINGLE]
    ]
    return lines


def _norm_line(norm: Band) -> Line:
    return Line(PERCENT, norm.mean, 0.5 * norm.sd, "n", thin=True)
