"""The sheet: two printed pages with the head, verdict, parameters, scores and key curves of a session's first gait."""

from __future__ import annotations

from html import escape
from itertools import chain

import numpy as np

from mbkf.io.laboratory import Laboratory
from mbkf.io.norms import Norms
from mbkf.model.human import reference_body
from mbkf.study.session.chosen import chosen_curves
from mbkf.study.session.comparison import measure_mean
from mbkf.study.session.cycles import ANGLE, POWER, REACTION, TORQUE, Key
from mbkf.study.session.means import Mean
from mbkf.study.session.records import MovementGroup, Session
from mbkf.study.session.scores import VARIABLES
from mbkf.viz.markup import Html, paragraph, table
from mbkf.viz.report.cells import joint_names
from mbkf.viz.session.charts import Shown, joint_rows, legend, session_chart
from mbkf.viz.session.letterhead import condition_name, letterhead
from mbkf.viz.session.norms import norms_at_speed, norms_in_report
from mbkf.viz.session.scores import scores_of_sheet
from mbkf.viz.session.tables import DIGITS, mean_text, measures_table
from mbkf.viz.session.terms import Terms
from mbkf.viz.session.warnings import warnings_box
from mbkf.viz.svg import number

PARAMETERS = (
    "Cadence", "Speed", "Stride time", "Step time", "Stride length", "Step length", "Step width", "Stance",
    "Single support", "Double support", "Flight",
)  # fmt: skip
"""Spatiotemporal parameters in the order of gait laboratories; stance ends with foot off."""

KINETICS = (
    Key(TORQUE, "hip_flexion"), Key(TORQUE, "knee_angle"), Key(TORQUE, "ankle_angle"),
    Key(POWER, "hip"), Key(POWER, "knee"), Key(POWER, "ankle"),
    Key(TORQUE, "hip_adduction"), Key(TORQUE, "knee_adduction"), Key(REACTION, "upward"),
)  # fmt: skip
"""Key kinetic charts, three in a row."""

CHART = (230.0, 118.0)
"""Size of a chart on the sheet, so that its letters have 7 points where a third of the page is its width."""

OUTSIDE = 2.0
"""Standard deviations of the norm, beyond which a parameter is bold."""

LINES, LINES_WITHOUT_SCORES = 5, 14
"""Lines for warnings."""


def summary_part(session: Session, norms: Norms | None, laboratory: Laboratory, terms: Terms) -> str:
    """The two pages; one page for a session without gait.

    Args:
        session: The session.
        norms: The laboratory's; None without.
        laboratory: For the head.
        terms: The report's words.
    """
    head = letterhead(session, laboratory, terms)
    gait = next(iter(session.gaits), None)
    if gait is None:
        measures = measures_table([*session.jumps, *session.squats], terms)
        warnings = warnings_box(session, terms, LINES_WITHOUT_SCORES)
        return f'<div class="leaf">{head}{warnings}{measures}{_signature(session, terms)}</div>'
    norms = norms_at_speed(norms, gait)
    shown = norms_in_report(norms, session)
    own = None if shown is None else shown.norms
    scores = scores_of_sheet(gait, own, terms)
    warnings = warnings_box(session, terms, LINES if scores else LINES_WITHOUT_SCORES)
    numbers = f"<div>{_parameters(gait, norms, terms)}</div><div>{_consistency(gait, terms)}</div>"
    first = (head, warnings, _gait_line(session, gait, terms), f'<div class="halves">{numbers}</div>', scores)
    return f'<div class="leaf">{"".join(first)}</div><div class="leaf">{_curves(session, gait, own, terms)}</div>'


def _gait_line(session: Session, gait: MovementGroup, terms: Terms) -> str:
    """The gait of the sheet, with its numbers of trials and cycles."""
    condition = condition_name(gait.condition, terms.language)
    title = ": ".join(text for text in (terms.say(gait.kind.value), condition) if text)
    counts = terms.say("counts", len(gait.trials), *(len(side.cycles) for side in gait.sides))
    others = terms.sheet("other_gaits") if len(session.gaits) > 1 else ""
    line = " ".join(text for text in (counts, others) if text)
    return f'<h3>{escape(title)}</h3><p class="gait-line">{escape(line)}</p>'


