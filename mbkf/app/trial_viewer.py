"""The trial viewer: a page with a trial in 3-D, its curves, strikes and toe-offs, and another trial beside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from mbkf.io.results_folder import read_reconstruction
from mbkf.io.session import FootEvent, plain_events
from mbkf.io.session_change import version_of
from mbkf.trial.gait.events import foot_events, plain_found
from mbkf.trial.verdict.judge import verdict_of
from mbkf.viz.language import ENGLISH
from mbkf.viz.page import asset, embedded, embedded_words, fill, scripts, viewer_script
from mbkf.viz.scene.recording import recording
from mbkf.viz.sentences import said

SCRIPTS = (
    "element.js", "colours.js", "app_words.js", "scene.js", "plot.js", "panel.js", "player.js", "page.js",
    "viewer_marks.js", "viewer_ghost.js", "viewer_events.js", "viewer_save.js", "viewer_strip.js", "viewer_video.js",
    "trial_viewer.js",
)  # fmt: skip
"""The page's scripts, in the order they are needed."""


def viewer_data(
    folder: Path, events: Iterable[FootEvent] | None = None, language: str = ENGLISH
) -> dict[str, object]:
    """The drawing of a trial, as JSON can hold it.

    Args:
        folder: The trial's results.
        events: Strikes and toe-offs set by hand; None without.
        language: Code of the language of the verdict.

    Returns:
        ``scene`` and ``rows`` (:func:`mbkf.viz.scene.recording.recording`), ``found``: the detected events,
        ``events``: those by hand or None, ``version``: of these, ``verdict``: word, line and reasons, ``frame_s``:
        seconds from one frame of the capture to the next, and ``span_s``: times of its first and last frame.

    Raises:
        FileFormatError: The result is damaged.
        InvalidInput: The result holds no frames.
    """
    r = read_reconstruction(folder)
    found = plain_found(foot_events(r)) if r.tracked.any() else ()
    verdict = verdict_of(r)
    by_hand = None if events is None else plain_events(events)
    return {
        **recording(r),
        "found": plain_events(found),
        "events": by_hand,
        "version": version_of(by_hand),
        "frame_s": 1.0 / r.rate_hz,
        "span_s": [float(r.times_s[0]), float(r.times_s[-1])],
        "verdict": {
            "word": verdict.overall,
            "line": said(verdict.line, language),
            "reasons": [said(one, language) for one in verdict.sentences],
        },
    }


def viewer_page(
    session: str, trial: str, others: Sequence[str], shown: dict[str, object], videos: dict[str, object]
) -> str:
    """The page.

    Args:
        session: The trial's session.
        trial: Its name.
        others: Names of the session's other trials with results.
        shown: Of :func:`viewer_data`.
        videos: Of :func:`mbkf.app.videos.video_data`.
    """
    names = {"session": session, "trial": trial, "others": list(others), "videos": videos}
    return fill(
        "trial_viewer.html",
        style=asset("page.css") + asset("trial_viewer.css"),
        data=embedded("recording", shown) + embedded("viewer", names) + embedded_words("viewer"),
        meshcat=viewer_script(),
        scripts=scripts(SCRIPTS),
    )
