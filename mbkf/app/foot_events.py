"""Strikes and toe-offs that a person sets on the trial viewer: into the session file and the trial's curves."""

from __future__ import annotations

import contextlib
from pathlib import Path

from mbkf.app.notes import check_version, disagreement
from mbkf.app.run_states import RUNNING
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.session import FootEvent, plain_events, session_of
from mbkf.io.session_change import version_of
from mbkf.study.batch.curves import SIDES, read_curves
from mbkf.study.batch.trial import CURVES_FILE, curves_anew

MOST_EVENTS = 100_000
"""Most events of one trial; an hour of running has a quarter of them."""


def events_of(plain: object, key: str = "events") -> tuple[FootEvent, ...] | None:
    """The events under a key of a request; None stands for the detected ones.

    Raises:
        InvalidInput: An event lacks its entries, or the request holds too many events.
        FileFormatError: An event is not possible.
    """
    if not isinstance(plain, dict) or key not in plain:
        raise InvalidInput(f"the page sent no {key}")
    listed = plain[key]
    if listed is None:
        return None
    if isinstance(listed, list) and len(listed) > MOST_EVENTS:
        raise InvalidInput(f"{len(listed)} events are more than {MOST_EVENTS}")
    return session_of({"trial": {"it": {"event": listed}}}).trial("it").events


def events_version(events: tuple[FootEvent, ...] | None) -> str:
    """The version of a trial's events by hand."""
    return version_of(None if events is None else plain_events(events))


def set_events(
    workspace: Workspace, runs: Runs, session: str, trial: str, sent: object, version: str
) -> dict[str, object]:
    """Writes a change of a trial's events into its session file, and makes its curves again.

    Args:
        workspace: The sessions.
        runs: Their runs.
        session: The trial's session.
        trial: Its name.
        sent: ``base``: events by hand that the change began from, the present ones if it is missing; ``events``: those
            with the change; each None for the detected ones.
        version: Version of the base.

    Returns:
        ``events`` as they stand in the file now, and their ``version``; ``cycles``: counts of the right and the left
        foot in the new curves, or None where the next run makes the curves: while a run is under way, for a result of
        an older kind, and for a live recording. With :func:`mbkf.app.notes.disagreement` where somebody else has
        changed the events.

    Raises:
        InvalidInput: The session or the trial's result does not exist, or the request holds no events.
        FileFormatError: The session file is damaged, or an event is not possible.
        Refused: The version is not that of the base.
        OSError: A file cannot be written.
    """
    after, folder = events_of(sent), workspace.result(session, trial)
    stated = isinstance(sent, dict) and "base" in sent
    before = events_of(sent, "base") if stated else workspace.events(session, trial)
    check_version(events_version(before), version)
    changed = workspace.change_events(session, trial, before, after)
    events = changed.notes.trial(trial).events
    state = runs.state(session)
    cycles = None
    if (state is None or state.state != RUNNING) and trial not in workspace.recordings(session):
        with contextlib.suppress(FileFormatError):  # the next run repairs the damage
            curves_anew(workspace.trial(session, trial), workspace.out)
            cycles = cycles_in(folder / CURVES_FILE)
    return {
        "events": None if events is None else plain_events(events),
        "version": events_version(events),
        "cycles": cycles,
        **disagreement(changed.differences),
    }


def cycles_in(curves: Path) -> list[int]:
    """Counts of cycles of the right and of the left foot in a file of curves.

    Raises:
        FileFormatError: The file is missing or damaged.
    """
    table = read_curves(curves).group_by("side").aggregate([("cycle", "max")]).to_pydict()
    found = dict(zip(table["side"], table["cycle_max"], strict=True))
    return [found.get(side, 0) for side in SIDES]