def _parameters(gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
    rows, with_norm = [], False
    for name in PARAMETERS:
        one = gait.measure(name)
        if one is None:
            continue
        digits = DIGITS.get(one.unit, 2)
        title = terms.sheet("foot_off") if name == "Stance" else terms.measure(name)
        sides = [measure_mean(one, side) for side in "rl"]
        band = None if norms is None else norms.measures.get((gait.kind.value, name))
        pair = None if band is None else (float(band.mean[0]), float(band.sd[0]))
        with_norm = with_norm or pair is not None
        norm = "–" if pair is None else f"{number(pair[0], digits)} ± {number(pair[1], digits)}"
        cells = [_marked(side, digits, pair) for side in sides]
        rows.append([f"{title}, {terms.unit(one.unit)}", *cells, norm])
    heads = ["", *(terms.say(word) for word in ("right", "left", "norm"))]
    if not with_norm:
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    note = paragraph(terms.sheet("outside")) if with_norm else ""
    return f"<h4>{escape(terms.say('parameters'))}</h4>{table(heads, rows)}{note}"


def _marked(mean: Mean | None, digits: int, norm: tuple[float, float] | None) -> str:
    """Mean ± standard deviation, bold outside of the norm."""
    text = mean_text(mean, digits)
    if mean is None or norm is None or abs(float(mean.mean[0]) - norm[0]) <= OUTSIDE * norm[1]:
        return text
    return Html(f"<b>{escape(text)}</b>")


def _consistency(gait: MovementGroup, terms: Terms) -> str:
    """The spread between cycles of each angle and of the moments."""
    rows = []
    for key in [*(Key(ANGLE, name) for name in VARIABLES), *KINETICS[:3]]:
        spreads = [consistency(gait, key, side) for side in range(2)]
        if all(np.isnan(spread) for spread in spreads):
            continue
        unit = next(side.curves[key].unit for side in gait.sides if key in side.curves)
        digits = 2 if key.quantity == TORQUE else 1
        title = (
            terms.moment(key.name, key.name)
            if key.quantity == TORQUE
            else terms.coordinate(key.name, key.name)
        )
        cells = ["–" if np.isnan(spread) else number(spread, digits) for spread in spreads]
        rows.append([f"{title}, {terms.unit(unit)}", *cells])
    heads = ["", terms.say("right"), terms.say("left")]
    title = f"<h4>{escape(terms.sheet('consistency'))}</h4>"
    if not rows:
        return title + paragraph(terms.sheet("once"))
    return f"{title}{table(heads, rows)}{paragraph(terms.sheet('consistency_note'))}"


def consistency(gait: MovementGroup, key: Key, side: int) -> float:
    """Root mean square over the cycle of the standard deviation between cycles; NaN with fewer than two cycles.

    Args:
        gait: The gait.
        key: The curve.
        side: 0 right, 1 left.
    """
    cycles = gait.sides[side]
    mean = chosen_curves(cycles, key).mean if key in cycles.curves else None
    return float("nan") if mean is None else float(np.sqrt(np.mean(mean.sd**2)))


def _curves(session: Session, gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
    known = {} if norms is None else norms.curves

    def draw(shown: list[Shown]) -> list[str]:
        bands = [known.get((gait.kind.value, one.key.quantity, one.key.name)) for one in shown]
        pairs = zip(shown, bands, strict=True)
        return [session_chart(gait.sides, one, band, terms, CHART) for one, band in pairs]

    angles = [
        Shown(Key(ANGLE, name), terms.coordinate(name, name), terms.positive(name, "")) for name in VARIABLES
    ]
    joints = joint_names(reference_body(session.subject)).loaded
    rows = joint_rows(reference_body(session.subject), joints, TORQUE, terms)
    powers = [Shown(Key(POWER, joint), terms.sheet("power", terms.joint(joint)), "") for joint in joints]
    ground = Shown(Key(REACTION, "upward"), terms.sheet("ground"), "")
    possible = {one.key: one for one in [*chain.from_iterable(rows), *powers, ground]}
    kinetics = [one for one in draw([possible[key] for key in KINETICS if key in possible]) if one]
    charts = [one for one in draw(angles) if one]
    parts = [f"<h3>{escape(terms.say('angles'))}</h3>", legend(gait, norms, terms), _grid(charts)]
    if kinetics:
        parts += [f"<h3>{escape(terms.sheet('kinetics'))}</h3>", _grid(kinetics)]
    else:
        parts.append(paragraph(terms.sheet("no_kinetics")))
    return "".join((*parts, _signature(session, terms)))


def _grid(charts: list[str]) -> str:
    cells = "".join(f"<div>{chart}</div>" for chart in charts)
    return f'<div class="grid g3 rows{-(-len(charts) // 3)}">{cells}</div>'


def _signature(session: Session, terms: Terms) -> str:
    """A line to sign on."""
    names = (("clinician", session.visit.clinician), ("signed_on", ""), ("signature", ""))
    cells = "".join(
        f"<div><span>{escape(text)}</span>{escape(terms.sheet(key))}</div>" for key, text in names
    )
    return f'<div class="signature">{cells}</div>'
