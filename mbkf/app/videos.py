"""Videos beside the captures of a session: which there are, their content in ranges, and when each begins."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import urlencode

from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from mbkf.app.failures import NOT_FOUND, Refused, failed
from mbkf.app.notes import check_version, disagreement
from mbkf.app.replies import in_own_thread
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.session import TrialNotes, session_of
from mbkf.io.session_change import version_of
from mbkf.io.trial_video import VIDEO_TYPES, TrialVideo, named_after, plain_videos, shown_video, videos_in
from mbkf.viz.report.video import LinkedVideo

MOST_VIDEOS = 100
"""Most videos that are stated for one trial; a laboratory has a dozen cameras."""

ONE_RANGE = re.compile(r"bytes=(\d{1,19}-\d{0,19}|-\d{1,19})")
"""The only kind of range that players ask for. Others, and several at once, get the whole file, as HTTP allows."""

Plain = dict[str, object]


def video_data(workspace: Workspace, session: str, trial: str) -> Plain:
    """Videos of a trial for its page.

    Args:
        workspace: The sessions.
        session: The trial's session.
        trial: Its name.

    Returns:
        ``files``: names of all videos beside the captures, the trial's own first; ``video``: those that the session
        file states, and their ``version``; ``shown``: the one to show, or None.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its file is damaged.
    """
    there, stated = videos_in(workspace.folder(session)), workspace.notes(session).trial(trial).videos
    own, shown = named_after(trial, there), shown_video(trial, stated, there)
    return {
        "files": [*own, *(one for one in there if one not in own)],
        "video": plain_videos(stated),
        "version": version_of(plain_videos(stated)),
        "shown": None if shown is None else plain_videos([shown])[0],
    }


def linked_video(workspace: Workspace, session: str, trial: str, saved: bool) -> LinkedVideo | None:
    """The video of a trial for its report; None without one.

    Args:
        workspace: The sessions.
        session: The trial's session.
        trial: Its name.
        saved: Whether the report is to be saved as a file, which finds the video beside it.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its file is damaged.
    """
    there = videos_in(workspace.folder(session))
    shown = shown_video(trial, workspace.notes(session).trial(trial).videos, there)
    if shown is None or saved:
        return None if shown is None else LinkedVideo.beside(shown)
    return LinkedVideo(shown, "video?" + urlencode({"session": session, "file": shown.file}))


def set_videos(workspace: Workspace, session: str, trial: str, sent: object, version: str) -> Plain:
    """Writes a change of a trial's videos into its session file.

    Args:
        workspace: The sessions.
        session: The trial's session.
        trial: Its name.
        sent: ``base``: videos that the change began from; ``video``: those with the change.
        version: Version of the base.

    Returns:
        ``video``: the videos as they stand in the file now, their ``version``, and
        :func:`mbkf.app.notes.disagreement` where somebody else has changed them.

    Raises:
        InvalidInput: The session does not exist, or the request holds no videos.
        FileFormatError: The session file is damaged, or a video is not possible.
        Refused: The version is not that of the base.
        OSError: The file cannot be written.
    """
    before, after = _videos(sent, "base"), _videos(sent, "video")
    check_version(version_of(plain_videos(before)), version)
    workspace.folder(session)
    changed = workspace.change_trial(session, trial, TrialNotes(videos=before), TrialNotes(videos=after))
    now = plain_videos(changed.notes.trial(trial).videos)
    return {"video": now, "version": version_of(now), **disagreement(changed.differences)}


def _videos(sent: object, key: str) -> tuple[TrialVideo, ...]:
    """The videos under a key of a request.

    Raises:
        InvalidInput: There are no videos under it, or too many.
        FileFormatError: A video is not possible.
    """
    listed = sent.get(key) if isinstance(sent, Mapping) else None
    if not isinstance(listed, list) or len(listed) > MOST_VIDEOS:
        raise InvalidInput(f"the page must send at most {MOST_VIDEOS} videos under '{key}'")
    return session_of({"trial": {"it": {"video": listed}}}).trial("it").videos


def video_route(path: str, workspace: Workspace) -> Route:
    """A GET request for a video beside the captures of a session, whole or one range of its bytes.

    The name must be one of :func:`mbkf.io.trial_video.videos_in`; so no path leads to another file.
    """

    def found(session: str, name: str) -> Path:
        folder = workspace.folder(session)
        if name not in videos_in(folder):
            raise Refused(
                NOT_FOUND, "this video is not beside the captures; put it there, or choose another one"
            )
        return folder / name

    async def endpoint(request: Request) -> Response:
        words = request.query_params
        session, name = words.get("session", ""), words.get("file", "")
        try:
            file = await in_own_thread(lambda: found(session, name))
            state = await in_own_thread(file.stat)
        except (MbkfError, OSError) as error:
            return failed(error)
        if not ONE_RANGE.fullmatch(request.headers.get("range", "")):
            request.scope["headers"] = [one for one in request.scope["headers"] if one[0] != b"range"]
        kind = VIDEO_TYPES[file.suffix.lower()]
        return FileResponse(file, media_type=kind, stat_result=state)

    return Route(path, endpoint, methods=["GET"])
