"""A NatNet client: two sockets, and a queue of received frames until they are read.

The caller that waits for a frame receives it in its own thread: a handover between threads would cost a loaded computer
more than reading the frame. Another thread receives while no caller waits, since packets that stay too long in the
system are lost. A packet that cannot be read is counted and reported; reception goes on.
"""

from __future__ import annotations

import os
import selectors
import socket
import struct
import threading
import time
from collections import deque
from contextlib import suppress

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.cursor import opened
from mbkf.stream.natnet.descriptions import Descriptions, read_descriptions
from mbkf.stream.natnet.server import Version, read_version

ROOM_BYTES = 4 * 1024 * 1024
"""Size of each socket's receive buffer, as far as the system allows: its usual 200 kB hold a tenth of a second with
many plates, and packets beyond that are lost."""

WATCH_S = 0.01
"""Interval at which the thread looks for packets that no caller takes."""

KEEP_ALIVE_S = 1.0
"""Interval of messages to a server that streams to single clients, which repeat unanswered questions."""

ASK_S = 0.25
"""Interval of questions to a server that has not answered yet."""

PAUSE_S = 0.05
"""Pause after an error of a socket, so that one that lasts costs no processor."""

LEAST_HELD = 256
"""Received frames held at least until they are read."""

_LARGEST = 65536
_FRAME = struct.pack("<H", packets.FRAME)


