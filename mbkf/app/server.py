"""The page's server, on this computer's own address alone: pages, plain data, files that are dropped."""

from __future__ import annotations

import contextlib
import secrets
import socket
import threading
import time
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware

from mbkf.app.export_routes import export_routes
from mbkf.app.guard import Guard
from mbkf.app.live_routes import live_routes
from mbkf.app.live_run import LiveRun
from mbkf.app.look_routes import look_routes
from mbkf.app.marker_set_routes import marker_set_routes
from mbkf.app.report_routes import report_routes
from mbkf.app.runs import Runs
from mbkf.app.session_routes import session_routes
from mbkf.app.trial_routes import trial_routes
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.stream.loopback import LOOPBACK

COOKIE = "mbkf-app-{port}"
"""Cookies of one computer are the same for all ports."""

START_S = 10.0


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
        self.live = LiveRun()
        config = uvicorn.Config(
            application(self.workspace, self.runs, self.live, self._token, COOKIE.format(port=self.port)),
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
        """Ends server, live run and runs; the next one takes up what was not finished."""
        self._server.should_exit = True
        self.live.close()
        self.runs.close()
        self._thread.join(timeout=10.0)
        with contextlib.suppress(OSError):
            self._socket.close()


def application(workspace: Workspace, runs: Runs, live: LiveRun, token: str, cookie: str) -> Starlette:
    """The pages and what they ask for.

    Args:
        workspace: The sessions.
        runs: Their runs.
        live: The live run.
        token: What every request must carry.
        cookie: Name of the cookie that carries it.
    """
    return Starlette(
        routes=[
            *session_routes(workspace, runs),
            *live_routes(workspace, live),
            *export_routes(workspace),
            *look_routes(workspace, runs),
            *trial_routes(workspace),
            *report_routes(workspace),
            *marker_set_routes(workspace),
        ],
        middleware=[Middleware(Guard, token=token, cookie=cookie)],
    )


def _listening(port: int) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((LOOPBACK, port))
    except (OSError, OverflowError) as error:
        made.close()
        raise InvalidInput(f"the page cannot be served at port {port} ({error}); choose another") from error
    return made
