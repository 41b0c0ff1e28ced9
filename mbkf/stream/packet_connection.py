"""A TCP connection to a vendor's server, over which packets that state their own size come."""

from __future__ import annotations

import select
import socket
from contextlib import suppress

from mbkf.errors import InvalidInput

CONNECT_S, ANSWER_S = 0.5, 3.0
"""Longest wait for a connection, and for an answer or for room to send."""

CHUNK = 262_144
"""Most bytes that one read takes."""


class PacketConnection:
    """A connection.

    Attributes:
        socket: The socket, which does not block.
        received: Bytes that no whole packet has been taken from yet.
    """

    def __init__(self, host: str, port: int, ended: str) -> None:
        """Connects.

        Args:
            host: The server's computer.
            port: Its port.
            ended: Sentence for a connection that the server ends.

        Raises:
            OSError: The server is not there.
            InvalidInput: No computer can have this name.
        """
        self._ended = ended
        self.received = bytearray()
        try:
            self.socket = socket.create_connection((host, port), CONNECT_S)
        except UnicodeError as error:
            raise InvalidInput(
                f"'{host}' is neither an address nor a computer's name; write it as in 192.168.1.10"
            ) from error
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.setblocking(False)

    def send(self, data: bytes) -> None:
        """Sends bytes.

        Raises:
            OSError: The connection broke off, or the server takes nothing for :data:`ANSWER_S`.
        """
        self.socket.settimeout(ANSWER_S)
        try:
            self.socket.sendall(data)
        finally:
            self.socket.setblocking(False)

    def wait(self, timeout_s: float, beside: socket.socket | None = None) -> list[socket.socket]:
        """Those of the connection's socket and another one that have something to read in time."""
        sockets = [self.socket] if beside is None else [self.socket, beside]
        ready, _, _ = select.select(sockets, [], [], timeout_s)
        return ready

    def receive(self) -> None:
        """Takes the bytes that are there.

        Raises:
            OSError: The connection broke off, or the server ended it.
        """
        data = self.socket.recv(CHUNK)
        if not data:
            raise ConnectionResetError(self._ended)
        self.received += data

    def close(self) -> None:
        """Ends the connection."""
        with suppress(OSError):
            self.socket.close()
