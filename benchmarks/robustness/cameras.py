"""Camera systems that misbehave: streams over LSL and NatNet whose every frame and packet a fault decides."""

from __future__ import annotations

import contextlib
import socket
import uuid
from dataclasses import replace
from typing import Protocol

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.lsl.player import LslPlayer
from mbkf.stream.lsl.source import LslSource
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.player import NatNetPlayer
from mbkf.stream.natnet.source import NatNetSource
from mbkf.stream.played import Played, PlayedFrame
from mbkf.stream.source import FrameSource

ADDRESS = "127.0.0.1"
NUMBERS = 2**32
"""NatNet counts frames in 32 bits."""


class Camera(Protocol):
    """A camera system.

    Attributes:
        sent: Frames sent.
    """

    sent: int

    def source(self) -> FrameSource:
        """What `mbkf live` connects to it."""

    def listening(self) -> bool:
        """Whether it is received."""

    def frame(self, frame: PlayedFrame, number: float) -> None:
        """Sends a frame under a number."""

    def nonsense(self, packet: bytes, foreign: bool) -> None:
        """Sends bytes that are no frame, or lets a stranger send them; nothing where the protocol has no packets."""

    def restart(self, played: Played | None) -> None:
        """Ends the stream; begins it anew, of what is given."""

    def close(self) -> None:
        """Ends the stream."""


class LslCamera:
    """A :class:`Camera` that streams over LSL.

    Attributes:
        name: Of the marker stream.
    """

    def __init__(self, played: Played) -> None:
        self.name, self.sent = f"fault-{uuid.uuid4().hex[:8]}", 0
        self._player: LslPlayer | None = LslPlayer(played, self.name)

    def source(self) -> FrameSource:
        """A source of its stream."""
        return LslSource(self.name)

    def listening(self) -> bool:
        """Whether markers and plates are received."""
        return self._player is not None and self._player.listening()

    def frame(self, frame: PlayedFrame, number: float) -> None:
        """Sends a frame under a number."""
        if self._player is None:
            return
        self.sent += 1
        self._player.send(replace(frame, number=number), 0.0)  # type: ignore[arg-type]

    def nonsense(self, packet: bytes, foreign: bool) -> None:
        """LSL has no packets."""

    def restart(self, played: Played | None) -> None:
        """The outlets go; new ones of the same name come."""
        self.close()
        self._player = None if played is None else LslPlayer(played, self.name)

    def close(self) -> None:
        """The outlets go."""
        if self._player is not None:
            self._player.close()
            self._player = None


class NatNetCamera(NatNetPlayer):
    """A :class:`Camera` that streams over NatNet."""

    def __init__(self, played: Played, port: int = 0) -> None:
        super().__init__(played, ADDRESS, port)
        self.sent, self._open = 0, True

    def source(self) -> FrameSource:
        """A source of its stream."""
        return NatNetSource(ADDRESS, ADDRESS, self.port, None)

    def frame(self, frame: PlayedFrame, number: float) -> None:
        """Sends a frame under a number."""
        if not self._open:
            return
        count = int(number) % NUMBERS if np.isfinite(number) else NUMBERS - 1
        self.sent += 1
        self._to_all(self._numbered(frame, count))

    def nonsense(self, packet: bytes, foreign: bool) -> None:
        """Sends bytes that are no frame, or lets another socket send them."""
        if not foreign:
            self._to_all(packet)
            return
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            for client in list(self._heard):
                with contextlib.suppress(OSError):
                    stranger.sendto(packet, client)

    def restart(self, played: Played | None) -> None:
        """The server goes; a new one comes at the same port."""
        self.close()
        if played is not None:
            sent = self.sent
            NatNetCamera.__init__(self, played, self.port)
            self.sent = sent

    def close(self) -> None:
        """The server goes."""
        if self._open:
            self._open = False
            super().close()

    def _numbered(self, frame: PlayedFrame, number: int) -> bytes:
        loads = self._plates[min(frame.number, len(self._plates) - 1)]
        if len(frame.plates.index) == 0:
            loads = loads[:0]
        elif not np.isfinite(frame.plates.wrench).all() or np.abs(frame.plates.wrench).max() > 1e5:
            loads = np.broadcast_to(frame.plates.wrench[0, :, None, :], loads.shape)
        with np.errstate(invalid="ignore"):
            markers: Array = np.asarray(frame.markers_m) @ self._rotation
        time_s = self._played.stream.start_time_s + number / self._played.stream.rate_hz
        return packets.frame(number, time_s, self._played.stream.trial, markers, packets.NO_POINTS, loads)

    def _to_all(self, packet: bytes) -> None:
        for client in list(self._heard):
            self._answer(packet, client)


CAMERAS = {"lsl": LslCamera, "natnet": NatNetCamera}
"""Camera systems by the name of their protocol."""
