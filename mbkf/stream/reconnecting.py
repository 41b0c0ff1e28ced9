"""A source at a vendor's server, whose connection is made anew when it breaks off or falls silent."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import Generic, Protocol, TypeVar, cast

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream.known import KnownStream

RECONNECT_AFTER_S, AGAIN_S = 3.0, 0.5
"""After so long without a packet the connection is made anew; attempts are so far apart."""


class Arrived(Protocol):
    """A packet with the time of its arrival on the clock of ``time.perf_counter``."""

    @property
    def arrival_s(self) -> float:
        """When it arrived."""


PacketT = TypeVar("PacketT", bound=Arrived)


class Client(Protocol):
    """A connection to a server."""

    def take(self, timeout_s: float) -> object:
        """The next packet; None where none comes in time."""

    def close(self) -> None:
        """Ends the connection."""


ClientT = TypeVar("ClientT", bound=Client)


class ReconnectingSource(ABC, Generic[ClientT, PacketT]):
    """The connection of a :class:`mbkf.stream.source.FrameSource`.

    Attributes:
        receiving: True from the first read on, when frames are asked for.
    """

    patient = False

    def __init__(self, program: str) -> None:
        """A source that is not connected yet.

        Args:
            program: Name of the server's program, for events.
        """
        self._program = program
        self._client: ClientT | None = None
        self._known: KnownStream | None = None
        self._heard_s = self._tried_s = 0.0
        self._lost = self.receiving = False
        self._news: list[tuple[str, str]] = []
        self._reported: set[str] = set()

    @property
    def connected(self) -> bool:
        """True while the server is connected."""
        return self._client is not None

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news, self._news = self._news, []
        return news

    def close(self) -> None:
        """Ends the connection."""
        if self._client is not None:
            self._client.close()
            self._client = None

    @abstractmethod
    def _open(self) -> ClientT:
        """A new connection.

        Raises:
            OSError: The server is not there.
            InvalidInput: Another server answers.
        """

    @abstractmethod
    def _resume(self, client: ClientT) -> None:
        """Asks over a new connection for all that the one before had been asked for."""

    def _next(self, client: ClientT, timeout_s: float) -> PacketT | None:
        """The next packet of a connection; raises as the client's ``take``."""
        return cast(PacketT | None, client.take(timeout_s))

    def _take(self, timeout_s: float) -> PacketT | None:
        """The next packet; a connection that broke off is made anew.

        Raises:
            InvalidInput: Another server answers the first connection.
        """
        now = time.perf_counter()
        if self._client is None:
            if now - self._tried_s < AGAIN_S:
                time.sleep(min(timeout_s, AGAIN_S - (now - self._tried_s)))
            else:
                self._connect_again(now)
            return None
        try:
            found = self._next(self._client, timeout_s)
        except (OSError, InvalidPacket) as error:
            self._lose(str(error))
            return None
        if found is not None:
            self._heard_s = found.arrival_s
        elif now - self._heard_s > RECONNECT_AFTER_S:
            self._lose("it is silent")
        return found

    def _lose(self, why: str) -> None:
        """Lets go of a connection that cannot be used."""
        if not self._lost and self._known is not None:
            self._news.append(
                ("connection", f"the connection to {self._program} broke off and is made anew ({why})")
            )
        self._lost = True
        if self._client is not None:
            self._client.close()
            self._client = None

    def _connect_again(self, now: float) -> None:
        self._tried_s = now
        try:
            self._client = self._open()
        except OSError:
            return
        except InvalidInput as error:
            if self._known is None:
                raise
            self._report("refused", f"{self._program} cannot be connected to again ({error})")
            return
        self._heard_s = time.perf_counter()
        self._resume(self._client)
        if self._client is None:
            return
        if self._lost and self._known is not None:
            self._news.append(("connection", f"the connection to {self._program} is back"))
        self._lost = False

    def _report(self, kind: str, sentence: str) -> None:
        """An event; of each kind the first one."""
        if kind not in self._reported:
            self._reported.add(kind)
            self._news.append((kind, sentence))
