"""Requests about sessions: the list, one of them, its run, and files that are dropped."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from mbkf.app import answers, pages
from mbkf.app.replies import asked, said, told
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError


def session_routes(workspace: Workspace, runs: Runs) -> list[Route]:
    """The start page and what it asks for."""

    async def start(_request: Request) -> Response:
        return HTMLResponse(pages.start_page())

    async def all_sessions(_request: Request) -> Response:
        return await told(lambda: answers.sessions(workspace, runs))

    async def one_session(request: Request) -> Response:
        return await told(lambda: answers.session(workspace, runs, asked(request, "session")))

    async def state_session(request: Request) -> Response:
        name = asked(request, "session")
        try:
            stated = await said(request)
        except MbkfError as error:
            return JSONResponse({"trouble": str(error)}, status_code=400)

        def state() -> object:
            answers.stated(workspace, name, stated)
            return answers.session(workspace, runs, name)

        return await told(state)

    async def run(request: Request) -> Response:
        name = asked(request, "session")

        def do() -> object:
            workspace.folder(name)
            (runs.cancel if asked(request, "do") == "cancel" else runs.start)(name)
            return {"run": answers.run_state(runs.state(name))}

        return await told(do)

    async def put(request: Request) -> Response:
        name = asked(request, "file")
        try:
            with workspace.putting(name) as file:
                async for chunk in request.stream():
                    file.write(chunk)
        except MbkfError as error:
            return JSONResponse({"trouble": str(error)}, status_code=400)
        return JSONResponse({"put": name})

    return [
        Route("/", start),
        Route("/sessions", all_sessions),
        Route("/session", one_session, methods=["GET"]),
        Route("/session", state_session, methods=["POST"]),
        Route("/run", run, methods=["POST"]),
        Route("/put", put, methods=["POST"]),
    ]
