"""Requests of the page on which a trial is looked at: the page, another trial's frames, and events by hand."""

from __future__ import annotations

import contextlib
from pathlib import Path

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from mbkf.app.look_page import look_data, look_page
from mbkf.app.replies import asked, page, said, told
from mbkf.app.runs import RUNNING, Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.session import FootEvent, plain_events, session_of
from mbkf.study.batch.curves import SIDES, read_curves
from mbkf.study.batch.trial import CURVES_FILE, curves_anew

MOST_EVENTS = 100_000
"""Events of one trial that are taken; an hour of running has a quarter of them."""


def look_routes(workspace: Workspace, runs: Runs) -> list[Route]:
    """The page and what it asks for.

    Args:
        workspace: The sessions.
        runs: Their runs; while a session is run, its curves are left to them.
    """

    def data(session: str, trial: str) -> dict[str, object]:
        return look_data(workspace.result(session, trial), workspace.events(session, trial))

    async def shown(request: Request) -> Response:
        session, trial = asked(request, "session"), asked(request, "trial")

        def make() -> str:
            others = [name for name in workspace.with_results(session) if name != trial]
            return look_page(session, trial, others, data(session, trial))

        return await page(make)

    async def frames(request: Request) -> Response:
        return await told(lambda: data(asked(request, "session"), asked(request, "trial")))

    async def events(request: Request) -> Response:
        session, trial = asked(request, "session"), asked(request, "trial")
        try:
            stated = events_said(await said(request))
        except MbkfError as error:
            return JSONResponse({"trouble": " ".join(str(error).split())}, status_code=400)
        return await told(lambda: state_events(workspace, runs, session, trial, stated))

    return [
        Route("/trial/look", shown),
        Route("/trial/recording", frames),
        Route("/trial/events", events, methods=["POST"]),
    ]


def events_said(plain: object) -> tuple[FootEvent, ...] | None:
    """The events that a page says, under "events"; None for those that are found.

    Raises:
        InvalidInput: Nothing is said of events, or there are too many.
        FileFormatError: An entry is not possible.
    """
    if not isinstance(plain, dict) or "events" not in plain:
        raise InvalidInput("the page said nothing of events")
    listed = plain["events"]
    if listed is None:
        return None
    if isinstance(listed, list) and len(listed) > MOST_EVENTS:
        raise InvalidInput(f"{len(listed)} events are more than {MOST_EVENTS}")
    return session_of({"trial": {"it": {"event": listed}}}).trial("it").events


def state_events(
    workspace: Workspace, runs: Runs, session: str, trial: str, events: tuple[FootEvent, ...] | None
) -> dict[str, object]:
    """Writes a trial's events into its session file, and makes its curves again.

    Args:
        workspace: The sessions.
        runs: Their runs.
        session: The trial's session.
        trial: Whose events they are.
        events: By hand; None for those that are found.

    Returns:
        ``events`` as they stand in the file now; ``cycles``: how many the right and the left foot have in the new
        curves; None where these are left to the next run, since one is under way or the result is of an older kind,
        and for a live recording.

    Raises:
        InvalidInput: The session does not exist, or no result of the trial.
        FileFormatError: The session file is damaged.
        OSError: A file cannot be written.
    """
    folder = workspace.result(session, trial)
    workspace.note_events(session, trial, events)
    state = runs.state(session)
    cycles = None
    if (state is None or state.state != RUNNING) and trial not in workspace.recordings(session):
        with contextlib.suppress(FileFormatError):  # the next run sees the damage, and mends it
            curves_anew(workspace.trial(session, trial), workspace.out)
            cycles = cycles_in(folder / CURVES_FILE)
    return {"events": None if events is None else plain_events(events), "cycles": cycles}


def cycles_in(curves: Path) -> list[int]:
    """How many cycles of the right and of the left foot a file of curves holds.

    Raises:
        FileFormatError: It is missing or damaged.
    """
    table = read_curves(curves).group_by("side").aggregate([("cycle", "max")]).to_pydict()
    found = dict(zip(table["side"], table["cycle_max"], strict=True))
    return [found.get(side, 0) for side in SIDES]
