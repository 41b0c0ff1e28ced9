"""Players that send whatever a schedule asks for, through the protocols of :mod:`benchmarks.streams`."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.robustness.stream_schedule import Sent
from benchmarks.robustness.stream_wire import HERE, STRANGER, Wire, with_other_markers
from benchmarks.streams.qualisys_server import CAMERAS_CHANGED, QtmServer
from benchmarks.streams.server_wire import ServerWire, frame_number
from benchmarks.streams.vicon_wire import ViconWire
from mbkf.stream.played import Played, PlayedFrame
from mbkf.stream.qualisys.source import QualisysSource
from mbkf.stream.source import FrameSource, PlateSamples
from mbkf.stream.udp.player import UdpPlayer, description, line
from mbkf.stream.udp.source import UdpSource


def disturbed(played: Played, one: Sent, samples: PlateSamples) -> PlayedFrame:
    """A frame as the schedule alters it.

    Args:
        played: The capture.
        one: The altered frame.
        samples: The plates' samples of the frame.
    """
    if not one.plates:
        samples = PlateSamples.none(len(played.stream.plates))
    elif one.load is not None:
        samples = PlateSamples(samples.index, np.full_like(samples.wrench, one.load))
    return PlayedFrame(one.frame, one.markers_m, samples)


def send_as_stranger(data: bytes, port: int) -> None:
    """Sends a datagram from another address of this computer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind((STRANGER, 0))
        one.sendto(data, (HERE, port))


class UdpWire:
    """A sender of JSON lines. Methods beyond those of a wire are acts of a schedule."""

    def __init__(self, played: Played) -> None:
        """Args: the capture."""
        self._played = self._sent = played
        self._samples = [frame.plates for frame in played.frames()]
        self._source = UdpSource(0, HERE)
        self._description = description(played)
        self._player: UdpPlayer | None = None
        self.open()

    def source(self) -> FrameSource:
        """The source that receives from it."""
        return self._source

    def listening(self) -> bool:
        """True once the source asks for frames; until then the stream describes itself."""
        if self._player is not None and not self._source.receiving:
            self._player.push(self._description)
        return self._source.receiving

    def open(self) -> None:
        """Sends again, from another port."""
        self._open(self._played)

    def open_other(self) -> None:
        """Sends fewer markers."""
        self._open(with_other_markers(self._played))

    def close(self) -> None:
        """Sends no more."""
        if self._player is not None:
            self._player.close()
            self._player = None

    def half(self) -> None:
        """Sends half of a frame."""
        whole = self._line(Sent(0.0, 0, 0.0, 0.0, self._played.markers_m[0]))
        if self._player is not None:
            self._player.push_bytes(whole[: len(whole) // 2])

    def send(self, one: Sent) -> bool:
        """Sends a frame."""
        return self._player is not None and self._player.push_bytes(self._line(one))

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends bytes, from its own or from another address."""
        if stranger:
            send_as_stranger(data, self._source.port)
        elif self._player is not None:
            self._player.push_bytes(data)

    def describe(self, **keys: object) -> None:
        """Describes itself with other values."""
        if self._player is not None:
            self._player.push(self._description | keys)

    def _open(self, played: Played) -> None:
        self._sent, self._description = played, description(played)
        self._player = UdpPlayer(played, HERE, self._source.port)
        self._player.push(self._description)

    def _line(self, one: Sent) -> bytes:
        assert self._player is not None
        shown = disturbed(self._sent, one, self._samples[one.frame])
        count = len(self._sent.stream.marker_names)
        fields = self._player.fields(replace(shown, markers_m=one.markers_m[:count]))
        fields["frame"] = int(one.number) if np.isfinite(one.number) else one.number
        return line(fields)


class QualisysWire(ServerWire[QtmServer]):
    """A simulated QTM. Methods beyond those of a wire are acts of a schedule."""

    def __init__(self, played: Played) -> None:
        """Args: the capture."""
        super().__init__(played, QtmServer)
        self._samples = [frame.plates for frame in played.frames()]

    def source(self) -> FrameSource:
        """A source of this server."""
        return QualisysSource(HERE, self._port)

    def half(self) -> None:
        """Sends half of a frame."""
        if self._server is not None:
            one = Sent(0.0, 0, 0.0, 0.0, self._played.markers_m[0])
            for client in self._server.streaming():
                whole = self._payload(self._server, one, client.components)
                self._server.raw_to_all(struct.pack("<II", 8 + len(whole), 3) + whole[: len(whole) // 2])

    def send(self, one: Sent) -> bool:
        """Sends a frame."""
        server = self._server
        if server is None:
            return False
        clients = server.streaming()
        for client in clients:
            server.send_data(client, self._payload(server, one, client.components))
        return bool(clients)

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends a packet: the first byte is its type."""
        if self._server is not None and not stranger:
            self._server.to_all(data[0], data[1:])

    def rename(self) -> None:
        """QTM has other labels, and says so."""
        super().rename()
        self._say_changed()

    def rename_back(self) -> None:
        """QTM has the known labels again, and says so."""
        super().rename_back()
        self._say_changed()

    def _say_changed(self) -> None:
        if self._server is not None:
            self._server.to_all(6, bytes([CAMERAS_CHANGED]))

    def _payload(self, server: QtmServer, one: Sent, components: tuple[int, ...]) -> bytes:
        shown = disturbed(self._played, one, self._samples[one.frame])
        return server.data(shown, components, frame_number(one))


WIRES: dict[str, Callable[[Played], Wire]] = {"udp": UdpWire, "qualisys": QualisysWire, "vicon": ViconWire}
"""Players by protocol."""
