"""The page's server, on this computer's own address alone: pages, plain data, files that are dropped.

Every request must name this computer as it names itself, must not come from another web page, and must carry the token,
which the address that is opened first brings and a cookie keeps.
"""

from __future__ import annotations

import contextlib
import secrets
import socket
import threading
import time
from collections.abc import Awaitable, Callable
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.base import BaseHTTPMiddleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route

from mbkf.app import answers, pages
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.loopback import LOOPBACK, is_page_of, is_token, names_this_computer

COOKIE = "mbkf-app-{port}"
"""Cookies of one computer are the same for all ports."""

START_S = 10.0

Next = Callable[[Request], Awaitable[Response]]


class AppServer:
    """Serves the page until it is closed.

    Attributes:
        url: What to open, token included.
        port: Where it listens.
    """

    def __init__(self, folder: Path, port: int = 0, workers: int | None = None) -> None:
        """Listens, and takes up runs that were not finished.

        Args:
            folder: The folder with the sessions; made where missing.
            port: 0 for any that is free.
            workers: Processes of a run; by default as many as this computer has processors.

        Raises:
            InvalidInput: The port cannot be listened on.
            OSError: The folder cannot be made.
        """
        self.workspace = Workspace(folder)
        self._token = secrets.token_urlsafe(16)
        self._socket = _listening(port)
        self.port = int(self._socket.getsockname()[1])
        self.runs = Runs(self.workspace, workers)
        config = uvicorn.Config(
            application(self.workspace, self.runs, self._token, COOKIE.format(port=self.port)),
            log_level="critical",
            http="h11",
            ws="none",
            lifespan="off",
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(
            target=self._server.run, kwargs={"sockets": [self._socket]}, name="mbkf-app", daemon=True
        )
        self._thread.start()
        until = time.monotonic() + START_S
        while not self._server.started and self._thread.is_alive() and time.monotonic() < until:
            time.sleep(0.01)
        if not self._server.started:
            self.close()
            raise InvalidInput("the page's server did not start")
        self.url = f"http://{LOOPBACK}:{self.port}/?token={self._token}"

    def wait(self) -> None:
        """Returns when the server was closed; an interrupt from the keyboard comes through."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def close(self) -> None:
        """Ends server and runs; the next one takes up what was not finished."""
        self._server.should_exit = True
        self.runs.close()
        self._thread.join(timeout=10.0)
        with contextlib.suppress(OSError):
            self._socket.close()


def application(workspace: Workspace, runs: Runs, token: str, cookie: str) -> Starlette:
    """The pages and what they ask for.

    Args:
        workspace: The sessions.
        runs: Their runs.
        token: What every request must carry.
        cookie: Name of the cookie that carries it.
    """

    async def told(answer: Callable[[], object]) -> Response:
        """An answer as JSON; a foreseen failure as one sentence."""
        try:
            return JSONResponse(await run_in_threadpool(answer))
        except MbkfError as error:
            return JSONResponse({"trouble": " ".join(str(error).split())}, status_code=400)
        except OSError as error:
            return JSONResponse({"trouble": error.strerror or str(error)}, status_code=500)

    async def all_sessions(_request: Request) -> Response:
        return await told(lambda: answers.sessions(workspace, runs))

    async def one_session(request: Request) -> Response:
        name = request.query_params.get("session", "")
        if request.method == "POST":
            try:
                said = await request.json()
            except (ValueError, RecursionError):
                return JSONResponse({"trouble": "the page said something that is no JSON"}, status_code=400)

            def state() -> object:
                answers.stated(workspace, name, said)
                return answers.session(workspace, runs, name)

            return await told(state)
        return await told(lambda: answers.session(workspace, runs, name))

    async def run(request: Request) -> Response:
        name, what = request.query_params.get("session", ""), request.query_params.get("do", "start")

        def do() -> object:
            workspace.folder(name)
            (runs.start if what == "start" else runs.cancel)(name)
            return {"run": answers.run_state(runs.state(name))}

        return await told(do)

    async def put(request: Request) -> Response:
        name = request.query_params.get("file", "")
        try:
            with workspace.putting(name) as file:
                async for chunk in request.stream():
                    file.write(chunk)
        except MbkfError as error:
            return JSONResponse({"trouble": str(error)}, status_code=400)
        return JSONResponse({"put": name})

    async def shown(request: Request) -> Response:
        """A page about a trial: its playback or its report."""
        session, trial = (request.query_params.get(key, "") for key in ("session", "trial"))
        make = pages.LOOKS.get(request.path_params["look"])
        if make is None:
            return PlainTextResponse("Nothing is here.\n", status_code=404)
        try:
            text = await run_in_threadpool(lambda: make(workspace.result(session, trial)))
        except MbkfError as error:
            return PlainTextResponse(str(error), status_code=404)
        return HTMLResponse(text)

    async def start(_request: Request) -> Response:
        return HTMLResponse(pages.start_page())

    return Starlette(
        routes=[
            Route("/", start),
            Route("/sessions", all_sessions),
            Route("/session", one_session, methods=["GET", "POST"]),
            Route("/run", run, methods=["POST"]),
            Route("/put", put, methods=["POST"]),
            Route("/trial/{look}", shown),
        ],
        middleware=[Middleware(_Guard, token=token, cookie=cookie)],
    )


class _Guard(BaseHTTPMiddleware):
    """Refuses what other names, other web pages or strangers ask for."""

    def __init__(self, app: object, token: str, cookie: str) -> None:
        super().__init__(app)  # type: ignore[arg-type]
        self._token, self._cookie = token, cookie

    async def dispatch(self, request: Request, call_next: Next) -> Response:
        """The answer, or a refusal."""
        host, origin = request.headers.get("host", ""), request.headers.get("origin")
        if not names_this_computer(host) or not is_page_of(origin, host):
            return PlainTextResponse("Refused.\n", status_code=403)
        if request.url.path == "/" and is_token(request.query_params.get("token", ""), self._token):
            opened = RedirectResponse("/", status_code=303)
            opened.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            return opened
        if not is_token(request.cookies.get(self._cookie, ""), self._token):
            return PlainTextResponse("Open the address that mbkf app printed.\n", status_code=403)
        answer = await call_next(request)
        answer.headers["Cache-Control"] = "no-store"
        answer.headers["X-Content-Type-Options"] = "nosniff"
        answer.headers["Referrer-Policy"] = "no-referrer"
        answer.headers["X-Frame-Options"] = "SAMEORIGIN"
        return answer


def _listening(port: int) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((LOOPBACK, port))
    except (OSError, OverflowError) as error:
        made.close()
        raise InvalidInput(f"the page cannot be served at port {port} ({error}); choose another") from error
    return made
