"""Requests about the live run: what it can be made of, its start and end, how far it is, and its page in a frame."""

from __future__ import annotations

import time
from dataclasses import asdict

from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from mbkf.app.live_command import live_offer, live_options, recording_folder
from mbkf.app.live_run import LiveRun, LiveState
from mbkf.app.replies import asked, said, told
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError
from mbkf.stream.loopback import LOOPBACK
from mbkf.stream.lsl.discovery import marker_streams
from mbkf.viz.page import asset


def live_routes(workspace: Workspace, live: LiveRun) -> list[Route]:
    """What the page asks of live runs.

    Args:
        workspace: The sessions.
        live: The run.
    """

    async def offered(request: Request) -> Response:
        name = asked(request, "session")
        return await told(lambda: {**live_offer(workspace, name), "run": _plain(live.state())})

    async def state(_request: Request) -> Response:
        return await told(lambda: {"run": _plain(live.state())})

    def stop() -> object:
        live.stop()
        return {"run": _plain(live.state())}

    async def change(request: Request) -> Response:
        name = asked(request, "session")
        if asked(request, "do") == "stop":
            return await told(stop)
        try:
            wanted = await said(request)
        except MbkfError as error:
            return JSONResponse({"trouble": str(error)}, status_code=400)

        def start() -> object:
            options = live_options(workspace, name, wanted)
            folder = recording_folder(workspace, name, time.strftime("%Y-%m-%d-%H%M%S"))
            live.start(name, options, folder)
            return {"run": _plain(live.state())}

        return await told(start)

    async def streams(_request: Request) -> Response:
        return await told(lambda: {"streams": [asdict(one) for one in marker_streams()]})

    async def page(_request: Request) -> Response:
        now = live.state()
        if now is None or not now.goes_on or now.port is None:
            return PlainTextResponse("No live run has a page now.\n", status_code=404)
        return HTMLResponse(frame_page(now.port))

    return [
        Route("/live", offered, methods=["GET"]),
        Route("/live", change, methods=["POST"]),
        Route("/live/state", state),
        Route("/live/streams", streams),
        Route("/live/page", page),
    ]


def frame_page(port: int) -> str:
    """A page that holds the live page in a frame, and may hold nothing else.

    Args:
        port: Of the live page, at this computer's own address.
    """
    return asset("app_live.html").replace("{{address}}", f"http://{LOOPBACK}:{port}")


def _plain(state: LiveState | None) -> dict[str, object] | None:
    return None if state is None else {**asdict(state), "goes_on": state.goes_on}
