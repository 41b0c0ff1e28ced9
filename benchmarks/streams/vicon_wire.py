"""A simulated DataStream server that sends whatever a schedule asks for."""

from __future__ import annotations

import struct

import numpy as np

from benchmarks.robustness.stream_schedule import Sent
from benchmarks.robustness.stream_wire import HERE, with_other_markers
from benchmarks.streams.vicon_server import PACKET, TYPES, ViconServer, block
from mbkf.stream.played import Played, PlayedFrame
from mbkf.stream.source import FrameSource, PlateSamples
from mbkf.stream.vicon.source import ViconSource

HALF_RATE_TICKS = 2_700_000
"""Period of 50 Hz."""


class ViconWire:
    """The wire. Methods beyond those of a wire are acts of a schedule."""

    def __init__(self, played: Played) -> None:
        """Args: the capture."""
        self._played = self._served = played
        self._server: ViconServer | None = ViconServer(played)
        self._port = self._server.port

    def source(self) -> FrameSource:
        """A source of this server."""
        return ViconSource(HERE, self._port)

    def listening(self) -> bool:
        """True once the source asked for frames."""
        return self._server is not None and self._server.listening()

    def open(self) -> None:
        """Serves again."""
        self._serve(self._played)

    def open_other(self) -> None:
        """Serves fewer markers."""
        self._serve(with_other_markers(self._played))

    def close(self) -> None:
        """Serves no more."""
        if self._server is not None:
            self._server.close()
            self._server = None

    def half(self) -> None:
        """Sends a packet that holds half of a frame."""
        if self._server is not None:
            whole = self._server.blocks(next(iter(self._played.frames())))
            data = b"".join(block(kind, data) for kind, data in whole)
            self._server.raw_to_all(block(PACKET, data[: len(data) // 2]))

    def send(self, one: Sent) -> bool:
        """Sends a frame."""
        server = self._server
        if server is None:
            return False
        ratio = round(self._played.stream.plate_rate_hz / self._played.stream.rate_hz)
        wrench = self._played.wrench[one.frame * ratio : (one.frame + 1) * ratio]
        if not one.plates:
            wrench = wrench[:0]
        elif one.load is not None:
            wrench = np.full_like(wrench, one.load)
        count = len(self._served.stream.marker_names)
        shown = PlayedFrame(one.frame, one.markers_m[:count], PlateSamples.none(0))
        number = int(one.number) if abs(one.number) < 2.0**62 else 2**31
        return server.send_frame(shown, number, wrench)

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends a packet of these objects."""
        if self._server is not None and not stranger:
            self._server.raw_to_all(block(PACKET, data))

    def rename(self) -> None:
        """The subject's markers have other names."""
        if self._server is not None:
            self._server.names = [f"other_{name}" for name in self._server.names]

    def rename_back(self) -> None:
        """They have the known names."""
        if self._server is not None:
            self._server.names = list(self._played.stream.marker_names)

    def turn_world(self) -> None:
        """The y axis points up."""
        if self._server is not None:
            self._server.y_up = True

    def turn_back(self) -> None:
        """The z axis points up."""
        if self._server is not None:
            self._server.y_up = False

    def halve_rate(self) -> None:
        """The server states another frame rate."""
        if self._server is not None:
            period = struct.pack("<q", HALF_RATE_TICKS)
            self._server.raw_to_all(block(PACKET, block(TYPES["stream"], period)))

    def rate_back(self) -> None:
        """It states the known one."""
        if self._server is not None:
            kind, data = self._server.static()[0]
            self._server.raw_to_all(block(PACKET, block(kind, data)))

    def forget_size(self) -> None:
        """Bytes that are no packet, after which a connection cannot be read any more."""
        if self._server is not None:
            self._server.raw_to_all(b"\xff" * 64)

    def _serve(self, played: Played) -> None:
        self._served, self._server = played, ViconServer(played, port=self._port)
