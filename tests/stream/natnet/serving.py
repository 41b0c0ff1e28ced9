"""A NatNet server under a test's control: it sends what it is told, whole or damaged."""

import socket
import struct

import numpy as np

from mbkf.stream.natnet import packets
from tests.stream.natnet import layouts
from tests.waiting import PATIENCE_S


class Server:
    """Listens on this computer; remembers who asked.

    Attributes:
        port: Its command port.
        client: Address of the client that was heard last.
    """

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(PATIENCE_S)
        self.port = self._socket.getsockname()[1]
        self.client = None

    def hear(self, number):
        """Waits for a message."""
        while True:
            packet, self.client = self._socket.recvfrom(65536)
            if struct.unpack_from("<H", packet)[0] == number:
                return

    def heard(self):
        """Numbers of the messages that wait."""
        numbers = []
        self._socket.setblocking(False)
        try:
            while True:
                numbers.append(struct.unpack_from("<H", self._socket.recv(65536))[0])
        except BlockingIOError:
            self._socket.settimeout(PATIENCE_S)
        return numbers

    def send(self, *sent):
        """Sends packets to the client, one after the other."""
        for packet in sent:
            self._socket.sendto(packet, self.client)

    def close(self):
        """Is heard no more."""
        self._socket.close()


def frame(number, version=(4, 1)):
    """A frame of one marker, at 100 Hz."""
    return layouts.frame(version, number, 0.01 * number, [("one", np.full((1, 3), 1.0 + number))])


def described(version=(4, 1)):
    """The description of :func:`frame`."""
    return layouts.descriptions(version, [("one", ("A",))], ())


def nonsense():
    """Packets that no client can read."""
    whole = frame(3)
    return [
        b"",
        b"\0",
        b"\7",
        b"\7\0",
        b"\7\0\0\0",
        whole[:-1],
        layouts.cut(whole, 60),
        struct.pack("<HH", packets.FRAME, 65535) + whole[4:],
        b"\xff" * 1000,
        struct.pack("<HH", 999, 4) + b"what",
    ]
