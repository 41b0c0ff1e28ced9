"""Requests about a trial that was run: its report."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from mbkf.app import pages
from mbkf.app.replies import asked, page
from mbkf.app.workspace import Workspace


def trial_routes(workspace: Workspace) -> list[Route]:
    """Pages about a trial."""

    async def shown(request: Request) -> Response:
        make = pages.LOOKS.get(request.path_params["look"])
        if make is None:
            return PlainTextResponse("Nothing is here.\n", status_code=404)
        session, trial = asked(request, "session"), asked(request, "trial")
        return await page(lambda: make(workspace.result(session, trial), workspace.events(session, trial)))

    return [Route("/trial/{look}", shown)]
