"""Recorded live runs of a session, as rows of its table."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

from mbkf.app.verdicts import verdict_on
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError
from mbkf.io.files_read import read_state
from mbkf.io.results_folder import SUMMARY_FILE, read_summary
from mbkf.io.session import TrialKind
from mbkf.stream.run.report import LIVE_FILE
from mbkf.study.survey.problems import Problem, plain_problem

Plain = dict[str, object]


def recording_rows(workspace: Workspace, session: str) -> list[Plain]:
    """A session's recorded live runs as plain data, with the entries of a trial and "live".

    Raises:
        InvalidInput: The session does not exist.
    """
    place = workspace.place(session)
    return [_row(place / name) for name in workspace.recordings(session)]


def _row(folder: Path) -> Plain:
    found: Plain = {
        "name": folder.name, "file": folder.name, "kind": TrialKind.UNKNOWN.value, "live": True, "excluded": "",
        "shown": TrialKind.UNKNOWN.value, "seconds": 0.0, "rate_hz": 0.0, "markers": 0, "unnamed": 0,
        "protocol": "", "plates": None, "events": 0, "usable": True, "problems": [], "status": "done", "reason": "",
    }  # fmt: skip
    try:
        entries = _entries(folder, (folder / SUMMARY_FILE).stat().st_mtime_ns)
    except (MbkfError, OSError, ValueError) as error:
        return {**found, "status": "failed", "reason": " ".join(str(error).split())}
    return {**found, **entries, "verdict": verdict_on(folder)}


@lru_cache(maxsize=256)
def _entries(folder: Path, _stamp: int) -> Plain:
    """The entries from a recording's files, cached until they change.

    Raises:
        FileFormatError: A file is damaged.
    """
    summary = read_summary(folder)
    report = json.loads(read_state(folder / LIVE_FILE))
    lost, came = int(report.get("frames_lost", 0)), int(report.get("frames_in", 0))
    return {
        "seconds": summary["duration_s"],
        "rate_hz": summary["rate_hz"],
        "markers": summary["markers_used"],
        "protocol": summary["protocol"],
        "problems": [plain_problem(Problem("frames_lost", (str(lost), str(lost + came))))] if lost else [],
    }
