"""A simulated DataStream server that sends whatever a schedule asks for."""

from __future__ import annotations

import struct

import numpy as np

from benchmarks.robustness.stream_schedule import Sent
from benchmarks.robustness.stream_wire import HERE
from benchmarks.streams.server_wire import ServerWire, frame_number
from benchmarks.streams.vicon_server import PACKET, TYPES, ViconServer, block
from mbkf.stream.played import Played, PlayedFrame
from mbkf.stream.source import FrameSource, PlateSamples
from mbkf.stream.vicon.source import ViconSource

HALF_RATE_TICKS = 2_700_000
"""Period of 50 Hz."""


class ViconWire(ServerWire[ViconServer]):
    """The wire. Methods beyond those of a wire are acts of a schedule."""

    def __init__(self, played: Played) -> None:
        """Args: the capture."""
        super().__init__(played, ViconServer)

    def source(self) -> FrameSource:
        """A source of this server."""
        return ViconSource(HERE, self._port)

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
        return server.send_frame(shown, frame_number(one), wrench)

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends a packet of these objects."""
        if self._server is not None and not stranger:
            self._server.raw_to_all(block(PACKET, data))

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
