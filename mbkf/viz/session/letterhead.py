"""The head of a session's sheet: the laboratory, and the person with the facts of the visit."""

from __future__ import annotations

import base64
from html import escape

from mbkf.io.laboratory import Laboratory
from mbkf.io.visit import AFFECTED, CONDITIONS
from mbkf.study.session.records import Session
from mbkf.viz.language import words
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import number

MOST_TEXT = 220
"""Most letters of diagnosis and of notes on the sheet; the whole text stands with the trials."""

WRITTEN = {"patient", "condition", "clinician", "diagnosis", "visit_notes"}
"""Facts in people's own words, which the page leaves as they are."""


def letterhead(session: Session, laboratory: Laboratory, terms: Terms) -> str:
    """Logo, name and address of the laboratory beside the title, and the facts of person and visit below.

    Args:
        session: The session.
        laboratory: The laboratory.
        terms: The report's words.
    """
    logo = ""
    if laboratory.logo:
        data = base64.b64encode(laboratory.logo).decode("ascii")
        logo = f'<img alt="" src="data:{laboratory.media_type};base64,{data}">'
    address = "<br>".join(escape(line) for line in laboratory.address.splitlines() if line.strip())
    name = f"<b>{escape(laboratory.name)}</b>" if laboratory.name else ""
    owner = f'<div class="owner">{logo}<p translate="no">{name}{"<br>" if name and address else ""}{address}</p></div>'
    title = f'<p class="sheet-title">{escape(terms.sheet("title"))}</p>'
    return f'<div class="letterhead">{owner}{title}</div>{_facts(session, terms)}'


def long_texts(session: Session) -> list[tuple[str, str]]:
    """Diagnosis and notes that the sheet shortens: key and whole text."""
    texts = (("diagnosis", session.visit.diagnosis), ("visit_notes", session.visit.notes))
    return [(key, text) for key, text in texts if len(text) > MOST_TEXT]


def condition_name(condition: str, language: str) -> str:
    """A condition in the report's language; a text of the laboratory's own as it stands.

    Args:
        condition: The condition.
        language: Code of the language.
    """
    return words(language, "visit")[condition] if condition in CONDITIONS else condition


def _facts(session: Session, terms: Terms) -> str:
    """Pairs of heading and value, of what is known."""
    visit = session.visit
    born = visit.birth_date
    age = "" if session.age is None else terms.say("years", f"{session.age:g}")
    conditions = dict.fromkeys(one.condition for one in session.gaits) or {visit.condition: None}
    size = f"{number(session.subject.height_m, 2)} m, " if session.subject.height_m else ""
    side = words(terms.language, "visit")[f"side_{visit.side}"] if visit.side in AFFECTED else ""
    short = [
        ("patient", session.patient or session.name),
        ("birth_date", ", ".join(text for text in (born, age) if text)),
        ("sex_of_person", terms.say(session.sex) if session.sex else ""),
        ("visit_date", visit.date),
        ("condition", ", ".join(condition_name(one, terms.language) for one in conditions if one)),
        ("affected", side),
        ("size", f"{size}{number(session.subject.mass_kg, 1)} kg"),
        ("clinician", visit.clinician),
        *((str(key), str(value)) for key, value in visit.others.items()),
    ]
    long = [("diagnosis", visit.diagnosis), ("visit_notes", visit.notes)]
    cells = [_cell(key, value, terms, key in visit.others) for key, value in short if value]
    cells += [_cell(key, shortened(value), terms, wide=True) for key, value in long if value]
    return f'<dl class="facts-of-visit">{"".join(cells)}</dl>'


def shortened(text: str) -> str:
    """A text of at most :data:`MOST_TEXT` letters."""
    return text if len(text) <= MOST_TEXT else text[:MOST_TEXT].rsplit(" ", 1)[0] + " …"


def _cell(key: str, value: str, terms: Terms, own: bool = False, wide: bool = False) -> str:
    known = {**words(terms.language, "visit"), **words(terms.language, "sheet")}
    title = key if own else known[key]
    kind, kept = ' class="wide"' if wide else "", ' translate="no"' if own or key in WRITTEN else ""
    return f"<div{kind}><dt{kept}>{escape(title)}</dt><dd{kept}>{escape(value)}</dd></div>"
