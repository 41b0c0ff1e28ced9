"""The video of a trial in its report: a player of the browser, its begin, and a link."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from urllib.parse import quote

from mbkf.io.session import SESSION_FILE
from mbkf.io.session_change import current_session
from mbkf.io.trial_video import TrialVideo, shown_video, videos_in
from mbkf.viz.language import ENGLISH, filled, words
from mbkf.viz.markup import paragraph, section

MEDIA = "'self' file:"
"""Sources of videos that a report with one may load: its own place, and beside it where it is opened as a file."""


@dataclass(frozen=True)
class LinkedVideo:
    """A video and its address from the report: relative for a report that is kept beside it.

    Attributes:
        video: The video.
        address: Its address.
    """

    video: TrialVideo
    address: str

    @classmethod
    def beside(cls, video: TrialVideo) -> LinkedVideo:
        """The video in the report's own folder."""
        return cls(video, f"./{quote(video.file)}")


def video_beside(folder: Path, trial: str) -> LinkedVideo | None:
    """The video of a trial in the folder of its report, by the session file there or by its name; None without.

    Args:
        folder: The folder of the report.
        trial: Name of the trial.

    Raises:
        FileFormatError: The session file is damaged.
    """
    there = videos_in(folder)
    if not there:
        return None
    shown = shown_video(trial, current_session(folder / SESSION_FILE).trial(trial).videos, there)
    return None if shown is None else LinkedVideo.beside(shown)


def video_section(linked: LinkedVideo, language: str = ENGLISH) -> str:
    """The section, HTML.

    Args:
        linked: The video.
        language: Code of the report's language.
    """
    text, name, address = words(language, "video_of_report"), linked.video.file, escape(linked.address)
    begins = filled(text["begins"], name, f"{linked.video.begins_s:.2f}")
    return section(
        "video",
        text["title"],
        f'<video controls muted preload="metadata" src="{address}"></video>',
        paragraph(f"{begins} {text['beside']}"),
        f'<p><a href="{address}">{escape(name)}</a></p>',
    )
