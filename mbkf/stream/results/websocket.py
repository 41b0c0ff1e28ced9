"""Results as JSON over WebSocket: a greeting with names and units, then the newest frame again and again.

A frame holds the running verdict's word; the first one that a client gets after the judgement changed holds all of it.
"""

from __future__ import annotations

import hmac
import json
import secrets
import threading
from http import HTTPStatus
from urllib.parse import parse_qs, urlparse

from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve

from mbkf.errors import InvalidInput
from mbkf.stream.loopback import LOOPBACK, is_loopback, own_request
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.results.message import frame_message
from mbkf.stream.results.sending import SendingThread
from mbkf.stream.results.values import ResultValues

WAIT_S = 0.5
SENT_FRAMES = 8
"""Frames that may wait to be made into text."""


def parse_address(text: str, option: str = "--websocket") -> tuple[str, int]:
    """Address and port of ``[ADDRESS:]PORT``.

    Args:
        text: Address and port.
        option: The option that holds them, for the message.

    Raises:
        InvalidInput: It is not of that form.
    """
    address, _, port = text.rpartition(":")
    if not port.isdigit() or int(port) > 65535:
        raise InvalidInput(f"{option} '{text}': write PORT or ADDRESS:PORT")
    return address or LOOPBACK, int(port)


class WebSocketResults:
    """A :class:`mbkf.stream.results.frame.FrameSink`. A slow client gets the newest frame and misses others.

    Attributes:
        url: Where to listen, with the token where one is needed.
    """

    def __init__(self, values: ResultValues, address: str, port: int, token: str | None = None) -> None:
        """Listens for clients.

        Args:
            values: Makes the numbers; receivers of one run share it.
            address: Address to listen on.
            port: Port to listen on; 0 for any that is free.
            token: Secret that clients have to send. Addresses other than this computer's own always need one; it is
                made up where none is given.

        Raises:
            InvalidInput: The address or port cannot be listened on.
        """
        self._local = is_loopback(address)
        self._token = token if self._local else token or secrets.token_urlsafe(16)
        self._values = values
        self._changed = threading.Condition()
        self._newest, self._count, self._closed = "", 0, False
        self._judgement: Judgement | None = None
        self._judged, self._judged_count = "", 0
        try:
            self._server = serve(
                self._serve,
                address,
                port,
                process_request=self._check,
                compression=None,
            )
        except (OSError, OverflowError) as error:
            raise InvalidInput(f"--websocket: cannot listen on {address}, port {port} ({error})") from error
        host, taken = self._server.socket.getsockname()[:2]
        query = f"?token={self._token}" if self._token else ""
        self.url = f"ws://{host}:{taken}/{query}"
        self._thread = threading.Thread(target=self._server.serve_forever, name="mbkf-websocket", daemon=True)
        self._thread.start()
        self._sending = SendingThread(self._prepare, "mbkf-websocket-json", SENT_FRAMES)

    def take(self, frame: LiveFrame) -> None:
        """Hands the frame over."""
        self._sending.take(frame)

    def close(self) -> None:
        """Ends the server and its connections."""
        self._sending.close()
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._server.shutdown()
        self._thread.join(timeout=5.0)

    def _check(self, _connection: ServerConnection, request: Request) -> Response | None:
        """Refuses requests of other web pages, and clients without the token."""
        headers = request.headers
        if not own_request(headers.get("Host", ""), headers.get("Origin"), self._local, any_port=True):
            return _connection.respond(HTTPStatus.FORBIDDEN, "another web page may not listen\n")
        if self._token is None:
            return None
        given = parse_qs(urlparse(request.path).query).get("token", [""])[0]
        if hmac.compare_digest(given.encode(), self._token.encode()):
            return None
        return _connection.respond(HTTPStatus.FORBIDDEN, "a token is needed\n")

    def _serve(self, connection: ServerConnection) -> None:
        greeting = {"names": self._values.names, "units": self._values.units}
        sent = told = 0
        try:
            connection.send(json.dumps(greeting))
            while True:
                with self._changed:
                    if not self._closed and self._count == sent:
                        self._changed.wait(WAIT_S)
                    if self._closed:
                        return
                    fresh, text = self._count > sent, self._newest
                    sent = self._count
                    if fresh and self._judged_count > told:
                        told = self._judged_count
                        text = f'{text[:-1]}, "judgement": {self._judged}}}'
                if fresh:
                    connection.send(text)
        except ConnectionClosed:
            return

    def _prepare(self, frame: LiveFrame) -> None:
        text = json.dumps(frame_message(frame, self._values.row(frame)))
        changed = frame.judgement is not None and frame.judgement is not self._judgement
        judged = json.dumps(frame.judgement.plain()) if changed and frame.judgement is not None else ""
        with self._changed:
            if changed:
                self._judgement, self._judged = frame.judgement, judged
                self._judged_count += 1
            self._newest, self._count = text, self._count + 1
            self._changed.notify_all()
