"""Requests about a session's marker set: the page on which it is changed, and what that page says."""

from __future__ import annotations

import json

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from mbkf.app.marker_sets import MarkerSets
from mbkf.app.replies import asked, page, told
from mbkf.app.workspace import Workspace


def marker_set_routes(workspace: Workspace) -> list[Route]:
    """The editor's page and what it says."""
    sets = MarkerSets(workspace)

    async def edit(request: Request) -> Response:
        return await page(lambda: sets.open(asked(request, "session")))

    async def say(request: Request) -> Response:
        word = (await request.body()).decode("utf-8", errors="replace")
        return await told(lambda: json.loads(sets.say(asked(request, "session"), word)))

    return [Route("/marker_set", edit), Route("/marker_set/say", say, methods=["POST"])]
