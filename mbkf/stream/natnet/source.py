"""Frames from OptiTrack's Motive through the client library ``natnet``: markers, points without names, force plates."""

from __future__ import annotations

import socket
import threading
import time
from collections import deque
from types import ModuleType
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world, up_axis
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.libraries import library
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.player import axes_of, has_area
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, empty_plate

CONNECT_S = 2.0
"""How long a connected server may take to describe its stream and to send frames."""

RATE_FRAMES = 10
"""The frame rate is computed from the time stamps of so many frames."""

WHOLE_RATE = 2e-3
"""A rate nearer than this share to a whole number is that number."""

RECONNECT_AFTER_S = 2.0
"""After so long without a frame the connection is made anew."""

MOST_HELD = 64
"""Received frames held until they are read; the oldest are dropped first."""

ROOM_BYTES = 4 * 1024 * 1024
"""Size of the socket's receive buffer, as far as the system allows: its usual 200 kB hold a tenth of a second with many
plates, and packets beyond that are lost."""

EVERYTHING = "all"
"""Motive's set of all markers; it repeats the others."""


class NatNetSource:
    """A :class:`mbkf.stream.source.FrameSource`."""

    patient = False

    def __init__(self, server: str, local: str, port: int, multicast: str | None, up: str = "y") -> None:
        """A source that is not connected yet.

        Args:
            server: Address of the camera computer.
            local: Address of this computer.
            port: Command port of Motive.
            multicast: Multicast group; None for unicast.
            up: Axis that points up in Motive's stream.

        Raises:
            MissingDependency: The library ``natnet`` is not installed.
        """
        self._natnet = library("natnet", "OptiTrack NatNet", "natnet")
        read_all_corners(self._natnet)
        self._options: dict[str, Any] = {
            "server_ip_address": server,
            "local_ip_address": local,
            "command_port": port,
            "data_port": port + 1,
            "use_multicast": multicast is not None,
        }
        if multicast is not None:
            self._options["multicast_address"] = multicast
        self._rotation = rotation_to_world(up_axis(up))
        self._client: Any = None
        self._changed = threading.Condition()
        self._frames: deque[tuple[float, Any]] = deque(maxlen=MOST_HELD)
        self._descriptions: Any = None
        self._stream: StreamDescription | None = None
        self._axes: list[Array] = []
        self._samples = 1
        self._heard_s = 0.0
        self._news: list[tuple[str, str]] = []

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """Requests the stream's description and waits for the first frames, which give the rate; none is lost."""
        if self._client is None and not self._open(timeout_s):
            return None
        with self._changed:
            self._changed.wait_for(
                lambda: self._descriptions is not None and len(self._frames) >= RATE_FRAMES, CONNECT_S
            )
            frames, described = list(self._frames), self._descriptions
        if described is None or len(frames) < RATE_FRAMES:
            self._ask()
            return None
        self._stream = self._described(described, frames)
        self._heard_s = time.perf_counter()
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame; after a silence the connection is made anew."""
        assert self._stream is not None, "connect first"
        with self._changed:
            self._changed.wait_for(lambda: self._frames, timeout_s)
            arrived = self._frames.popleft() if self._frames else None
        if arrived is None:
            if time.perf_counter() - self._heard_s > RECONNECT_AFTER_S:
                self._again(timeout_s)
            return None
        self._heard_s, frame = arrived
        markers, points = self._points(frame)
        return SourceFrame(frame.prefix.frame_number, arrived[0], markers, points, self._plates(frame))

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news, self._news = self._news, []
        return news

    def close(self) -> None:
        """Ends the connection."""
        if self._client is not None:
            self._client.shutdown()
            self._client = None

    def _open(self, timeout_s: float) -> bool:
        client = self._natnet.NatNetClient(**self._options)
        try:
            client.connect(timeout_s)
        except TimeoutError:
            return False
        except (self._natnet.NatNetError, OSError) as error:
            raise InvalidInput(f"NatNet: {' '.join(str(error).split())}") from error
        _make_room(client)
        client.on_data_frame_received_event.handlers.append(self._take)
        client.on_data_description_received_event.handlers.append(self._take_descriptions)
        client.run_async()
        self._client = client
        self._ask()
        return True

    def _ask(self) -> None:
        self._client.request_modeldef()

    def _take(self, frame: Any) -> None:
        arrival_s = time.perf_counter()
        with self._changed:
            self._frames.append((arrival_s, frame))
            self._changed.notify_all()

    def _take_descriptions(self, described: Any) -> None:
        with self._changed:
            self._descriptions = described
            self._changed.notify_all()

    def _again(self, timeout_s: float) -> None:
        if self._client is not None:
            self._news.append(("connection", "the connection to the camera computer is made anew"))
        self.close()
        if self._open(timeout_s):
            self._heard_s = time.perf_counter()

    def _described(self, described: Any, frames: list[tuple[float, Any]]) -> StreamDescription:
        """The stream's description, its rate computed from the first frames.

        Raises:
            InvalidInput: The time stamps give no rate, or plates send raw voltages.
        """
        self._sets = [s for s in described.marker_sets if s.name.lower() != EVERYTHING]
        names = [name for one in self._sets for name in one.marker_names]
        rate_hz = _rate([frame for _, frame in frames])
        first = frames[0][1]
        self._samples = max((len(plate.channel_arrays[0]) for plate in first.force_plates), default=1)
        plates = [self._plate(plate, rate_hz * self._samples) for plate in described.force_plates]
        self._plate_ids = [plate.id_num for plate in described.force_plates]
        trial = self._sets[0].name if self._sets else "natnet"
        return StreamDescription(trial, tuple(names), rate_hz, 0.0, tuple(plates))

    def _plate(self, plate: Any, rate_hz: float) -> PlateReadings:
        if plate.channel_data_type != 0 or len(plate.channel_list) < len(packets.CHANNELS):
            raise InvalidInput(
                f"NatNet: force plate {plate.serial_number} sends raw voltages; let Motive stream calibrated forces"
            )
        corners = np.array(plate.corners) @ self._rotation.T
        axes = axes_of(corners) if has_area(corners) else np.eye(3)
        self._axes.append(axes)
        origin = corners.mean(axis=0) + axes @ np.array(plate.position)
        known = corners if has_area(corners) else None
        name = plate.serial_number or str(plate.id_num)
        return empty_plate(name, rate_hz, 0.0, origin, DEFAULT_COP_THRESHOLD_N, known)

    def _points(self, frame: Any) -> tuple[Array, Array]:
        """(M, 3) named markers and (N, 3) points; what Motive only filled in counts as missing."""
        labelled = frame.labeled_markers or ()
        filled = {marker.pos for marker in labelled if marker.occluded}
        sets = {one.model_name: one.marker_pos_list for one in frame.marker_sets}
        rows: list[tuple[float, ...]] = []
        unseen = (np.nan, np.nan, np.nan)
        for one in self._sets:
            found = sets.get(one.name, ())
            count = len(one.marker_names)
            rows += [*found, *[unseen] * count][:count] if len(found) <= count else found[:count]
        markers = np.array(
            [unseen if row in filled or row == (0.0, 0.0, 0.0) else row for row in rows], dtype=float
        )
        points = frame.unlabeled_marker_pos or [m.pos for m in labelled if m.unlabeled]
        return (
            markers.reshape(-1, 3) @ self._rotation.T,
            np.array(points, dtype=float).reshape(-1, 3) @ self._rotation.T,
        )

    def _plates(self, frame: Any) -> PlateSamples:
        """The frame's samples, numbered from the frame's own number."""
        assert self._stream is not None
        count = len(self._stream.plates)
        by_id = {plate.id_num: plate.channel_arrays for plate in frame.force_plates or ()}
        if not count or not by_id:
            return PlateSamples.none(count)
        wrench = np.full((self._samples, count, 6), np.nan)
        for k, identity in enumerate(self._plate_ids):
            channels = by_id.get(identity, ())
            if len(channels) < 6 or any(len(one) != self._samples for one in channels[:6]):
                continue
            values = np.array(channels[:6]).T
            wrench[:, k, :3] = values[:, :3] @ self._axes[k].T
            wrench[:, k, 3:] = values[:, 3:] @ self._axes[k].T
        first = frame.prefix.frame_number * self._samples
        return PlateSamples(np.arange(first, first + self._samples), wrench)


def _make_room(client: Any) -> None:
    """Gives a connected client's sockets a long queue; they are private attributes of the client."""
    for own in vars(client).values():
        if isinstance(own, socket.socket):
            own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM_BYTES)


