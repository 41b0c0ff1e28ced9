"""One self-contained page about a session: trials, gait of each kind, jumps, squats, and changes since another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

from mbkf.io.norms import Norms
from mbkf.model.human import reference_body
from mbkf.study.scaling.report import used_trials
from mbkf.study.session.comparison import Comparison, by_curve, compare, measure_pairs
from mbkf.study.session.cycles import Key
from mbkf.study.session.emg import PEAK
from mbkf.study.session.norm_selection import speed_of
from mbkf.study.session.records import MovementGroup, Session
from mbkf.version import __version__
from mbkf.viz.language import ENGLISH
from mbkf.viz.markup import folded, grid, key, paragraph, section, table
from mbkf.viz.page import BLUE_RED, document, report_style
from mbkf.viz.report.motion import JointNames, joint_names
from mbkf.viz.session.charts import (
    Shown,
    angle_rows,
    joint_rows,
    pair_charts,
    power_rows,
    reaction_rows,
    session_chart,
)
from mbkf.viz.session.emg import emg_part
from mbkf.viz.session.norms import norm_sentences, norms_in_report
from mbkf.viz.session.scores import scores_part
from mbkf.viz.session.tables import changes_table, measures_table, trials_table
from mbkf.viz.session.terms import Terms


def session_page(
    session: Session,
    before: Session | None = None,
    norms: Norms | None = None,
    language: str = ENGLISH,
    emg_reference: str = PEAK,
    colours: str = BLUE_RED,
) -> str:
    """The report.

    Args:
        session: The session.
        before: An earlier session to compare with; None without.
        norms: The laboratory's reference bands; None without.
        language: Code of the report's language.
        emg_reference: 100 % of electromyograms: "peak" or "mean" of the session's cycles, or the peak of a trial.
        colours: Of right and left, one of :data:`mbkf.viz.page.COLOURS`.

    Raises:
        InvalidInput: The language does not exist.
        UnknownName: The session has no such trial with electromyograms, or the colours do not exist.
    """
    terms = Terms(language, session.convention, session.axes)
    names = joint_names(reference_body(session.subject))
    parts = [("trials", terms.say("trials"), trials_table(session, terms))]
    parts += [
        (
            f"gait-{gait.kind.value}",
            terms.say(gait.kind.value),
            _gait(session, gait, names, norms, terms) + emg_part(session, gait, terms, emg_reference),
        )
        for gait in session.gaits
    ]
    if not (session.gaits or session.jumps or session.squats):
        parts.append(("gait", terms.say("unknown"), paragraph(terms.say("no_gait"))))
    for name, measures in (("jumps", session.jumps), ("squats", session.squats)):
        if measures:
            parts.append((name, terms.say(name), measures_table(measures, terms)))
    if before is not None:
        parts.append(("change", terms.say("before_after"), _changes(before, session, names, terms)))
    parts.append(("numbers", terms.say("numbers"), _numbers(session, terms)))
    body = _heading(session, terms) + "".join(section(name, title, text) for name, title, text in parts)
    style = report_style(colours, "report.css", "session_report.css")
    links = [(name, title) for name, title, _ in parts]
    return document(language, f"{session.name} · {terms.say('title')}", style, links, body)


def _heading(session: Session, terms: Terms) -> str:
    subject = session.subject
    facts = [terms.say("kilograms", f"{subject.mass_kg:.1f}")]
    if subject.height_m:
        facts.append(terms.say("metres", f"{subject.height_m:.2f}"))
    if session.sex:
        facts.append(terms.say(session.sex))
    if session.age is not None:
        facts.append(terms.say("years", f"{session.age:g}"))
    line = " · ".join(escape(fact) for fact in (terms.say("title"), *facts))
    return f"<h1 translate='no'>{escape(session.name)}</h1><p class='facts'>{line}</p>"


def _gait(session: Session, gait: MovementGroup, names: JointNames, norms: Norms | None, terms: Terms) -> str:
    """The section of one kind of gait."""
    body = reference_body(session.subject)
    norms = None if norms is None else norms.at_speed(speed_of(gait))
    counts = [len(side.cycles) for side in gait.sides]

    shown = norms_in_report(norms, session)
    alike = None if shown is None else shown.norms
    known = {} if alike is None else alike.curves

    def draw(rows: list[list[Shown]]) -> str:
        def one_chart(one: Shown) -> str:
            band = known.get((gait.kind.value, one.key.quantity, one.key.name))
            return session_chart(gait.sides, one, band, terms)

        return _charts(rows, one_chart, terms)

    def coordinates(quantity: str, joints: Sequence[str]) -> str:
        return draw(joint_rows(body, joints, quantity, terms))

    upper = [
        folded(f"{terms.say('upper')}: {terms.say(title).lower()}", coordinates(kind, names.upper))
        for title, kind in (("angles", "angle"), ("torques", "torque"))
        if names.upper
    ]
    joints = [joint for joint in names.loaded if any(Key("power", joint) in s.curves for s in gait.sides)]
    return "".join(
        (
            paragraph(terms.say("counts", len(gait.trials), *counts)),
            f"<h3>{escape(terms.say('parameters'))}</h3>",
            measures_table(gait.measures, terms, norms, gait.kind),
            paragraph(terms.say("table_note")),
            scores_part(gait, alike, terms),
            f'<h3 class="sheet">{escape(terms.say("angles"))}</h3>',
            _key(gait, alike, terms),
            *(paragraph(one) for one in (*terms.convention_notes, *norm_sentences(norms, shown, terms))),
            paragraph(terms.say("midline_note")),
            draw(angle_rows(body, names.legs, terms)),
            f'<h3 class="sheet">{escape(terms.say("torques"))}</h3>',
            paragraph(terms.moment_note),
            coordinates("torque", names.loaded),
            f"<h3>{escape(terms.say('powers'))}</h3>",
            paragraph(terms.say("power_note")),
            draw(power_rows(joints, terms)),
            f"<h3>{escape(terms.say('reactions'))}</h3>",
            paragraph(terms.say("reaction_note")),
            draw(reaction_rows(terms)),
            f'<div class="sheet">{"".join(upper)}</div>' if upper else "",
        )
    )


def _changes(before: Session, after: Session, names: JointNames, terms: Terms) -> str:
    """The section that compares two sessions."""
    found = [_change(one, after, names, terms) for one in compare(before, after)]
    others = [
        f"<h3>{escape(terms.say(name))}</h3>" + changes_table(measure_pairs(old, new), terms)
        for name, old, new in (
            ("jumps", before.jumps, after.jumps),
            ("squats", before.squats, after.squats),
        )
        if old and new
    ]
    return "".join([paragraph(terms.say("compared", before.name, after.name)), *found, *others])


def _change(comparison: Comparison, after: Session, names: JointNames, terms: Terms) -> str:
    body, pairs = reference_body(after.subject), by_curve(comparison)
    joints = [joint for joint in names.loaded if any(Key("power", joint) == k for k, _ in pairs)]
    parts = [
        f"<h3>{escape(terms.say(comparison.kind.value))}</h3>",
        paragraph(terms.say("same_body" if comparison.same_body else "other_body")),
        changes_table(comparison.measures, terms),
        key(
            ("swatch b", terms.say("before")),
            ("swatch r", f"{terms.say('after')}, {terms.say('right')}"),
            ("swatch l", f"{terms.say('after')}, {terms.say('left')}"),
            ("swatch band", f"{terms.say('mean_band')}; {terms.say('interval')}"),
        ),
    ]
    for title, rows in (
        ("angles", angle_rows(body, names.legs, terms)),
        ("torques", joint_rows(body, names.loaded, "torque", terms)),
        ("powers", power_rows(joints, terms)),
        ("reactions", reaction_rows(terms)),
    ):
        charts = [drawn for row in rows for one in row for drawn in pair_charts(pairs, one, terms)]
        if charts:
            sheet = ' class="sheet"' if title in {"angles", "torques", "powers"} else ""
            parts += [f"<h3{sheet}>{escape(terms.say(title))}</h3>", grid(charts)]
    return "".join(parts)


def _charts(rows: list[list[Shown]], draw: Callable[[Shown], str], terms: Terms) -> str:
    drawn = [[chart for chart in (draw(one) for one in row) if chart] for row in rows]
    drawn = [row for row in drawn if row]
    if not drawn:
        return paragraph(terms.say("no_loads"))
    return grid(chart for row in drawn for chart in [*row, "", ""][: max(3, len(row))])


def _key(gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
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


def _numbers(session: Session, terms: Terms) -> str:
    body, names = reference_body(session.subject), joint_names(reference_body(session.subject))
    rows = [*angle_rows(body, names.legs, terms), *joint_rows(body, names.upper, "angle", terms)]
    shown = [one for row in rows for one in row]
    signs = table((terms.say("angles"), "+"), [(one.title, one.positive) for one in shown], "small")
    filters = "; ".join(dict.fromkeys(trial.filter for trial in session.trials))
    used = used_trials(session.subject.report)
    texts = [terms.say("scaled_from", ", ".join(used))] if used else []
    texts += [
        terms.say("cycles_text"),
        terms.say("interval_text"),
        terms.say("made_with", __version__, filters),
    ]
    return "".join(paragraph(text) for text in texts) + folded(terms.say("signs"), signs)
