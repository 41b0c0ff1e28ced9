"""Players that send whatever a schedule asks for, through Lab Streaming Layer or NatNet on this computer."""

from __future__ import annotations

import socket
from contextlib import suppress
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from benchmarks.robustness.stream_schedule import Sent
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import marker_info, plates_info
from mbkf.stream.lsl.source import LslSource
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.player import NatNetPlayer
from mbkf.stream.natnet.source import NatNetSource
from mbkf.stream.played import Played
from mbkf.stream.source import FrameSource, PlateSamples

HERE, STRANGER = "127.0.0.1", "127.0.0.2"
OTHER_MARKERS = 20
"""A stream that returns as another one has so many markers."""


class Wire(Protocol):
    """Sends what it is given; other methods are acts of a schedule, by name."""

    def source(self) -> FrameSource:
        """What receives from it."""

    def listening(self) -> bool:
        """Whether that is connected."""

    def send(self, one: Sent) -> bool:
        """Sends a frame; whether there was a stream to send it through."""

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends bytes."""

    def close(self) -> None:
        """Ends the stream."""


def with_other_markers(played: Played) -> Played:
    """The capture with fewer markers."""
    names = played.stream.marker_names[:OTHER_MARKERS]
    stream = replace(played.stream, marker_names=names)
    return Played(stream, played.markers_m[:, :OTHER_MARKERS], played.wrench)


class LslWire:
    """Outlets for markers and plates."""

    def __init__(self, played: Played, name: str, counted: bool) -> None:
        """Opens the streams.

        Args:
            played: The capture.
            name: Name of the stream.
            counted: Whether frames and samples carry a count.
        """
        self._lsl, self._played, self._name, self._counted = lsl(), played, name, counted
        self._samples = [frame.plates for frame in played.frames()]
        self._begin_s: float | None = None
        self._markers: Any = None
        self._plates: Any = None
        self._markers_sent = self._plate_count = 0
        self.open()

    def source(self) -> LslSource:
        """A source of this stream."""
        return LslSource(self._name)

    def listening(self) -> bool:
        """Whether both outlets are received."""
        return all(one.have_consumers() for one in (self._markers, self._plates) if one is not None)

    def open(self) -> None:
        """Opens both streams."""
        self._open_markers(self._played)
        self.open_plates()

    def open_other(self) -> None:
        """Opens the streams with fewer markers."""
        self._open_markers(with_other_markers(self._played))
        self.open_plates()

    def open_plates(self) -> None:
        """Opens the stream of the plates."""
        self._plate_count = len(self._played.stream.plates)
        self._plates = self._outlet(plates_info(self._lsl, self._played.stream, self._name))

    def open_other_plates(self) -> None:
        """Opens a stream of the plates with the first one only."""
        stream = replace(self._played.stream, plates=self._played.stream.plates[:1])
        self._plates = self._outlet(plates_info(self._lsl, stream, self._name))
        self._plate_count = 1

    def close_plates(self) -> None:
        """Ends the stream of the plates."""
        self._plates = None

    def close(self) -> None:
        """Ends both streams."""
        self._markers = self._plates = None

    def half(self) -> None:
        """Sends plates without the markers of their frame."""
        samples = self._samples[-1]
        if self._plates is not None and len(samples.index):
            self._push_plates(samples, samples.index.astype(float), None, 0.0)

    def send(self, one: Sent) -> bool:
        """Sends the plates' samples and then the markers."""
        if self._begin_s is None:
            self._begin_s = self._lsl.local_clock()
        if self._plates is not None and one.plates:
            first = one.frame if one.plates_from < 0 else one.plates_from
            for frame in range(first, one.frame + 1):
                samples = self._samples[frame]
                self._push_plates(samples, samples.index + one.plates_ahead, one.load, one.stamp_s)
        if self._markers is None:
            return False
        row = one.markers_m[: self._markers_sent].ravel()
        self._markers.push_sample(np.append(row, one.number), self._begin_s + one.stamp_s)
        return True

    def packet(self, data: bytes, stranger: bool) -> None:
        """LSL has no packets to be forged."""

    def _push_plates(
        self, samples: PlateSamples, counts: np.ndarray, load: float | None, stamp_s: float
    ) -> None:
        if not len(samples.index):
            return
        wrench = samples.wrench if load is None else np.full_like(samples.wrench, load)
        rows = np.column_stack([wrench[:, : self._plate_count].reshape(len(counts), -1), counts])
        rate_hz = self._played.stream.plate_rate_hz
        after_s = (samples.index - samples.index[-1]) / rate_hz
        self._plates.push_chunk(rows, list((self._begin_s or 0.0) + stamp_s + 0.5 / 100.0 + after_s))

    def _open_markers(self, played: Played) -> None:
        self._markers_sent = len(played.stream.marker_names)
        self._markers = self._outlet(marker_info(self._lsl, played.stream, self._name, self._markers_sent))

    def _outlet(self, info: Any) -> Any:
        if not self._counted:
            info.desc().child("channels").last_child().set_child_value("type", "Unused")
        return self._lsl.StreamOutlet(info, max_buffered=10)


class NatNetWire:
    """A server of NatNet."""

    def __init__(self, played: Played) -> None:
        """Args: the capture."""
        self._played = played
        self._player: _Player | None = _Player(played, HERE, 0)
        self._port = self._player.port
        self._stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._stranger.bind((STRANGER, 0))

    def source(self) -> NatNetSource:
        """A source of this server."""
        return NatNetSource(HERE, HERE, self._port, None)

    def listening(self) -> bool:
        """Whether a client has asked for the description."""
        return self._player is not None and self._player.listening()

    def open(self) -> None:
        """Serves again."""
        self._player = _Player(self._played, HERE, self._port)

    def open_other(self) -> None:
        """Serves a stream of fewer markers."""
        self._player = _Player(with_other_markers(self._played), HERE, self._port)

    def close(self) -> None:
        """Serves no more."""
        if self._player is not None:
            self._player.close()
            self._player = None

    def half(self) -> None:
        """Sends half of a frame."""
        if self._player is not None:
            whole = self._player.packed(Sent(0.0, 0, 0.0, 0.0, self._played.markers_m[0]))
            self._player.to_all(whole[: len(whole) // 2])

    def send(self, one: Sent) -> bool:
        """Sends a frame."""
        if self._player is None:
            return False
        return self._player.to_all(self._player.packed(one))

    def packet(self, data: bytes, stranger: bool) -> None:
        """Sends bytes to all clients, from the server or from another address."""
        if self._player is None:
            return
        if not stranger:
            self._player.to_all(data)
            return
        for client in self._player.clients():
            with suppress(OSError):
                self._stranger.sendto(data, client)


class _Player(NatNetPlayer):
    """A player that sends any packet."""

    def clients(self) -> list[tuple[str, int]]:
        """Who has been heard of."""
        return list(self._last_seen)

    def to_all(self, packet: bytes) -> bool:
        """Sends a packet to all clients; whether there is any."""
        clients = self.clients()
        for client in clients:
            self._answer(packet, client)
        return bool(clients)

    def packed(self, one: Sent) -> bytes:
        """The packet of a frame."""
        points = one.markers_m[: len(self._names)] @ self._rotation
        plates = (
            self._plates[one.frame] if one.load is None else np.full_like(self._plates[one.frame], one.load)
        )
        shown = plates if one.plates else plates[:0]
        nothing = np.zeros((0, 3))
        name, number = self._played.stream.trial, int(one.number) & 0xFFFFFFFF
        return packets.frame(number, one.stamp_s, name, points, nothing, shown)
