"""Datagrams at a port of this computer, from one sender at a time, received by the caller that waits for them.

No thread stands between: a handover would cost a loaded computer more than reading a frame. Until the first frame is
asked for, datagrams only pile up in the system; :meth:`Datagrams.drop_waiting` lets go of them.
"""

from __future__ import annotations

import select
import socket
import time
from contextlib import suppress
from typing import NamedTuple

from mbkf.errors import InvalidInput

ROOM_BYTES = 4 * 1024 * 1024
"""Size of the socket's receive buffer, as far as the system allows."""

LARGEST = 65536
"""Bytes of a datagram, at most."""

SILENT_S = 1.0
"""After so long without a message of its sender, a stream is taken from another sender."""

MOST_WAITING = 100_000
"""Datagrams that are let go of at once, at most: a sender may be faster than this computer."""

PAUSE_S = 0.01
"""Pause after an error of the socket, so that one that lasts costs no processor."""

Sender = tuple[str, int]


class Datagram(NamedTuple):
    """A datagram that arrived.

    Attributes:
        arrival_s: When, on the clock of ``time.perf_counter``.
        data: Its bytes.
        sender: Address and port that it came from.
    """

    arrival_s: float
    data: bytes
    sender: Sender


class Datagrams:
    """A bound socket.

    Attributes:
        port: Its port.
        sender: The one whose messages count; None before the first readable message.
        unreadable: How many datagrams could not be read.
    """

    def __init__(self, protocol: str, local: str, port: int) -> None:
        """Binds the socket.

        Args:
            protocol: Name of the protocol, for messages.
            local: Address of this computer.
            port: Port to listen at; 0 for any free one.

        Raises:
            InvalidInput: The address is not of this computer, or the port is taken.
        """
        self._protocol = protocol
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            with suppress(OSError):  # less room where the system gives no more
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM_BYTES)
            self._socket.bind((local, port))
        except (OSError, OverflowError, UnicodeError) as error:
            self._socket.close()
            raise InvalidInput(
                f"{protocol}: port {port} of {local} cannot be listened at ({error}); --local names an address of "
                "this computer, or 0.0.0.0 for all of them"
            ) from error
        self._socket.setblocking(False)
        self.port = int(self._socket.getsockname()[1])
        self.sender: Sender | None = None
        self._heard_s = 0.0
        self.unreadable = 0
        self._news: list[tuple[str, str]] = []
        self._reported: set[str] = set()

    def take(self, timeout_s: float) -> Datagram | None:
        """The next datagram that is not a stranger's; None where none comes."""
        until = time.perf_counter() + timeout_s
        while True:
            found = self._receive(max(0.0, until - time.perf_counter()))
            if found is not None and not self._strange(found):
                return found
            if time.perf_counter() >= until:
                return None

    def heard(self, one: Datagram) -> None:
        """Its sender sent a readable message: from now on it is the stream's."""
        if self.sender is not None and one.sender != self.sender:
            self.report("sender", f"the stream comes from another sender, {_named(one.sender)}")
        self.sender, self._heard_s = one.sender, one.arrival_s

    def refuse(self, reason: object) -> None:
        """Counts a datagram that cannot be read, and reports the first one."""
        self.unreadable += 1
        self.report("packets", f"{self._protocol}: messages that cannot be read are left out ({reason})")

    def report(self, kind: str, sentence: str) -> None:
        """An event of the stream; of each kind the first one."""
        if kind not in self._reported:
            self._reported.add(kind)
            self._news.append((kind, sentence))

    def news(self) -> list[tuple[str, str]]:
        """Events since the last call."""
        news, self._news = self._news, []
        return news

    def drop_waiting(self) -> None:
        """Lets go of the datagrams that wait in the system."""
        for _ in range(MOST_WAITING):
            try:
                self._socket.recv(LARGEST)
            except OSError:  # no more
                return

    def close(self) -> None:
        """Listens no more."""
        self._socket.close()

    def _receive(self, timeout_s: float) -> Datagram | None:
        try:
            ready, _, _ = select.select([self._socket], [], [], timeout_s)
            if not ready:
                return None
            data, sender = self._socket.recvfrom(LARGEST)
        except BlockingIOError:
            return None
        except OSError as error:  # the network is gone
            self.report("connection", f"{self._protocol}: receiving failed ({error})")
            time.sleep(min(timeout_s, PAUSE_S))
            return None
        return Datagram(time.perf_counter(), data, (str(sender[0]), int(sender[1])))

    def _strange(self, one: Datagram) -> bool:
        """True for a datagram of another sender while the known one is heard."""
        if self.sender in (None, one.sender) or one.arrival_s - self._heard_s > SILENT_S:
            return False
        self.report("stranger", f"messages of another sender, {_named(one.sender)}, are left out")
        return True


def _named(sender: Sender) -> str:
    return f"{sender[0]}:{sender[1]}"
