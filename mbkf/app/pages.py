"""The pages that the server gives out, each self-contained."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.session import FootEvent
from mbkf.viz.language import languages, words
from mbkf.viz.page import asset, embedded
from mbkf.viz.report.document import report_page

SCRIPTS = (
    "element.js", "app_words.js", "app_live.js", "app_export.js", "app_report.js", "app_session.js", "app.js",
)  # fmt: skip
"""The page's own scripts, in the order they are needed."""

SECTIONS = ("app", "live", "export", "problems")
"""Sections of the language files with the page's words; no two have a word of one name."""


def start_page() -> str:
    """The page of the sessions."""
    text = asset("app.html")
    known: dict[str, object] = {
        code: {"name": name, "words": page_words(code)} for code, name in languages().items()
    }
    parts = {
        "style": asset("app.css"),
        "words": embedded("words", known),
        "scripts": "\n".join(asset(name) for name in SCRIPTS),
    }
    for name, part in parts.items():
        text = text.replace("{{" + name + "}}", part, 1)
    return text


def page_words(language: str) -> dict[str, str]:
    """The words of the page of the sessions, of all its sections.

    Args:
        language: Code, e.g. "es".
    """
    return {name: text for section in SECTIONS for name, text in words(language, section).items()}


def report(folder: Path, events: tuple[FootEvent, ...] | None = None) -> str:
    """The report on a trial's result.

    Args:
        folder: The result.
        events: Strikes and toe-offs that a person set; None for those that are found.

    Raises:
        FileFormatError: The result is damaged.
    """
    return report_page(read_reconstruction(folder), read_summary(folder), by_hand=events)


LOOKS: Mapping[str, Callable[[Path, tuple[FootEvent, ...] | None], str]] = {"report": report}
"""Pages about a trial, by the last part of their path, that its result and its events by hand make."""
