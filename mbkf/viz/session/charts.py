"""Charts of a session's cycles (single ones thin, the mean bold, the norm behind), and of two sessions' means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES
from mbkf.io.norms import Band, Norms
from mbkf.model.description import BodyDescription
from mbkf.numerics.runs import spread_indices
from mbkf.study.session.chosen import Chosen, chosen_curves
from mbkf.study.session.comparison import CurvePair
from mbkf.study.session.cycles import ANGLE, FORCES, PERCENT, POWER, REACTION, TORQUE, Key, SideCycles
from mbkf.study.session.records import MovementGroup
from mbkf.viz.markup import key
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import HEIGHT, WIDTH, Line, Mark, chart
from mbkf.viz.wording import Wording, wordings

MOST_SINGLE = 12
"""Most cycles that are drawn one by one, evenly chosen; the mean is that of all."""

PER_CENT = (0.0, 100.0)


@dataclass(frozen=True)
class Shown:
    """A quantity with its title, e.g. "Knee flexion", and the meaning of a positive value."""

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
        names = [angle.name for angle in entry.angles]
        rows.append([_shown(quantity, known[name], name.removesuffix("_r"), terms) for name in names])
    return rows


def _shown(quantity: str, own: Wording, name: str, terms: Terms) -> Shown:
    if quantity == TORQUE and name in terms.convention.reversed_moments:
        return Shown(Key(quantity, name), terms.moment(name, own.title), "")
    title, positive = terms.coordinate(name, own.title), terms.positive(name, own.positive)
    return Shown(Key(quantity, name), title, positive)


def angle_rows(body: BodyDescription, joints: Sequence[str], terms: Terms) -> list[list[Shown]]:
    """The angles of the legs in the order of the convention, or of the body where that has no own one.

    Args:
        body: The body.
        joints: Names of its joints without sides.
        terms: The report's words.
    """
    if not terms.convention.rows:
        return joint_rows(body, joints, ANGLE, terms)
    return [
        [Shown(Key(ANGLE, name), terms.coordinate(name, name), terms.positive(name, "")) for name in row]
        for row in terms.convention.rows
    ]


def power_rows(joints: Sequence[str], terms: Terms) -> list[list[Shown]]:
    """The powers of whole joints, named without their sides, three in a row."""
    shown = [Shown(Key(POWER, joint), terms.joint(joint), "") for joint in joints]
    return [shown[k : k + 3] for k in range(0, len(shown), 3)]


def reaction_rows(terms: Terms) -> list[list[Shown]]:
    """The components of the reactions."""
    return [[Shown(Key(REACTION, name), terms.say(name).capitalize(), "") for name in reversed(FORCES)]]


def session_chart(
    sides: tuple[SideCycles, SideCycles],
    shown: Shown,
    norm: Band | None,
    terms: Terms,
    size: tuple[float, float] = (WIDTH, HEIGHT),
) -> str:
    """A quantity over both sides' cycles; an empty text if neither side has it.

    Args:
        sides: Cycles of right and left.
        shown: The quantity.
        norm: The laboratory's reference; None without.
        terms: The report's words.
        size: Width and height of the drawing.
    """
    thin, bold, marks, unit = [], [], [], ""
    for side in sides:
        chosen = chosen_curves(side, shown.key) if shown.key in side.curves else None
        if chosen is None or chosen.mean is None:
            continue
        letter, unit = SIDES[side.side], side.curves[shown.key].unit
        thin += _single(chosen, letter)
        bold.append(_mean_line(chosen, letter))
        marks.append(Mark(chosen.off_percent, letter))
    if not bold:
        return ""
    if norm is not None and norm.unit == unit:
        thin.insert(0, Line(PERCENT, norm.mean, 0.5 * norm.sd, "n", thin=True))
    note = f"+ {shown.positive}" if shown.positive else ""
    caption = _caption(shown, terms)
    return chart(
        shown.title,
        terms.unit(unit),
        [*thin, *bold],
        PER_CENT,
        "%",
        marks=marks,
        note=note,
        caption=caption,
        width=size[0],
        height=size[1],
    )


def legend(gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
    """The meaning of lines and bands in charts of a gait.

    Args:
        gait: The gait.
        norms: Those that its charts show; None without.
        terms: The report's words.
    """
    cycles = [cycle for side in gait.sides for cycle in side.cycles]
    entries = [("swatch r", terms.say("right")), ("swatch l", terms.say("left"))]
    entries += [("swatch band", terms.say("mean_band")), ("swatch thin", terms.say("single"))]
    mixed = any(c.measured for c in cycles) and any(c.valid and not c.measured for c in cycles)
    if mixed:
        entries.append(("swatch thin dashed", terms.say("estimated_single")))
    if any(
        side.cycles and not any(c.measured for c in side.cycles) and any(c.valid for c in side.cycles)
        for side in gait.sides
    ):
        entries.append(("swatch dashed m", terms.say("estimated_mean")))
    entries.append(("swatch off", terms.say("toe_off")))
    if norms is not None and any(kind == gait.kind.value for kind, *_ in norms.curves):
        persons = max(band.persons for (kind, *_), band in norms.curves.items() if kind == gait.kind.value)
        entries.append(("swatch norm", terms.say("norm_band", norms.name, persons)))
    return key(*entries)


def _caption(shown: Shown, terms: Terms) -> str:
    """The convention on charts of angles and torques; others have it from neither."""
    return {ANGLE: terms.statement, TORQUE: terms.moment_statement}.get(shown.key.quantity, "")


def pair_charts(pairs: Mapping[tuple[Key, int], CurvePair], shown: Shown, terms: Terms) -> list[str]:
    """A quantity in two sessions: right, left, and the changes of both with their intervals; empty if unknown.

    Args:
        pairs: The curves of a comparison.
        shown: The quantity.
        terms: The report's words.
    """
    known = {side: pairs[(shown.key, side)] for side in range(2) if (shown.key, side) in pairs}
    if not known:
        return []
    charts = [_pair_chart(known[side], shown, terms) if side in known else "" for side in range(2)]
    lines = [
        Line(PERCENT, pair.difference.difference, 0.5 * pair.difference.half_width, SIDES[side])
        for side, pair in known.items()
    ]
    title, unit = f"{shown.title}: {terms.say('change')}", next(iter(known.values())).unit
    return [
        *charts,
        chart(title, terms.unit(unit), lines, PER_CENT, "%", level=0.0, caption=_caption(shown, terms)),
    ]


def _pair_chart(pair: CurvePair, shown: Shown, terms: Terms) -> str:
    both = ((pair.before, "b"), (pair.after, SIDES[pair.side]))
    lines = [_mean_line(chosen, style) for chosen, style in both]
    marks = [Mark(chosen.off_percent, style) for chosen, style in both]
    title = f"{shown.title}, {terms.say('left' if pair.side else 'right')}"
    return chart(
        title, terms.unit(pair.unit), lines, PER_CENT, "%", marks=marks, caption=_caption(shown, terms)
    )


def _mean_line(chosen: Chosen, style: str) -> Line:
    """The mean of the chosen cycles with a band of one standard deviation."""
    assert chosen.mean is not None
    band = None if np.isnan(chosen.mean.sd).all() else 0.5 * chosen.mean.sd
    return Line(PERCENT, chosen.mean.mean, band, style, dashed=chosen.estimated)


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
