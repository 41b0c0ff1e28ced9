"""The part of a session's report on electromyograms: envelopes over the gait cycle, and when each muscle is active."""

from __future__ import annotations

from html import escape

import numpy as np

from mbkf.conventions import SIDES
from mbkf.numerics.runs import runs, spread_indices
from mbkf.study.session.cycles import PERCENT
from mbkf.study.session.emg import ACTIVE_SHARE, MEAN, PEAK, MuscleCycles, muscle_cycles, muscles
from mbkf.study.session.records import MovementGroup, Session
from mbkf.trial.emg.envelope import upper_hz
from mbkf.viz.markup import grid, key, paragraph
from mbkf.viz.session.charts import MOST_SINGLE, PER_CENT
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import Line, Mark, Span, chart


def emg_part(session: Session, gait: MovementGroup, terms: Terms, reference: str = PEAK) -> str:
    """Heading, settings and a chart of each muscle; an empty text without electromyograms.

    Args:
        session: The session.
        gait: One of its gaits.
        terms: The report's words.
        reference: Of the amplitude: peak, mean or the name of a trial.

    Raises:
        UnknownName: The reference trial does not exist.
    """
    charts = [
        _muscle_chart(gait, name, cycles, terms)
        for name in muscles(gait)
        if (cycles := muscle_cycles(session, gait, name, reference))
    ]
    if not charts:
        return ""
    entries = (("swatch r", terms.say("right")), ("swatch l", terms.say("left")))
    more = (("swatch band", terms.say("mean_band")), ("swatch off", terms.say("toe_off")))
    return "".join(
        (
            f'<h3 class="sheet">{escape(terms.say("emg"))}</h3>',
            paragraph(f"{_filters(session, gait, terms)} {_reference(reference, terms)}"),
            key(*entries, *more),
            grid(charts),
        )
    )


def _filters(session: Session, gait: MovementGroup, terms: Terms) -> str:
    """Filters of the first trial with electromyograms; all trials of a run have the same settings."""
    emg = next(one.emg for one in session.trials if one.emg is not None and one.name in gait.trials)
    chosen = emg.settings
    return terms.say(
        "emg_note",
        len(emg.peaks_v),
        f"{chosen.low_hz:g}",
        f"{upper_hz(emg.rate_hz, chosen):g}",
        f"{chosen.envelope_hz:g}",
        chosen.order,
        chosen.envelope_order,
        f"{chosen.false_alarm:g}",
    )


def _reference(reference: str, terms: Terms) -> str:
    if reference in (PEAK, MEAN):
        return terms.say(f"emg_{reference}")
    return terms.say("emg_trial", reference)


def _muscle_chart(gait: MovementGroup, name: str, cycles: tuple[MuscleCycles, ...], terms: Terms) -> str:
    """Single cycles thin, the mean with its band bold, and bars where the muscle is active."""
    thin, bold, marks, spans = [], [], [], []
    for one in cycles:
        letter = SIDES[one.side]
        known = np.flatnonzero(np.isfinite(one.percent).all(axis=1))
        values = one.percent[known]
        band = None
        if len(values) > 1:
            some = spread_indices(len(values), MOST_SINGLE)
            thin += [Line(PERCENT, each, None, letter, thin=True) for each in values[some]]
            band = 0.5 * values.std(axis=0, ddof=1)
        bold.append(Line(PERCENT, values.mean(axis=0), band, letter))
        offs = [gait.sides[one.side].cycles[k].cycle.off_percent for k in known]
        marks.append(Mark(float(np.mean(offs)), letter))
        active = runs(one.active_share >= ACTIVE_SHARE)
        spans += [Span(PERCENT[a], PERCENT[b - 1], letter) for a, b in active]
    return chart(terms.muscle(name), "%", [*thin, *bold], PER_CENT, "%", marks=marks, spans=spans, level=0.0)
