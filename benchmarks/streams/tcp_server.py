"""A simulated server over TCP: it accepts clients, splits what they send into packets, and forgets those that leave."""

from __future__ import annotations

import socket
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Generic, TypeVar

HEAD, LARGEST = 8, 1 << 20
"""Bytes of a packet's head, and most of a client's packet."""


@dataclass(eq=False)
class Connected:
    """A connected client: its socket, and a lock that keeps packets apart."""

    connection: socket.socket
    lock: threading.Lock = field(default_factory=threading.Lock, kw_only=True)


ClientT = TypeVar("ClientT", bound=Connected)


class TcpServer(ABC, Generic[ClientT]):
    """A listening server.

    Attributes:
        tcp_port: The port at which it listens.
    """

    def __init__(self, name: str, address: str, port: int, kind: type[ClientT]) -> None:
        """Listens; clients are accepted after :meth:`start`.

        Args:
            name: Name of its threads.
            address: Address of this computer.
            port: The port; 0 for any free one.
            kind: Record of a client.
        """
        self._name, self._kind = name, kind
        self._clients: list[ClientT] = []
        self._lock, self._closed = threading.Lock(), threading.Event()
        self._threads: list[threading.Thread] = []
        self._listener = socket.create_server((address, port))
        self.tcp_port = int(self._listener.getsockname()[1])

    def start(self) -> None:
        """Accepts clients from here on."""
        self._run(self._accept)

    def clients(self) -> list[ClientT]:
        """Clients that are connected."""
        with self._lock:
            return list(self._clients)

    def raw(self, client: ClientT, data: bytes) -> None:
        """Sends bytes, whatever they are; a client that is gone is forgotten."""
        try:
            with client.lock:
                client.connection.sendall(data)
        except OSError:
            self._forget(client)

    def raw_to_all(self, data: bytes) -> None:
        """Sends bytes over every connection."""
        for one in self.clients():
            self.raw(one, data)

    def close(self) -> None:
        """Ends all connections."""
        self._closed.set()
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for one in self.clients():
            self._forget(one)
        for thread in list(self._threads):
            thread.join(5.0)

    @abstractmethod
    def greet(self, client: ClientT) -> None:
        """Sends what a new client is sent first."""

    @abstractmethod
    def size(self, head: bytes) -> int:
        """Bytes of the packet that begins with this head, the head's among them."""

    @abstractmethod
    def obey(self, client: ClientT, packet: bytes) -> None:
        """Does what a whole packet of a client asks for."""

    def _run(self, work: Callable[..., None], *args: object) -> None:
        thread = threading.Thread(target=work, args=args, name=self._name, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _accept(self) -> None:
        while not self._closed.is_set():
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            client = self._kind(connection)
            with self._lock:
                self._clients.append(client)
            self._run(self._serve, client)

    def _serve(self, client: ClientT) -> None:
        received = b""
        try:
            self.greet(client)
            while data := client.connection.recv(65536):
                received += data
                while len(received) >= HEAD:
                    size = self.size(received[:HEAD])
                    if not HEAD <= size <= LARGEST:
                        return
                    if len(received) < size:
                        break
                    packet, received = received[:size], received[size:]
                    self.obey(client, packet)
        except OSError:
            return
        finally:
            self._forget(client)

    def _forget(self, client: ClientT) -> None:
        with self._lock:
            if client in self._clients:
                self._clients.remove(client)
        with suppress(OSError):
            client.connection.shutdown(socket.SHUT_RDWR)
        client.connection.close()
