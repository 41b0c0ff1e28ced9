"""A client of QTM's real-time server: a TCP connection for commands and frames, or frames over UDP beside it."""

from __future__ import annotations

import math
import socket
import time
from collections import deque
from typing import NamedTuple

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream.packet_connection import ANSWER_S, PacketConnection
from mbkf.stream.qualisys import packets

BASE_PORT = 22222
"""QTM's base port; little-endian clients connect to the one after it."""

VERSIONS = ("1.25", "1.20", "1.13", "1.8", "1.1")
"""Versions of the protocol, asked for one after another until QTM knows one."""

GREETING_S = ANSWER_S * (2 + len(VERSIONS))
"""Longest wait for the answers to a new connection: a welcome, versions and parameters."""

DATAGRAM = 65536
"""Most bytes of a datagram."""

PARAMETERS = "GetParameters General 3D Force"

UNANSWERING = (packets.DATA, packets.NO_DATA, packets.EVENT)
"""Types of packets that may come without end while an answer is waited for."""


class Packet(NamedTuple):
    """A packet that arrived: time on the clock of ``time.perf_counter``, type and payload."""

    arrival_s: float
    kind: int
    payload: bytes


class QtmClient:
    """A connection to one server, made in the version that both know.

    Attributes:
        version: Of the protocol.
        parameters: XML of the last parameters that arrived.
    """

    def __init__(self, host: str, port: int, over_udp: bool = False, greeting_s: float = GREETING_S) -> None:
        """Connects, agrees on a version and asks for parameters.

        Args:
            host: QTM's computer.
            port: Its base port.
            over_udp: Whether frames come over UDP.
            greeting_s: Longest wait for all answers to that.

        Raises:
            OSError: The server is not there.
            InvalidInput: It is another server, knows no version of the protocol, or answers with an error.
        """
        self.version, self.parameters = "", ""
        self._waiting: deque[Packet] = deque()
        self._datagrams: socket.socket | None = None
        self._connection = PacketConnection(host, port + 1, "QTM ended the connection")
        self._until_s = time.perf_counter() + greeting_s
        try:
            welcome = self._answer()
            if "QTM RT Interface connected" not in welcome:
                raise InvalidInput(f"Qualisys: {host}, port {port + 1} is not QTM ({welcome[:60]!r})")
            self._agree_on_version()
            self.parameters = self.command(PARAMETERS)
            if over_udp:
                self._datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                self._datagrams.bind((self._connection.socket.getsockname()[0], 0))
                self._datagrams.setblocking(False)
        except InvalidPacket as error:
            self.close()
            raise InvalidInput(f"Qualisys: {host}, port {port + 1} is not QTM ({error})") from error
        except BaseException:
            self.close()
            raise
        self._until_s = math.inf

    def command(self, text: str) -> str:
        """QTM's answer to a command: text, or XML. Packets of data that come meanwhile wait to be taken.

        Raises:
            InvalidInput: QTM refuses it.
            OSError: The connection broke off, or no answer came.
            InvalidPacket: As for :meth:`take`.
        """
        self.send(text)
        return self._answer()

    def send(self, text: str) -> None:
        """Sends a command whose answer is not waited for.

        Raises:
            OSError: The connection broke off.
        """
        self._connection.send(packets.packet(packets.COMMAND, text.encode() + b"\0"))

    def stream(self, components: str) -> None:
        """Asks for all frames from here on.

        Raises:
            OSError: The connection broke off.
        """
        way = "" if self._datagrams is None else f" UDP:{self._datagrams.getsockname()[1]}"
        self.send(f"StreamFrames AllFrames{way} {components}")

    def take(self, timeout_s: float) -> Packet | None:
        """The next packet; None where none comes in time.

        Raises:
            OSError: The connection broke off.
            InvalidPacket: What arrives is no packet, so that no other can be found in it.
        """
        until = time.perf_counter() + timeout_s
        while not self._waiting:
            left = until - time.perf_counter()
            self._receive(max(0.0, left))
            if left <= 0.0:
                break
        return self._waiting.popleft() if self._waiting else None

    def close(self) -> None:
        """Ends the connection."""
        self._connection.close()
        if self._datagrams is not None:
            self._datagrams.close()

    def _agree_on_version(self) -> None:
        refusal = ""
        for version in VERSIONS:
            try:
                self.command(f"Version {version}")
            except InvalidInput as error:
                refusal = str(error)
                continue
            self.version = version
            return
        raise InvalidInput(
            f"Qualisys: QTM knows none of the protocol's versions {', '.join(VERSIONS)} ({refusal})"
        )

    def _answer(self) -> str:
        until = min(time.perf_counter() + ANSWER_S, self._until_s)
        kept: list[Packet] = []
        try:
            while True:
                found = self.take(max(0.0, until - time.perf_counter()))
                if found is None or (found.kind in UNANSWERING and time.perf_counter() > until):
                    raise TimeoutError("QTM does not answer")
                if found.kind in (packets.COMMAND, packets.XML):
                    return packets.text_of(found.payload)
                if found.kind == packets.ERROR:
                    raise InvalidInput(f"Qualisys: QTM answers: {packets.text_of(found.payload)}")
                kept.append(found)
        finally:
            self._waiting.extendleft(reversed(kept))

    def _receive(self, timeout_s: float) -> None:
        ready = self._connection.wait(timeout_s, self._datagrams)
        if self._connection.socket in ready:
            self._connection.receive()
            self._split(time.perf_counter())
        if self._datagrams is not None and self._datagrams in ready:
            data, (sender, _) = self._datagrams.recvfrom(DATAGRAM)
            if sender == self._connection.socket.getpeername()[0] and len(data) >= packets.HEADER.size:
                size, kind = packets.HEADER.unpack_from(data)
                if size == len(data):
                    self._waiting.append(Packet(time.perf_counter(), kind, data[packets.HEADER.size :]))

    def _split(self, arrival_s: float) -> None:
        """Packets that are whole by now."""
        at, received = 0, self._connection.received
        while len(received) - at >= packets.HEADER.size:
            size, kind = packets.HEADER.unpack_from(received, at)
            if not packets.HEADER.size <= size <= packets.LARGEST:
                raise InvalidPacket(f"QTM: a packet of {size} bytes")
            if len(received) - at < size:
                break
            self._waiting.append(
                Packet(arrival_s, kind, bytes(received[at + packets.HEADER.size : at + size]))
            )
            at += size
        if at:
            del received[:at]
