"""Sends a capture as JSON lines over UDP, as any program may."""

from __future__ import annotations

import json
import socket
import time

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.stream.played import Played, PlayedFrame

DESCRIBE_S = 0.25
"""Interval at which the stream describes itself."""

LARGEST_BYTES = 65507
"""The largest datagram of UDP over IPv4."""


class UdpPlayer:
    """A :class:`mbkf.stream.replay.Player`."""

    def __init__(self, played: Played, address: str, port: int) -> None:
        """A sender to one receiver.

        Args:
            played: The capture.
            address: Address of the receiver.
            port: Its port.

        Raises:
            InvalidInput: It cannot be sent to, or a frame does not fit into a datagram.
        """
        self._stream = played.stream
        self._description = description(played)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.connect((address, port))
        except (OSError, OverflowError, UnicodeError) as error:
            self._socket.close()
            raise InvalidInput(f"UDP: {address}, port {port} cannot be sent to ({error})") from error
        first = next(iter(played.frames()))
        if len(line(self.fields(first) | self._description)) > LARGEST_BYTES:
            self._socket.close()
            raise InvalidInput("UDP: a frame does not fit into a datagram of 65 kB; send fewer points")
        self._due_s = 0.0
        self._heard = 0

    def listening(self) -> bool:
        """True once somebody is there: the system reports a port of this computer that is closed.

        A receiver on another computer may not be known of, and counts as there.
        """
        self._heard = self._heard + 1 if self.push(self._description) else 0
        return self._heard > 2

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame with its samples of the plates, and the description now and then."""
        del age_s
        now = time.perf_counter()
        fields = self.fields(frame)
        if now >= self._due_s:
            fields |= self._description
            self._due_s = now + DESCRIBE_S
        self.push(fields)

    def push(self, fields: dict[str, object]) -> bool:
        """Sends a line; false where nobody receives it."""
        return self.push_bytes(line(fields))

    def push_bytes(self, data: bytes) -> bool:
        """Sends bytes; false where nobody receives them."""
        try:
            self._socket.send(data)
        except OSError:  # nobody listens, or not yet
            return False
        return True

    def close(self) -> None:
        """Sends no more."""
        self._socket.close()

    def fields(self, frame: PlayedFrame) -> dict[str, object]:
        """The keys of a frame."""
        named = self._stream.marker_names
        fields: dict[str, object] = {"frame": frame.number}
        if named:
            fields["markers"] = dict(zip(named, _plain(frame.markers_m), strict=True))
        else:
            fields["points"] = [one for one in _plain(frame.markers_m) if one is not None]
        if len(frame.plates.index):
            fields["sample"] = int(frame.plates.index[0])
            fields["forces"] = frame.plates.wrench.tolist()
        return fields


def description(played: Played) -> dict[str, object]:
    """The keys that describe a capture, in metres and world axes."""
    stream = played.stream
    plates = [
        {
            "name": plate.name,
            "rate": plate.rate_hz,
            "start": plate.start_time_s,
            "origin": plate.origin_m.tolist(),
            "corners": None if plate.corners_m is None else plate.corners_m.tolist(),
        }
        for plate in stream.plates
    ]
    return {
        "trial": stream.trial,
        "rate": stream.rate_hz,
        "unit": "m",
        "up": "z",
        "start": stream.start_time_s,
        "names": list(stream.marker_names),
        "plates": plates,
    }


def line(fields: dict[str, object]) -> bytes:
    """A line of the protocol."""
    return json.dumps(fields, separators=(",", ":")).encode() + b"\n"


def _plain(points_m: Array) -> list[list[float] | None]:
    """Points (N, 3) as lists, None for missing ones."""
    missing = np.asarray(np.isnan(points_m).any(axis=1))
    return [None if gone else row for gone, row in zip(missing.tolist(), points_m.tolist(), strict=True)]
