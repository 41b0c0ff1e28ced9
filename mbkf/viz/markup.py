"""Pieces of HTML for reports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


class Html(str):
    """A text that is HTML already."""


def _html(text: str) -> str:
    return text if isinstance(text, Html) else escape(text)


def section(name: str, title: str, *body: str) -> str:
    """A section with its heading.

    Args:
        name: Identifier that the navigation links to.
        title: The heading, plain text.
        body: Pieces of HTML.
    """
    return f'<section id="{name}"><h2>{escape(title)}</h2>{"".join(body)}</section>'


def paragraph(text: str) -> str:
    """A paragraph of plain text."""
    return f"<p>{escape(text)}</p>"


def kept(text: str) -> str:
    """A paragraph of plain text with names in it, in the page's language already."""
    return f'<p translate="no">{escape(text)}</p>'


def grid(charts: Iterable[str], columns: int = 3) -> str:
    """Charts side by side; an empty string leaves its place free."""
    cells = "".join(f"<div>{chart}</div>" for chart in charts)
    return f'<div class="grid g{columns}">{cells}</div>'


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table of texts; the first column is left-aligned, the others are numbers.

    Args:
        headings: Column headings.
        rows: Cells of each row; of :class:`Html`, or plain text.
        kind: CSS class of the table.
    """
    head = "".join(f"<th>{escape(text)}</th>" for text in headings)
    body = "".join(
        "<tr>" + "".join(f"<td>{_html(cell)}</td>" for cell in row) + "</tr>" for row in rows if row
    )
    return f'<table class="{kind}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'


def folded(title: str, *body: str) -> str:
    """Content that is shown when its title is clicked (and on paper)."""
    return f"<details><summary>{escape(title)}</summary>{''.join(body)}</details>"


def key(*entries: tuple[str, str]) -> str:
    """A legend: pairs of the class of a swatch and its text."""
    spans = "".join(f'<span><i class="{cls}"></i>{escape(text)}</span>' for cls, text in entries)
    return f'<p class="key">{spans}</p>'
