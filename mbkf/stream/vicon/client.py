"""A client of Vicon's DataStream: a TCP connection to Nexus, Tracker, Shogun or Evoke, whose frames come as packets.

The server lists the types of objects that it has, the client those that it wants of them. The client then asks for all
frames from there on (server push), or for one after the other (client pull).
"""

from __future__ import annotations

import time
from collections import deque
from typing import NamedTuple

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream.packet_connection import ANSWER_S, PacketConnection
from mbkf.stream.vicon import objects

PORT = 801
"""Port at which Vicon's programs serve."""

AGAIN_S = 1.0
"""A frame that was asked for and has not come for so long is asked for again."""


class Packet(NamedTuple):
    """A packet that arrived: time on the clock of ``time.perf_counter``, and blocks by type."""

    arrival_s: float
    blocks: dict[int, list[bytes]]


class ViconClient:
    """A connection to one server.

    Attributes:
        supported: Types of objects that the server has.
    """

    def __init__(self, host: str, port: int, answer_s: float = ANSWER_S) -> None:
        """Connects and states the types that are wanted.

        Args:
            host: Computer of Vicon's program.
            port: Its port.
            answer_s: Longest wait for the program's first packet.

        Raises:
            OSError: The server is not there, or does not answer.
            InvalidInput: Another server answers.
        """
        self._waiting: deque[Packet] = deque()
        self._asked_s: float | None = None
        self._connection = PacketConnection(host, port, "Vicon's program ended the connection")
        try:
            self.supported = self._greeting(answer_s)
            wanted = tuple(one for one in objects.WANTED if one in self.supported)
            self._connection.send(objects.packet(objects.enums((*wanted, objects.CONTENTS))))
        except InvalidPacket as error:
            self.close()
            raise InvalidInput(f"Vicon: {host}, port {port} is not a DataStream server ({error})") from error
        except BaseException:
            self.close()
            raise

    def take(self, timeout_s: float) -> Packet | None:
        """The next packet; None where none comes in time.

        Raises:
            OSError: The connection broke off.
            InvalidPacket: What arrives is no packet, so that no other can be found in it.
        """
        until = time.perf_counter() + timeout_s
        while not self._waiting:
            now = time.perf_counter()
            if self._asked_s is not None and now - self._asked_s > AGAIN_S:
                self.ask()
            self._receive(max(0.0, until - now))
            if now >= until:
                break
        if not self._waiting:
            return None
        found = self._waiting.popleft()
        if objects.FRAME_INFO in found.blocks:
            self._asked_s = None
        return found

    def ask(self) -> None:
        """Asks for a single frame, and again while none comes.

        Raises:
            OSError: The connection broke off.
        """
        self._asked_s = time.perf_counter()
        self._connection.send(objects.request(streaming=False))

    @property
    def asked(self) -> bool:
        """True while a single frame is waited for."""
        return self._asked_s is not None

    def stream(self) -> None:
        """Asks for all frames from here on.

        Raises:
            OSError: The connection broke off.
        """
        self._asked_s = None
        self._connection.send(objects.request(streaming=True))

    def close(self) -> None:
        """Ends the connection."""
        self._connection.close()

    def _greeting(self, answer_s: float) -> tuple[int, ...]:
        until = time.perf_counter() + answer_s
        while (left := until - time.perf_counter()) > 0.0:
            self._receive(left)
            if self._waiting:
                found = self._waiting.popleft().blocks.get(objects.OBJECT_ENUMS)
                if found is None:
                    raise InvalidPacket("its first packet lists no types")
                return objects.read_numbers(found[0])
        raise TimeoutError("Vicon's program does not answer")

    def _receive(self, timeout_s: float) -> None:
        if self._connection.wait(timeout_s):
            self._connection.receive()
            self._split(time.perf_counter())

    def _split(self, arrival_s: float) -> None:
        """Packets that are whole by now; a whole one that cannot be read holds no blocks."""
        at, received, head = 0, self._connection.received, objects.HEADER.size
        while len(received) - at >= head:
            kind, size = objects.HEADER.unpack_from(received, at)
            if kind != objects.PACKET or size > objects.LARGEST:
                raise InvalidPacket(f"a packet of type {kind} and {size} bytes")
            if len(received) - at < head + size:
                break
            try:
                found = objects.blocks(bytes(received[at + head : at + head + size]))
            except InvalidPacket:
                found = {}
            self._waiting.append(Packet(arrival_s, found))
            at += head + size
        if at:
            del received[:at]
