"""One self-contained page about a session: trials, gait of each kind, jumps, squats, and changes since another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

from mbkf.io.laboratory import Laboratory
from mbkf.io.norms import Norms
from mbkf.model.human import reference_body
from mbkf.study.scaling.report import used_trials
from mbkf.study.session.comparison import (
    Comparison,
    by_curve,
    compare,
    conditions_compared,
    measure_pairs,
)
from mbkf.study.session.cycles import Key
from mbkf.study.session.emg import PEAK
from mbkf.study.session.records import MovementGroup, Session
from mbkf.study.session.trend import Trend, trend
from mbkf.version import __version__
from mbkf.viz.language import ENGLISH, words
from mbkf.viz.markup import folded, grid, kept, key, paragraph, section, table
from mbkf.viz.page import BLUE_RED, document, report_style
from mbkf.viz.report.cells import JointNames, joint_names
from mbkf.viz.session.charts import (
    Shown,
    angle_rows,
    joint_rows,
    legend,
    pair_charts,
    power_rows,
    reaction_rows,
    session_chart,
)
from mbkf.viz.session.emg import emg_part
from mbkf.viz.session.letterhead import condition_name, long_texts
from mbkf.viz.session.norms import norm_sentences, norms_at_speed, norms_in_report
from mbkf.viz.session.print_style import page_margins
from mbkf.viz.session.scores import scores_part
from mbkf.viz.session.summary import summary_part
from mbkf.viz.session.tables import changes_table, measures_table, trials_table
from mbkf.viz.session.terms import Terms
from mbkf.viz.session.trend import trend_part


def session_page(
    session: Session,
    before: Session | None = None,
    norms: Norms | None = None,
    language: str = ENGLISH,
    emg_reference: str = PEAK,
    colours: str = BLUE_RED,
    laboratory: Laboratory | None = None,
    visits: Sequence[Session] = (),
) -> str:
    """The report.

    Args:
        session: The session.
        before: An earlier session to compare with; None without.
        norms: The laboratory's reference bands; None without.
        language: Code of the report's language.
        emg_reference: 100 % of electromyograms: "peak" or "mean" of the session's cycles, or the peak of a trial.
        colours: Of right and left, one of :data:`mbkf.viz.page.COLOURS`.
        laboratory: For the head of the report; None without.
        visits: Other visits of the person, for their trend; each states its date.

    Raises:
        InvalidInput: The language does not exist, or a visit of a trend states no date.
        UnknownName: The session has no such trial with electromyograms, or the colours do not exist.
    """
    terms = Terms(language, session.convention, session.axes)
    names = joint_names(reference_body(session.subject))
    laboratory = laboratory or Laboratory()
    parts = [
        ("summary", terms.sheet("summary"), summary_part(session, norms, laboratory, terms)),
        ("trials", terms.say("trials"), trials_table(session, terms) + _whole_texts(session, terms)),
    ]
    parts += [
        (
            _section_name(session, gait),
            _gait_title(gait, terms),
            _gait(session, gait, names, norms, terms) + emg_part(session, gait, terms, emg_reference),
        )
        for gait in session.gaits
    ]
    if not (session.gaits or session.jumps or session.squats):
        parts.append(("gait", terms.say("unknown"), paragraph(terms.say("no_gait"))))
    for name, measures in (("jumps", session.jumps), ("squats", session.squats)):
        if measures:
            parts.append((name, terms.say(name), measures_table(measures, terms)))
    if conditions := conditions_compared(session):
        parts.append(
            ("conditions", terms.sheet("conditions"), _conditions(conditions, session, names, terms))
        )
    if visits and (found := _trend(session, visits, norms, laboratory)) is not None:
        parts.append(("trend", terms.sheet("trend"), trend_part(found, terms)))
    if before is not None:
        parts.append(("change", terms.say("before_after"), _changes(before, session, names, terms)))
    parts.append(("numbers", terms.say("numbers"), _numbers(session, terms)))
    body = _heading(session, terms) + "".join(section(name, title, text) for name, title, text in parts)
    style = report_style(colours, "report.css", "session_report.css", "sheet.css")
    style += page_margins(session, laboratory, terms.say("title"))
    links = [(name, title) for name, title, _ in parts]
    return document(language, f"{session.name} · {terms.say('title')}", style, links, body)


def _trend(
    session: Session, visits: Sequence[Session], norms: Norms | None, laboratory: Laboratory
) -> Trend | None:
    shown = norms_in_report(norms, session)
    return trend([*visits, session], None if shown is None else shown.norms, laboratory.trend)


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
    return f"<div class='on-screen'><h1 translate='no'>{escape(session.name)}</h1><p class='facts'>{line}</p></div>"


def _section_name(session: Session, gait: MovementGroup) -> str:
    """Identifier of a gait's section; gaits of the same kind after the first one are numbered."""
    same = [one for one in session.gaits if one.kind == gait.kind]
    place = next(k for k, one in enumerate(same) if one is gait)
    return f"gait-{gait.kind.value}" + (f"-{place + 1}" if place else "")


def _gait_title(gait: MovementGroup, terms: Terms) -> str:
    condition = condition_name(gait.condition, terms.language)
    return ": ".join(text for text in (terms.say(gait.kind.value), condition) if text)


def _whole_texts(session: Session, terms: Terms) -> str:
    """Texts that the sheet shortens."""
    own = words(terms.language, "visit")
    return "".join(f"<h4>{escape(own[key])}</h4>{kept(text)}" for key, text in long_texts(session))


def _gait(session: Session, gait: MovementGroup, names: JointNames, norms: Norms | None, terms: Terms) -> str:
    """The section of one kind of gait."""
    body = reference_body(session.subject)
    norms = norms_at_speed(norms, gait)
    counts = [len(side.cycles) for side in gait.sides]

    shown = norms_in_report(norms, session)
    own = None if shown is None else shown.norms
    known = {} if own is None else own.curves

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
            scores_part(gait, own, terms),
            f'<h3 class="sheet">{escape(terms.say("angles"))}</h3>',
            legend(gait, own, terms),
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


def _conditions(comparisons: Sequence[Comparison], session: Session, names: JointNames, terms: Terms) -> str:
    """The section that compares the conditions of a visit."""
    return "".join(_change(one, session, names, terms, _gait_conditions(one, terms)) for one in comparisons)


def _gait_conditions(comparison: Comparison, terms: Terms) -> tuple[str, str]:
    before, after = (
        condition_name(one, terms.language) or terms.sheet("no_condition") for one in comparison.conditions
    )
    return before, after


def _change(
    comparison: Comparison,
    after: Session,
    names: JointNames,
    terms: Terms,
    conditions: tuple[str, str] | None = None,
) -> str:
    """Tables and charts of a comparison of visits, or of conditions with these names."""
    body, pairs = reference_body(after.subject), by_curve(comparison)
    joints = [joint for joint in names.loaded if any(Key("power", joint) == k for k, _ in pairs)]
    old, new = conditions or (terms.say("before"), terms.say("after"))
    kind = terms.say(comparison.kind.value)
    title = f"{kind}: {new} – {old}" if conditions else kind
    body_note = "same_body" if comparison.same_body else "other_body"
    parts = [
        f"<h3>{escape(title)}</h3>",
        paragraph(terms.sheet("conditions_note") if conditions else terms.say(body_note)),
        changes_table(comparison.measures, terms, (old, new)),
        key(
            ("swatch b", old),
            ("swatch r", f"{new}, {terms.say('right')}"),
            ("swatch l", f"{new}, {terms.say('left')}"),
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
