"""The start page, the report on a trial, and the frame of a live run's page."""

from __future__ import annotations

from html import escape
from pathlib import Path

from mbkf.app.charts import Charts
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.session import FootEvent
from mbkf.stream.loopback import LOOPBACK
from mbkf.viz.language import ENGLISH, languages, words
from mbkf.viz.markup import paragraph, section
from mbkf.viz.page import BLUE_RED, asset, document, embedded_words, fill, report_style, scripts
from mbkf.viz.report.document import report_page
from mbkf.viz.report.video import LinkedVideo

SCRIPTS = (
    "element.js", "app_words.js", "app_place.js", "app_focus.js", "app_merge.js", "app_live.js", "app_export.js",
    "app_files.js", "app_norms.js", "app_report.js", "app_visit.js", "app_session.js", "app_all.js", "app.js",
)  # fmt: skip
"""Scripts of the start page, in the order they are needed."""

SECTIONS = (
    "app",
    "live",
    "export",
    "problems",
    "chart_choices",
    "files",
    "help_titles",
    "visit",
    "norm_files",
)
"""Sections of the language files with the start page's texts; a key stands in one of them only."""


def start_page() -> str:
    """The page of the sessions."""
    return fill("app.html", style=asset("app.css"), words=embedded_words(*SECTIONS), scripts=scripts(SCRIPTS))


def help_page(language: str) -> str:
    """Help on every step of the page, in one document that needs no network.

    Args:
        language: Its code.

    Raises:
        InvalidInput: The language does not exist.
    """
    titles, texts = words(language, "help_titles"), words(language, "help_texts")
    parts = [(name, titles[f"help_{name}"], text.split("\n\n")) for name, text in texts.items()]
    body = f"<h1>{escape(titles['help'])}</h1>" + "".join(
        section(name, title, "".join(map(paragraph, texts))) for name, title, texts in parts
    )
    links = [(name, title) for name, title, _ in parts]
    return document(language, titles["help"], report_style(BLUE_RED, "report.css"), links, body)


def trial_report(
    folder: Path,
    charts: Charts,
    events: tuple[FootEvent, ...] | None = None,
    language: str = ENGLISH,
    video: LinkedVideo | None = None,
) -> str:
    """The report on a trial's result.

    Args:
        folder: The result.
        charts: Convention and colours.
        events: Strikes and toe-offs set by hand; None for the detected ones.
        language: Code of its language.
        video: A video of the trial; None without.

    Raises:
        FileFormatError: The result is damaged.
        InvalidInput: The language does not exist.
    """
    return report_page(
        read_reconstruction(folder),
        read_summary(folder),
        by_hand=events,
        convention=charts.read,
        colours=charts.colours,
        language=language,
        video=video,
    )


def live_frame_page(port: int, language: str = ENGLISH) -> str:
    """A page that holds the live page at a port of this computer in a frame, and may hold nothing else.

    Args:
        port: The port.
        language: Code of the live page's language; English where it is not known.
    """
    known = language if language in languages() else ENGLISH
    return fill("app_live.html", address=f"http://{LOOPBACK}:{port}", language=known)
