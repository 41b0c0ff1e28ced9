"""Videos of a trial: files beside its captures, and the time of the capture at which each begins.

[[trial.walk3.video]]
file = "walk3_front.mp4"
begins_s = -0.35
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mbkf.io import fields
from mbkf.io.files_read import place_of
from mbkf.io.toml import Entries

VIDEO_TYPES = {
    ".mp4": "video/mp4", ".m4v": "video/mp4", ".webm": "video/webm", ".mov": "video/quicktime",
    ".avi": "video/x-msvideo", ".mkv": "video/x-matroska", ".wmv": "video/x-ms-wmv", ".mpg": "video/mpeg",
}  # fmt: skip
"""Suffixes of videos and their media types. Browsers play the first three as a rule; the page explains the others."""

DIGITS = 2
"""Decimals of the begin of a video in a session file: 0.01 s."""

BEGINS_S = (-86400.0, 86400.0)
"""Possible begins: a day before and after the capture's own zero."""

_FILE = fields.text("file", "name of the video, which lies beside the captures", required=True)
_BEGINS = fields.number("begins_s", "time of the capture at which it begins; by default 0", BEGINS_S, "s")
VIDEO = fields.record("video", _FILE, _BEGINS)
"""Entries of a video."""


@dataclass(frozen=True)
class TrialVideo:
    """A video of a trial.

    Attributes:
        file: Its name, in the folder of the captures.
        begins_s: Time of the capture at its first picture; negative where it began before the capture.
    """

    file: str
    begins_s: float = 0.0


def video_of(read: Entries) -> TrialVideo:
    """A video from the entries of a session file.

    Raises:
        FileFormatError: An entry is missing or not possible.
    """
    return TrialVideo(read.need(_FILE), round(read.get(_BEGINS) or 0.0, DIGITS))


def plain_videos(videos: Iterable[TrialVideo]) -> list[dict[str, object]]:
    """Videos as plain data, as a session file holds them."""
    return [{"file": one.file, "begins_s": round(one.begins_s, DIGITS)} for one in videos]


def videos_in(folder: Path) -> tuple[str, ...]:
    """Names of the videos in a folder, sorted; links that lead out of it and what is no regular file are left out.

    Args:
        folder: The folder; a missing one has no videos.
    """
    if not folder.is_dir():
        return ()
    place = place_of(folder)
    found = (one for one in folder.iterdir() if one.suffix.lower() in VIDEO_TYPES and one.is_file())
    return tuple(sorted(one.name for one in found if place_of(one).parent == place))


def named_after(trial: str, videos: Iterable[str]) -> tuple[str, ...]:
    """Videos whose name is the trial's, or begins with it and goes on with neither letter nor digit; sorted.

    Args:
        trial: Name of the trial, e.g. "walk1": "walk1.mp4" and "walk1_front.mp4" are its videos, "walk12.mp4" is not.
        videos: Names of files.
    """
    wanted = trial.casefold()
    rests = ((one, Path(one).stem.casefold().partition(wanted)) for one in videos)
    own = ((rest, one) for one, (before, there, rest) in rests if there and not before)
    return tuple(one for rest, one in sorted(own) if not rest[:1].isalnum())


def shown_video(trial: str, stated: Iterable[TrialVideo], videos: Iterable[str]) -> TrialVideo | None:
    """The video to show: the first that is stated and there, else the one named after the trial.

    Args:
        trial: Name of the trial.
        stated: Those of the session file.
        videos: Names of the files that are there.
    """
    there = tuple(videos)
    chosen = next((one for one in stated if one.file in there), None)
    if chosen is not None:
        return chosen
    own = named_after(trial, there)
    return TrialVideo(own[0]) if own else None