def read_all_corners(natnet: ModuleType) -> None:
    """Makes the client library read a force plate's description to its end.

    natnet 0.3.0 reads three of a plate's four corners, and everything after them wrongly.
    """
    # Corners of nought make even a wrong reading short.
    packed = packets.plate_description(packets.PlateDescription(1, "x", np.zeros(3), np.zeros((4, 3))))
    module = natnet.data_descriptions
    buffer = natnet.packet_buffer.PacketBuffer(packed)
    version = natnet.Version(*packets.VERSION)
    module.ForcePlateDescription.read_from_buffer(buffer, version)
    if buffer.pointer == len(packed):
        return
    fields = module.ForcePlateDescription

    class WithFourCorners(fields):  # type: ignore[misc, valid-type]
        """A force plate's description with all its corners."""

        @classmethod
        def read_from_buffer(cls, buffer: Any, protocol_version: Any) -> Any:
            """Reads it as NatNet 3 and later send it."""
            del protocol_version
            number, serial = buffer.read_uint32(), buffer.read_string()
            width, length = buffer.read_float32(), buffer.read_float32()
            origin = buffer.read_float32_array(3)
            calibration = tuple(buffer.read_float32_array(12) for _ in range(12))
            corners = tuple(buffer.read_float32_array(3) for _ in range(4))
            kind, data, count = (buffer.read_uint32() for _ in range(3))
            names = tuple(buffer.read_string() for _ in range(count))
            return fields(number, serial, width, length, origin, calibration, corners, kind, data, names)

    module.ForcePlateDescription = WithFourCorners


def _rate(frames: list[Any]) -> float:
    first, last = frames[0], frames[-1]
    count = last.prefix.frame_number - first.prefix.frame_number
    passed = last.suffix.timestamp - first.suffix.timestamp
    if count <= 0 or passed <= 0.0:
        raise InvalidInput("NatNet: the frames' numbers and time stamps determine no rate")
    rate_hz = count / passed
    whole = float(round(rate_hz))
    return whole if abs(rate_hz - whole) <= WHOLE_RATE * rate_hz else float(round(rate_hz, 4))
