"""Head and foot of every printed page: patient, date of the visit, laboratory, and "n / N".

They are margin boxes of CSS Paged Media (W3C, css-page-3, section 4), which Chromium prints from version 131 on.
"""

from __future__ import annotations

from mbkf.io.laboratory import Laboratory
from mbkf.study.session.records import Session

MOST_LETTERS = 70
"""Longest text of a margin box; three of them share the width of a page."""


def page_margins(session: Session, laboratory: Laboratory, title: str) -> str:
    """The style sheet of the margins.

    Args:
        session: Its person and visit stand at the top.
        laboratory: Its name stands at the top.
        title: Kind of the report, at the bottom.
    """
    boxes = (
        ("top-left", _text(session.patient or session.name)),
        ("top-center", _text(session.visit.date)),
        ("top-right", _text(laboratory.name)),
        ("bottom-left", _text(title)),
        ("bottom-right", 'counter(page) " / " counter(pages)'),
    )
    return "@page {" + "".join(f"@{place} {{ content: {content}; }}" for place, content in boxes) + "}"


def _text(text: str) -> str:
    """A text in CSS, in one line; letters with a meaning in CSS or HTML are written by their numbers."""
    line = " ".join(text.split())
    shown = line if len(line) <= MOST_LETTERS else line[: MOST_LETTERS - 1] + "…"
    letters = (
        letter if letter.isascii() and letter.isalnum() else f"\\{ord(letter):06x}" for letter in shown
    )
    return f'"{"".join(letters)}"'
