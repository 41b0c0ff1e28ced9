"""Norms of a session's report: in the report's convention, and the sentences that say whose they are."""

from __future__ import annotations

from mbkf.io.norms import Norms, Span
from mbkf.study.session.norm_conversion import ConvertedNorms, converted
from mbkf.study.session.norm_selection import speed_of
from mbkf.study.session.records import MovementGroup, Session
from mbkf.trial.gait.convention import convention_of
from mbkf.viz.convention_words import statement
from mbkf.viz.language import filled, words
from mbkf.viz.session.terms import Terms


def norms_at_speed(norms: Norms | None, gait: MovementGroup) -> Norms | None:
    """Norms with curves of persons that walk as fast, where there are any; None without norms.

    Args:
        norms: The norms.
        gait: The gait.
    """
    return None if norms is None else norms.at_speed(speed_of(gait))


def norms_in_report(norms: Norms | None, session: Session) -> ConvertedNorms | None:
    """Norms as the session's curves are read; None without norms, or without a curve that compares.

    Args:
        norms: The norms.
        session: The session.
    """
    found = None if norms is None else converted(norms, session.convention, session.axes)
    return found if found is not None and found.norms.curves else None


def norm_sentences(norms: Norms | None, shown: ConvertedNorms | None, terms: Terms) -> list[str]:
    """Source, persons and convention of norms, and how they were brought into the report's convention.

    Args:
        norms: The norms as their file holds them; None: no sentence.
        shown: As the report shows them; None: not at all.
        terms: The report's words.
    """
    if norms is None:
        return []
    say = words(terms.language, "norms")
    persons = max((band.persons for band in norms.curves.values()), default=0)
    facts = [filled(say["persons"], persons)]
    facts += [
        filled(say[key], *_ends(span))
        for key, span in (("ages", norms.ages), ("speeds", norms.speeds))
        if span
    ]
    text = statement(terms.language, convention_of(norms.convention), (norms.axes,))
    source = norms.source or say["own"]
    found = [filled(say["note"], norms.name, source, ", ".join(facts), text)]
    if shown is None:
        return [*found, say["not_drawn"]]
    found += [say["turned"]] if shown.turned else []
    return [*found, say["without_angles"]] if shown.without_angles else found


def _ends(span: Span) -> tuple[str, str]:
    low, high = (f"{one:.2f}".rstrip("0").rstrip(".") for one in span)
    return low, high
