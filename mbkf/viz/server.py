"""A small web server for one page, in a thread of its own: the page's text, and a WebSocket for rows and requests.

It listens to this computer only, unless another address is given; then every request must carry the token. Requests
from another web page or with another host name are refused.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
import socket
import threading
from collections.abc import Callable
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from mbkf.errors import InvalidInput
from mbkf.io.utf8 import encoded
from mbkf.stream.loopback import LOOPBACK, is_loopback, own_request
from mbkf.viz.admission import ADMITTED, Admission

HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Connection": "close",
}

COOKIE = "mbkf-page-{port}"
"""Browsers share the cookies of a computer between its ports, so each port has its own."""

SEND_PERIOD_S = 1.0 / 30.0
LONGEST_SLEEP_S = 0.2
STOP_S = 3.0

Newest = Callable[[], tuple[int, bytes] | None]
"""Returns the newest row and its number, or None without rows; called at most 30 times a second per open page."""

News = Callable[[], tuple[int, str] | None]
"""Returns the newest text for open pages and its number, or None without one; asked as often as rows are."""

Hear = Callable[[str], str]
"""Takes a request of a page and returns the reply; called in a thread, one request after another per open page."""


class PageServer:
    """Serves one page until it is closed.

    Args:
        text: The page.
        greeting: First message of the WebSocket.
        newest: Source of rows; None for a page without a stream.
        news: Source of text that goes with the rows; None for a page without such.
        hear: Replies to requests over the WebSocket; None for a page without requests.
        address: Address to listen at.
        port: 0 for any free one.
        token: Secret of every request; by default a random one where the address is not this computer's own.

    Attributes:
        url: Address to open, token included.
        port: Its port.
        token: Secret of every request; empty if none is needed.

    Raises:
        InvalidInput: The address or port cannot be used.
    """

    def __init__(
        self,
        text: str,
        *,
        greeting: str = "",
        newest: Newest | None = None,
        news: News | None = None,
        hear: Hear | None = None,
        address: str = LOOPBACK,
        port: int = 0,
        token: str | None = None,
    ) -> None:
        self._text, self._greeting, self._newest = encoded(text), greeting, newest
        self._news, self._hear = news, hear
        self._local = is_loopback(address)
        self.token = token or ("" if self._local else secrets.token_urlsafe(16))
        self._admission: Admission | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._stop: asyncio.Event | None = None
        self._fresh = asyncio.Event()
        self._asleep = False
        self._listening, self._freed = threading.Event(), threading.Event()
        self._failure: OSError | None = None
        self.port = 0
        self._thread = threading.Thread(target=self._run, args=(address, port), name="mbkf page", daemon=True)
        self._thread.start()
        self._listening.wait()
        if self._failure is not None:
            raise InvalidInput(
                f"the page cannot be served at {address}:{port} ({self._failure.strerror or self._failure}); "
                "choose another address or port"
            )
        host = socket.gethostname() if address in ("0.0.0.0", "::", "") else address
        self._address = f"http://{f'[{host}]' if ':' in host else host}:{self.port}/"
        self.url = self._address + ("?" + urlencode({"token": self.token}) if self.token else "")

    def entrance(self, used: Callable[[], None]) -> str:
        """An address that admits a browser once; ``used`` is called then, or at once for a page without a token."""
        if not self.token or self._admission is None:
            return self._address
        return self._address + "?" + urlencode({"ticket": self._admission.ticket(used)})

    def close(self) -> None:
        """Ends all connections and the thread."""
        if self._end():
            self._thread.join(STOP_S)

    def free(self) -> None:
        """Frees the port at once for another server; connections and thread end soon after."""
        if self._end():
            self._freed.wait(STOP_S)

    def _end(self) -> bool:
        """Asks the thread to end; False if it has ended."""
        if self._loop is None or self._stop is None or not self._thread.is_alive():
            return False
        with contextlib.suppress(RuntimeError):  # the loop has just been closed
            self._loop.call_soon_threadsafe(self._stop.set)
        return True

    def wake(self) -> None:
        """Announces a new row, so that it is made now and not during the next frame."""
        if self._asleep and self._loop is not None:
            self._asleep = False
            with contextlib.suppress(RuntimeError):  # the server has just ended
                self._loop.call_soon_threadsafe(self._fresh.set)

    def wait(self) -> None:
        """Waits until the server is closed, or Ctrl-C."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def _run(self, address: str, port: int) -> None:
        try:
            asyncio.run(self._serve(address, port))
        except OSError as error:
            self._failure = error
        finally:
            self._listening.set()
            self._freed.set()

    async def _serve(self, address: str, port: int) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        quiet = logging.Logger("mbkf page", logging.CRITICAL)
        async with serve(
            self._stream, address, port, process_request=self._answer, compression=None, logger=quiet,
            close_timeout=0.5,
        ) as server:  # fmt: skip
            self.port = next(iter(server.sockets)).getsockname()[1]
            self._admission = Admission(self.token, COOKIE.format(port=self.port))
            self._listening.set()
            await self._stop.wait()
            server.close()
            await asyncio.sleep(0)  # closing begins with freeing the port
            self._freed.set()

    def _answer(self, _connection: ServerConnection, request: Request) -> Response | None:
        """The page, a refusal, or None to open the WebSocket."""
        url = urlsplit(request.path)
        words = parse_qs(url.query)
        token, ticket = (words.get(name, [""])[0] for name in ("token", "ticket"))
        admission = self._admission
        if admission is None or not self._own(request):
            return _refused()
        if url.path == "/" and ticket and admission.admit(ticket):
            return _admitted(admission)
        if not (admission.is_token(token) or admission.has_cookie(request.headers.get("Cookie", ""))):
            return _refused()
        if url.path == "/frames" and not (self._newest is None and self._hear is None):
            return None
        if url.path == "/" and token and "text/html" in request.headers.get("Accept", ""):
            return _admitted(admission)  # a browser keeps no address with the token
        if url.path == "/":
            return _response(HTTPStatus.OK, self._text, "text/html; charset=utf-8")
        return _response(HTTPStatus.NOT_FOUND, b"Nothing is here.\n")

    def _own(self, request: Request) -> bool:
        """True for a request that no other web page caused."""
        return own_request(request.headers.get("Host", ""), request.headers.get("Origin"), self._local)

    async def _stream(self, connection: ServerConnection) -> None:
        """Sends each newest row; a slow page gets fewer rows, never old ones."""
        if self._newest is None:
            await self._converse(connection)
            return
        closed = asyncio.ensure_future(connection.wait_closed())
        sent = told = -1
        try:
            await connection.send(self._greeting)
            while not closed.done():
                text = None if self._news is None else self._news()
                if text is not None and text[0] != told:
                    told = text[0]
                    await connection.send(text[1])
                found = self._newest()
                if found is not None and found[0] != sent:
                    sent = found[0]
                    await connection.send(found[1])
                await asyncio.wait({closed}, timeout=SEND_PERIOD_S)
                await self._woken(closed)
        except ConnectionClosed:
            pass
        finally:
            closed.cancel()

    async def _converse(self, connection: ServerConnection) -> None:
        """Replies to requests until the page closes."""
        assert self._hear is not None
        with contextlib.suppress(ConnectionClosed):
            await connection.send(self._greeting)
            async for word in connection:
                if isinstance(word, str):
                    await connection.send(await asyncio.to_thread(self._hear, word))

    async def _woken(self, closed: asyncio.Future[Any]) -> None:
        """Waits for a new row or the connection's end, at most LONGEST_SLEEP_S."""
        self._fresh.clear()
        self._asleep = True
        fresh: asyncio.Future[Any] = asyncio.ensure_future(self._fresh.wait())
        await asyncio.wait({closed, fresh}, timeout=LONGEST_SLEEP_S, return_when=asyncio.FIRST_COMPLETED)
        fresh.cancel()


def _refused() -> Response:
    return _response(HTTPStatus.FORBIDDEN, b"Refused: open the address that mbkf printed, with its token.\n")


def _admitted(admission: Admission) -> Response:
    reply = _response(HTTPStatus.OK, ADMITTED.encode(), "text/html; charset=utf-8")
    reply.headers["Set-Cookie"] = admission.set_cookie()
    return reply


def _response(status: HTTPStatus, body: bytes, kind: str = "text/plain; charset=utf-8") -> Response:
    headers = Headers({**HEADERS, "Content-Type": kind, "Content-Length": str(len(body))})
    return Response(status.value, status.phrase, headers, body)
