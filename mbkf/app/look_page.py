"""The page on which a trial is looked at: its 3-D view with curves, strikes and toe-offs, another trial beside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from mbkf.io.results_folder import read_reconstruction
from mbkf.io.session import FootEvent, plain_events
from mbkf.trial.gait.events import foot_events, plain_found
from mbkf.viz.language import languages, words
from mbkf.viz.page import asset, embedded, viewer_script
from mbkf.viz.scene.recording import recording

SCRIPTS = (
    "element.js", "colours.js", "app_words.js", "scene.js", "plot.js", "panel.js", "player.js", "page.js",
    "look_marks.js", "look_ghost.js", "look_events.js", "look_save.js", "look_strip.js", "look.js",
)  # fmt: skip
"""The page's scripts, in the order they are needed."""


def look_data(folder: Path, events: Iterable[FootEvent] | None = None) -> dict[str, object]:
    """What a page draws of a trial, as JSON can hold it.

    Args:
        folder: The trial's results.
        events: Strikes and toe-offs that a person set; None where there are none.

    Returns:
        ``scene`` and ``rows`` (:func:`mbkf.viz.scene.recording.recording`), ``found``: the events that were found,
        ``events``: those by hand or None, ``frame_s``: seconds from one frame of the capture to the next, and
        ``span_s``: times of its first and last frame.

    Raises:
        FileFormatError: The result is damaged.
        InvalidInput: The result holds no frames.
    """
    r = read_reconstruction(folder)
    found = plain_found(foot_events(r)) if r.tracked.any() else ()
    return {
        **recording(r),
        "found": plain_events(found),
        "events": None if events is None else plain_events(events),
        "frame_s": 1.0 / r.rate_hz,
        "span_s": [float(r.times_s[0]), float(r.times_s[-1])],
    }


def look_page(session: str, trial: str, others: Sequence[str], data: dict[str, object]) -> str:
    """The page.

    Args:
        session: Its session.
        trial: What is looked at.
        others: Names of the session's other trials that have results.
        data: Of :func:`look_data`.
    """
    known: dict[str, object] = {
        code: {"name": name, "words": dict(words(code, "look"))} for code, name in languages().items()
    }
    parts = {
        "style": asset("page.css") + asset("look.css"),
        "data": embedded("recording", data)
        + embedded("look", {"session": session, "trial": trial, "others": list(others)})
        + embedded("words", known),
        "meshcat": viewer_script(),
        "scripts": "\n".join(asset(name) for name in SCRIPTS),
    }
    text = asset("look.html")
    for name, part in parts.items():
        text = text.replace("{{" + name + "}}", part, 1)
    return text