class NatNetClient:
    """A client of one server.

    Attributes:
        answered: Set as soon as the server's protocol is known.
        most_held: Received frames held until they are read; the oldest are dropped first.
        dropped: How many were dropped.
        unreadable: How many packets could not be read.
    """

    def __init__(self, server: str, local: str, port: int, multicast: str | None) -> None:
        """Opens the sockets, asks the server and begins to receive.

        Args:
            server: Address of the camera computer.
            local: Address of this computer.
            port: Command port of the server; data of a multicast group come to the one after it.
            multicast: Multicast group; None for unicast.

        Raises:
            InvalidInput: An address or port is not one, or not of this computer, or the server cannot be reached.
        """
        self.version: Version | None = None
        self.descriptions: Descriptions | None = None
        self.answered, self.described = threading.Event(), threading.Event()
        self.most_held = LEAST_HELD
        self.dropped = self.unreadable = 0
        self._alone = multicast is None
        self._frames: deque[tuple[float, bytes]] = deque()
        self._sender: str | None = None
        self._news: deque[tuple[str, str]] = deque()
        self._reported: set[str] = set()
        self._command, self._data = _sockets(local, port, multicast)
        try:
            self._server = (socket.gethostbyname(server), port)
            self._command.sendto(packets.message(packets.CONNECT, b"Ping\0"), self._server)
        except (OSError, OverflowError, UnicodeError) as error:
            self._close_sockets()
            raise InvalidInput(
                f"NatNet: {server}, port {port} cannot be reached from {local} ({error}); "
                "--server and --local name the camera computer and this one"
            ) from error
        self._selector = selectors.DefaultSelector()
        for one in (self._command, self._data):
            self._selector.register(one, selectors.EVENT_READ)
        self._turn, self._closing = threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._watch, name="mbkf-natnet-client", daemon=True)
        self._thread.start()

    def take(self, timeout_s: float) -> tuple[float, bytes] | None:
        """Arrival time (clock of ``time.perf_counter``) and packet of the oldest frame; None where none comes."""
        until = time.perf_counter() + timeout_s
        while not self._frames:
            left = until - time.perf_counter()
            with self._turn:
                if self._closing.is_set():
                    return None
                if not self._frames:
                    self._receive(max(0.0, left), 1)
            if left <= 0.0:
                break
        try:
            return self._frames.popleft()
        except IndexError:
            return None

    def describe_again(self) -> None:
        """Asks for the description once more; until it comes, the question is repeated."""
        self.described.clear()
        self._send(packets.REQUEST_DESCRIPTIONS)

    def refuse(self, error: InvalidPacket) -> None:
        """Counts a packet that cannot be read, and reports the first one."""
        self.unreadable += 1
        self._report("packets", f"packets that cannot be read are left out ({error})")

    def news(self) -> list[tuple[str, str]]:
        """Events since the last call, each kind at most once per client."""
        return [self._news.popleft() for _ in range(len(self._news))]

    def close(self) -> None:
        """Takes leave of the server and ends the thread."""
        self._closing.set()
        self._thread.join()
        self._send(packets.DISCONNECT)
        with self._turn:
            self._selector.close()
            self._close_sockets()

    def _watch(self) -> None:
        """The thread: empties the sockets while no caller waits for a frame, and keeps the server informed."""
        due = time.monotonic() + ASK_S
        while not self._closing.wait(WATCH_S):
            if self._turn.acquire(blocking=False):
                try:
                    self._receive(0.0, LEAST_HELD)
                except Exception as error:  # without this thread the server hears no more of us
                    self._report("connection", f"receiving failed ({type(error).__name__}: {error})")
                    self._closing.wait(PAUSE_S)
                finally:
                    self._turn.release()
            if time.monotonic() >= due:
                self._ask()
                due = time.monotonic() + (KEEP_ALIVE_S if self.answered.is_set() else ASK_S)

    def _receive(self, timeout_s: float, most: int) -> None:
        """Waits until a socket holds something, and takes up to so many packets of each; only by turns."""
        for key, _ in self._selector.select(timeout_s):
            one: socket.socket = key.fileobj  # type: ignore[assignment]
            for _ in range(most):
                try:
                    packet, (sender, *_) = one.recvfrom(_LARGEST)
                except BlockingIOError:
                    break
                except OSError:  # the server does not listen, or the network is gone
                    self._closing.wait(PAUSE_S)
                    break
                arrival_s = time.perf_counter()
                if not self._ours(sender):
                    self._report("stranger", f"packets of another sender, {sender}, are left out")
                    continue
                if packet[:2] != _FRAME:
                    self._take_message(packet)
                    continue
                if len(self._frames) >= self.most_held:
                    self._drop()
                self._frames.append((arrival_s, packet))

    def _ours(self, sender: str) -> bool:
        """True for the server's own address, or for the first one that sent any packet, if the server's own sends none.

        A server with several addresses may answer from another one than it is asked at.
        """
        if sender == self._sender:
            return True
        if self._sender is None or sender == self._server[0]:
            self._sender = sender
            return True
        return False

    def _drop(self) -> None:
        with suppress(IndexError):  # read in this moment
            self._frames.popleft()
            if self.answered.is_set():  # frames before cannot be read yet
                self.dropped += 1
                self._report("overrun", "received frames were dropped, since they were not read in time")

    def _take_message(self, packet: bytes) -> None:
        try:
            number = opened(packet)[0]
            if number == packets.SERVER_INFO and self.version is None:
                self.version = read_version(packet)
                self.answered.set()
                self._ask()
            elif number == packets.DESCRIPTIONS and self.version is not None:
                self.descriptions = read_descriptions(packet, self.version)
                self.described.set()
        except InvalidPacket as error:
            self.refuse(error)
        except Exception as error:  # no packet ends the reception
            self.refuse(InvalidPacket(f"NatNet: an unforeseen {type(error).__name__}: {error}"))

    def _ask(self) -> None:
        if not self.answered.is_set():
            self._send(packets.CONNECT, b"Ping\0")
        elif not self.described.is_set():
            self._send(packets.REQUEST_DESCRIPTIONS)
        elif self._alone:
            self._send(packets.KEEP_ALIVE)

    def _send(self, number: int, payload: bytes = b"\0") -> None:
        with suppress(OSError):  # asked again in a moment
            self._command.sendto(packets.message(number, payload), self._server)

    def _report(self, kind: str, sentence: str) -> None:
        if kind not in self._reported:
            self._reported.add(kind)
            self._news.append((kind, sentence))

    def _close_sockets(self) -> None:
        self._command.close()
        self._data.close()


def _sockets(local: str, port: int, multicast: str | None) -> tuple[socket.socket, socket.socket]:
    """Command and data socket, neither of which blocks.

    Raises:
        InvalidInput: The address is not of this computer, the group is not one, or the port is taken.
    """
    made: list[socket.socket] = []
    try:
        command = _socket(made)
        command.bind((local, 0))
        data = _socket(made)
        if multicast is None:
            data.bind((local, 0))
        else:
            data.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            # A socket of the group hears nothing else; Windows binds only to own addresses.
            data.bind(("" if os.name == "nt" else multicast, port + 1))
            group = socket.inet_aton(multicast) + socket.inet_aton(socket.gethostbyname(local))
            data.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
    except (OSError, OverflowError, UnicodeError) as error:
        for one in made:
            one.close()
        at = local if multicast is None else f"{local} in the group {multicast}"
        raise InvalidInput(f"NatNet: nothing can be received at {at} ({error})") from error
    return command, data


def _socket(made: list[socket.socket]) -> socket.socket:
    one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.append(one)
    one.setblocking(False)
    with suppress(OSError):  # less room where the system gives no more
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM_BYTES)
    return one
