"""Strikes and toe-offs that a person sets on the trial viewer: into the session file and the trial's curves."""

from __future__ import annotations

import contextlib
from pathlib import Path

from mbkf.app.runs import RUNNING, Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.session import FootEvent, plain_events, session_of
from mbkf.study.batch.curves import SIDES, read_curves
from mbkf.study.batch.trial import CURVES_FILE, curves_anew

MOST_EVENTS = 100_000
"""Most events of one trial; an hour of running has a quarter of them."""


def events_of(plain: object) -> tuple[FootEvent, ...] | None:
    """The events under "events"; None stands for the detected ones.

    Raises:
        InvalidInput: An event lacks its entries, or the request holds too many events.
        FileFormatError: An event is not possible.
    """
    if not isinstance(plain, dict) or "events" not in plain:
        raise InvalidInput("the page sent no events")
    listed = plain["events"]
    if listed is None:
        return None
    if isinstance(listed, list) and len(listed) > MOST_EVENTS:
        raise InvalidInput(f"{len(listed)} events are more than {MOST_EVENTS}")
    return session_of({"trial": {"it": {"event": listed}}}).trial("it").events


def set_events(
    workspace: Workspace, runs: Runs, session: str, trial: str, events: tuple[FootEvent, ...] | None
) -> dict[str, object]:
    """Writes a trial's events into its session file, and makes its curves again.

    Args:
        workspace: The sessions.
        runs: Their runs.
        session: The trial's session.
        trial: Its name.
        events: Events by hand; None for the detected ones.

    Returns:
        ``events`` as they stand in the file now; ``cycles``: counts of the right and the left foot in the new curves,
        or None where the next run makes the curves: while a run is under way, for a result of an older kind, and for
        a live recording.

    Raises:
        InvalidInput: The session or the trial's result does not exist.
        FileFormatError: The session file is damaged.
        OSError: A file cannot be written.
    """
    folder = workspace.result(session, trial)
    workspace.note_events(session, trial, events)
    state = runs.state(session)
    cycles = None
    if (state is None or state.state != RUNNING) and trial not in workspace.recordings(session):
        with contextlib.suppress(FileFormatError):  # the next run repairs the damage
            curves_anew(workspace.trial(session, trial), workspace.out)
            cycles = cycles_in(folder / CURVES_FILE)
    return {"events": None if events is None else plain_events(events), "cycles": cycles}


def cycles_in(curves: Path) -> list[int]:
    """Counts of cycles of the right and of the left foot in a file of curves.

    Raises:
        FileFormatError: The file is missing or damaged.
    """
    table = read_curves(curves).group_by("side").aggregate([("cycle", "max")]).to_pydict()
    found = dict(zip(table["side"], table["cycle_max"], strict=True))
    return [found.get(side, 0) for side in SIDES]
