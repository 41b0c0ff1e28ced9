"""The server of the laboratory's page, at this computer's own address only."""

from __future__ import annotations

import contextlib
import secrets
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware

from mbkf.app.charts import Charts
from mbkf.app.failures import HANDLERS
from mbkf.app.guard import Guard
from mbkf.app.live_run import LiveRun
from mbkf.app.routes import routes
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.stream.loopback import LOOPBACK
from mbkf.viz.admission import Admission

COOKIE = "mbkf-app-{port}"
"""Browsers share the cookies of a computer between its ports, so each port has its own."""

START_S = 10.0

ANSWERS_S = 1
"""Longest wait for answers under way when the server ends."""


class AppServer:
    """Serves the page until it is closed.

    Attributes:
        url: Address to open, token included.
        port: Its port.
    """

    def __init__(
        self, folder: Path, port: int = 0, workers: int | None = None, charts: Charts | None = None
    ) -> None:
        """Begins to listen, and continues unfinished runs.

        Args:
            folder: The folder with the sessions; made where missing.
            port: 0 for any free one.
            workers: Processes of a run; by default one for each processor.
            charts: Choices of charts.

        Raises:
            InvalidInput: The port is not free.
            OSError: The folder cannot be made.
        """
        self.workspace = Workspace(folder, charts)
        self._socket = _listening(port)
        self.port = int(self._socket.getsockname()[1])
        self.runs = Runs(self.workspace, workers)
        self.live = LiveRun()
        self._admission = Admission(secrets.token_urlsafe(16), COOKIE.format(port=self.port))
        guard = Middleware(Guard, admission=self._admission)
        app = Starlette(
            routes=routes(self.workspace, self.runs, self.live),
            middleware=[guard],
            exception_handlers=HANDLERS,
        )
        options: dict[str, Any] = {"log_level": "critical", "http": "h11", "ws": "none", "lifespan": "off"}
        config = uvicorn.Config(app, timeout_graceful_shutdown=ANSWERS_S, **options)
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
        self.url = f"http://{LOOPBACK}:{self.port}/?token={self._admission.token}"

    def entrance(self, used: Callable[[], None]) -> str:
        """An address that admits a browser once; ``used`` is called then."""
        return f"http://{LOOPBACK}:{self.port}/?ticket={self._admission.ticket(used)}"

    def close(self) -> None:
        """Ends server, live run and runs; the next server continues unfinished runs."""
        self._server.should_exit = True
        self.runs.close()
        self.live.close()
        self._thread.join(timeout=10.0)
        with contextlib.suppress(OSError):
            self._socket.close()


def _listening(port: int) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((LOOPBACK, port))
    except (OSError, OverflowError) as error:
        made.close()
        raise InvalidInput(f"the page cannot be served at port {port} ({error}); choose another") from error
    return made
