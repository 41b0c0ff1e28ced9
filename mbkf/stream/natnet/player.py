"""Plays a capture as OptiTrack's Motive streams it: NatNet over UDP, y up, to every client that asks."""

from __future__ import annotations

import socket
import struct
import threading
import time

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.plate_corners import has_area, plate_axes
from mbkf.io.records import PlateReadings
from mbkf.stream.natnet import packets
from mbkf.stream.played import Played, PlayedFrame

UP = "y"
"""Motive's default."""

STAYS_S = 0.1
"""A client that leaves sooner after its question only looked for streams."""

FORGET_S = 5.0
"""Silence after which a client counts as gone."""


class NatNetPlayer:
    """A :class:`mbkf.stream.replay.Player` that serves NatNet clients in unicast."""

    def __init__(self, played: Played, address: str, port: int) -> None:
        """Listens for clients.

        Args:
            played: The capture.
            address: Address of this computer to listen on.
            port: Command port; data are sent from the one after it.

        Raises:
            InvalidInput: The address cannot be listened on, or a frame does not fit into a packet.
        """
        self._played, self._rotation = played, rotation_to_world(UP)
        self._names = played.stream.marker_names
        self._plates = plates_in_frames(played)
        self._packed(0, played.markers_m[0])
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((address, port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            raise InvalidInput(f"NatNet cannot be served on {address}, port {port} ({error})") from error
        self.port = int(self._socket.getsockname()[1])
        self._socket.settimeout(0.1)
        self._described = packets.descriptions(
            played.stream.trial,
            self._names,
            [_description(k, plate) for k, plate in enumerate(played.stream.plates)],
        )
        self._last_seen: dict[tuple[str, int], float] = {}
        self._asked: dict[tuple[str, int], float] = {}
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="mbkf-natnet", daemon=True)
        self._thread.start()

    def listening(self) -> bool:
        """True once a client has requested the stream's description, and stays."""
        return any(time.monotonic() - asked > STAYS_S for asked in list(self._asked.values()))

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame to all clients."""
        del age_s
        packet = self._packed(frame.number, frame.markers_m)
        now = time.monotonic()
        for client, seen in list(self._last_seen.items()):
            if now - seen > FORGET_S:
                del self._last_seen[client]
                self._asked.pop(client, None)
                continue
            self._answer(packet, client)

    def close(self) -> None:
        """Serves no more."""
        self._closing.set()
        self._thread.join()
        self._socket.close()

    def _packed(self, number: int, markers_m: Array) -> bytes:
        turned = markers_m @ self._rotation
        nothing = np.zeros((0, 3))
        points = turned[~np.isnan(turned).any(axis=1)]
        markers, points = (turned, nothing) if self._names else (nothing, points)
        time_s = self._played.stream.start_time_s + number / self._played.stream.rate_hz
        return packets.frame(number, time_s, self._played.stream.trial, markers, points, self._plates[number])

    def _serve(self) -> None:
        while not self._closing.is_set():
            try:
                data, client = self._socket.recvfrom(65536)
            except TimeoutError:
                continue
            except OSError:  # a client is gone
                continue
            if len(data) < 4:
                continue
            self._last_seen[client] = time.monotonic()
            number = struct.unpack_from("<H", data)[0]
            if number == packets.CONNECT:
                self._answer(packets.server_info("mbkf replay", self.port), client)
            elif number == packets.REQUEST_DESCRIPTIONS:
                self._answer(self._described, client)
                self._asked.setdefault(client, time.monotonic())
            elif number == packets.DISCONNECT:
                self._last_seen.pop(client, None)
                self._asked.pop(client, None)

    def _answer(self, packet: bytes, client: tuple[str, int]) -> None:
        try:
            self._socket.sendto(packet, client)
        except OSError:  # it is gone
            self._last_seen.pop(client, None)
            self._asked.pop(client, None)


def plates_in_frames(played: Played) -> Array:
    """(T, K, m, 6) channels of the plates, in their axes: m samples per frame, the first at the frame's own time.

    NatNet carries a whole number of samples per frame. Plates at another rate, or out of step, are interpolated.
    """
    stream, frames = played.stream, len(played)
    if not stream.plates:
        return np.zeros((frames, 0, 1, 6))
    each = max(1, round(stream.plate_rate_hz / stream.rate_hz))
    at_s = stream.start_time_s + np.arange(frames * each) / (each * stream.rate_hz)
    place = np.clip((at_s - stream.plates[0].start_time_s) * stream.plate_rate_hz, 0, len(played.wrench) - 1)
    near = np.round(place)
    place = np.where(np.abs(place - near) < 1e-6, near, place)
    low = np.floor(place).astype(int)
    high = np.minimum(low + 1, len(played.wrench) - 1)
    share = (place - low)[:, None, None]
    wrench = (1.0 - share) * played.wrench[low] + share * played.wrench[high]
    turned = np.empty_like(wrench)
    for k, plate in enumerate(stream.plates):
        axes = axes_of(None if plate.corners_m is None else plate.corners_m)
        turned[:, k, :3], turned[:, k, 3:] = wrench[:, k, :3] @ axes, wrench[:, k, 3:] @ axes
    return turned.reshape(frames, each, len(stream.plates), 6).transpose(0, 2, 1, 3)


def axes_of(corners_m: Array | None) -> Array:
    """(3, 3) axes of a plate as columns, by its corners (4, 3); those of the world where it has none."""
    if corners_m is None or not has_area(corners_m):
        return np.eye(3)
    axes = plate_axes(corners_m)
    near = np.round(axes)
    return near if np.abs(axes - near).max() < 1e-6 else axes


def _description(k: int, plate: PlateReadings) -> packets.ForcePlate:
    """A plate without known corners is a point."""
    rotation = rotation_to_world(UP)
    corners = np.tile(plate.origin_m, (4, 1)) if plate.corners_m is None else plate.corners_m
    offset = (plate.origin_m - corners.mean(axis=0)) @ axes_of(corners)
    return packets.ForcePlate(k + 1, plate.name, offset, corners @ rotation)
