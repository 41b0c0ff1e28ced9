"""A DataStream server that plays a capture, as Nexus or Tracker would, from the layout in the SDK's public headers.

Facts of layout from the headers ViconCGStream of Vicon's DataStream SDK (MIT): a packet is a block of type 0x1a2b0001
that holds blocks of objects, each behind its type and length, little endian; the server first lists the types that it
has; periods are ticks of 135 MHz; samples of a plate follow component by component. Places in mm, forces in N.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.streams.tcp_server import HEAD, Connected, TcpServer
from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.plate_corners import plate_axes
from mbkf.stream.played import Played, PlayedFrame

TICKS_PER_S = 135_000_000
TYPES = {
    "stream": 1, "subject": 2, "device": 3, "channel": 4, "frame": 5, "labeled": 6, "unlabeled": 7, "global": 9,
    "force": 10, "moment": 11, "centre": 12, "plate": 20, "timecode": 23, "application": 37, "start": 38,
    "enums": 100001, "request": 100002, "contents": 100004,
}  # fmt: skip
STATIC = ("stream", "subject", "device", "start", "channel", "plate", "application")
PACKET = 0x1A2B0001
SUBJECT, BODY = 7, "walker"
"""ID and name of the subject; its root segment, of the same name, stands in the middle of the markers."""

SHOWN = 2
"""Single frames that a client is shown of the first frame, as cameras see a person before a movement begins."""

TO_TOP_MM = 40.0
"""Depth of a plate's transducers below its upper side."""


@dataclass(frozen=True)
class PlateConvention:
    """Conventions of plates that a program may have.

    Attributes:
        on_body: Whether forces are those on the body.
        moment_unit: Unit of moments, N m.
        centre_unit: Unit of centres of pressure, m.
        at_sensor: Whether moments are about the transducers.
    """

    on_body: bool = False
    moment_unit: float = 1e-3
    centre_unit: float = 1.0
    at_sensor: bool = False


@dataclass(eq=False)
class Client(Connected):
    """A client: types that it wants, its requests, and frames shown before anything is played."""

    wanted: frozenset[int] = frozenset()
    streaming: bool = False
    asked: int = 0
    shown: int = 0
    told: dict[int, bytes] = field(default_factory=dict)


class ViconServer(TcpServer[Client]):
    """A :class:`mbkf.stream.replay.Player`.

    Attributes:
        port: Its port.
        names: Names of the markers, which a test may exchange.
        subject: Name of the subject.
        y_up: Whether y points up in its world.
        convention: Conventions of the plates.
    """

    def __init__(
        self,
        played: Played,
        address: str = "127.0.0.1",
        port: int = 0,
        convention: PlateConvention | None = None,
    ) -> None:
        """Listens.

        Args:
            played: The capture.
            address: Address of this computer.
            port: The port; 0 for any free one.
            convention: Conventions of the plates.

        Raises:
            InvalidInput: Plates do not start with the frames, or have no whole number of samples in a frame.
        """
        stream = played.stream
        ratio = stream.plate_rate_hz / stream.rate_hz
        late = [one.name for one in stream.plates if one.start_time_s != stream.start_time_s]
        if abs(ratio - round(ratio)) > 1e-6 or late:
            raise InvalidInput(
                "the simulated server needs plates that start with the frames, at a multiple of their rate"
            )
        super().__init__("vicon-server", address, port, Client)
        self.played, self.names, self.subject = played, list(stream.marker_names), BODY
        self.convention, self.y_up = convention or PlateConvention(), False
        self._ratio = round(ratio)
        self._corners = [_corners(plate.corners_m, plate.origin_m) for plate in stream.plates]
        self.port = self.tcp_port
        self.start()

    def listening(self) -> bool:
        """True once a client asks for frames and has been shown the first one :data:`SHOWN` times."""
        return bool(self.ready())

    def ready(self) -> list[Client]:
        """Clients that ask for frames."""
        return [one for one in self.clients() if one.streaming or one.asked]

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame to all who ask for one."""
        del age_s
        self.send_frame(frame)

    def send_frame(self, frame: PlayedFrame, number: int | None = None, wrench: Array | None = None) -> bool:
        """Sends a frame; true where somebody asked for one.

        Args:
            frame: The frame.
            number: Its count; its own by default.
            wrench: (S, K, 6) samples of the plates; those of the capture by default.
        """
        clients = self.ready()
        blocks = self.blocks(frame, number, wrench)
        for client in clients:
            with self._lock:
                client.asked = max(0, client.asked - 1)
            self.send_blocks(client, blocks)
        return bool(clients)

    def send_blocks(self, client: Client, blocks: Sequence[tuple[int, bytes]]) -> None:
        """Sends a packet of blocks, with those that describe the stream where they are new to the client."""
        static: dict[int, bytes] = {}
        for kind, data in self.static():
            static[kind] = static.get(kind, b"") + block(kind, data)
        new = {kind: data for kind, data in static.items() if client.told.get(kind) != data}
        client.told |= new
        unchanged = [kind for kind in static if kind not in new]
        table = struct.pack("<I", 0) + struct.pack(
            f"<{1 + len(unchanged)}I", len(unchanged), *sorted(unchanged)
        )
        body = block(TYPES["contents"], table) + b"".join(
            data for kind, data in new.items() if kind in client.wanted
        )
        body += b"".join(block(kind, data) for kind, data in blocks if kind in client.wanted)
        self.raw(client, block(PACKET, body))

    def blocks(
        self, frame: PlayedFrame, number: int | None = None, wrench: Array | None = None
    ) -> list[tuple[int, bytes]]:
        """Types and objects of a frame.

        Args:
            frame: The frame.
            number: Its count; its own by default.
            wrench: (S, K, 6) samples of the plates; those of the capture by default.
        """
        count = frame.number if number is None else number
        found = [
            (TYPES["frame"], struct.pack("<I", count % 2**32)),
            (TYPES["timecode"], struct.pack("<4B2HIIB", 10, 11, 12, 13, 0, 4, 0, 0, 0)),
        ]
        markers = self._turned(frame.markers_m)
        there = np.isfinite(markers).all(axis=1)
        if self.played.stream.marker_names:
            rows = [
                struct.pack("<2Id3d9dI", SUBJECT, k + 1, 7.0, *(1e3 * markers[k]), *np.eye(3).ravel(), k)
                for k in np.flatnonzero(there)
            ]
            found.append((TYPES["labeled"], _list(rows)))
            middle = 1e3 * markers[there].mean(axis=0) if there.any() else np.zeros(3)
            segment = struct.pack("<I3d9d", 1, *middle, *np.eye(3).ravel())
            found.append((TYPES["global"], struct.pack("<I", SUBJECT) + _list([segment])))
        else:
            rows = [
                struct.pack("<d3d9dI", 7.0, *(1e3 * one), *np.eye(3).ravel(), 0) for one in markers[there]
            ]
            found.append((TYPES["unlabeled"], _list(rows)))
        return found + self._forces(frame.number, wrench)

    def static(self) -> list[tuple[int, bytes]]:
        """Types and objects that describe the stream."""
        stream = self.played.stream
        period = round(TICKS_PER_S / stream.rate_hz)
        segment = struct.pack("<2I6f", 0, 1, *np.zeros(6)) + _text(self.subject)
        markers = [struct.pack("<I", k + 1) + _text(name) for k, name in enumerate(self.names)]
        attached = [struct.pack("<2I", k + 1, 1) for k in range(len(self.names))]
        found = [
            (TYPES["stream"], struct.pack("<q", period)),
            (TYPES["application"], bytes([self.y_up])),
        ]
        if self.names:
            subject = struct.pack("<I", SUBJECT) + _text(self.subject)
            found.append((TYPES["subject"], subject + _list([segment]) + _list(markers) + _list(attached)))
        for k, corners in enumerate(self._corners):
            device = 10 + k
            found.append((TYPES["device"], struct.pack("<IQ", device, period) + _text(f"Plate {k + 1}")))
            found.append((TYPES["start"], struct.pack("<IQ", device, 0)))
            for channel, names in enumerate((("Fx", "Fy", "Fz"), ("Mx", "My", "Mz"), ("Cx", "Cy", "Cz")), 1):
                parts = _list([_text(name) for name in names])
                found.append(
                    (TYPES["channel"], struct.pack("<2I", device, channel) + _text(names[0][0]) + parts)
                )
            found.append((TYPES["plate"], self._plate(device, corners)))
        return found

    def _plate(self, device: int, corners_m: Array) -> bytes:
        axes, middle = plate_axes(corners_m), corners_m.mean(axis=0)
        local = 1e3 * (corners_m - middle) @ axes
        bounds = [*local.min(axis=0), *local.max(axis=0)]
        turn, place = self._turned(axes.T).T, self._turned(1e3 * middle)
        sensor = [0.0, 0.0, TO_TOP_MM]
        return struct.pack(
            "<I3f9f6f3f9f", device, *place, *turn.ravel(), *bounds, *sensor, *np.eye(3).ravel()
        )

    def _forces(self, number: int, wrench: Array | None) -> list[tuple[int, bytes]]:
        stream, found = self.played.stream, []
        own = self.played.wrench[number * self._ratio : (number + 1) * self._ratio]
        samples = own if wrench is None else wrench
        if len(samples) != self._ratio:
            return []
        for k, (plate, corners) in enumerate(zip(stream.plates, self._corners, strict=True)):
            head = struct.pack("<2I", number, 10 + k)
            for name, channel, values in zip(
                ("force", "moment", "centre"),
                (1, 2, 3),
                self._on_plate(samples[:, k], plate.origin_m, corners),
                strict=True,
            ):
                numbers = np.ascontiguousarray(values.T, dtype="<f4").ravel()
                data = head + struct.pack("<2I", channel, len(numbers)) + numbers.tobytes()
                found.append((TYPES[name], data))
        return found

    def _on_plate(self, wrench: Array, origin_m: Array, corners_m: Array) -> tuple[Array, Array, Array]:
        """Force N, moment and centre of pressure (S, 3) by the convention, in the plate's axes."""
        way, axes, middle = self.convention, plate_axes(corners_m), corners_m.mean(axis=0)
        moment = wrench[:, 3:] + np.cross(origin_m - middle, wrench[:, :3])
        force, moment = wrench[:, :3] @ axes, moment @ axes
        with np.errstate(divide="ignore", invalid="ignore"):
            centre = np.stack([-moment[:, 1], moment[:, 0], 0.0 * moment[:, 0]], axis=1) / force[:, 2:]
        centre = np.where(np.abs(force[:, 2:]) > 10.0, centre, 0.0)
        if way.at_sensor:
            moment = moment - np.cross([0.0, 0.0, 1e-3 * TO_TOP_MM], force)
        sign = 1.0 if way.on_body else -1.0
        return sign * force, sign * moment / way.moment_unit, centre / way.centre_unit

    def _turned(self, vectors: Array) -> Array:
        """Vectors (…, 3) in its world's axes: of one with y up, (x, y, z) are (x, z, −y)."""
        return vectors[..., [0, 2, 1]] * [1.0, 1.0, -1.0] if self.y_up else vectors

    def greet(self, client: Client) -> None:
        """Lists the types that it has."""
        kinds = [kind for name, kind in TYPES.items() if name not in ("enums", "request")]
        listed = struct.pack(f"<{1 + len(kinds)}I", len(kinds), *sorted(kinds))
        self.raw(client, block(PACKET, block(TYPES["enums"], listed)))

    def size(self, head: bytes) -> int:
        """Bytes of the packet that begins with this head."""
        return len(head) + int(struct.unpack_from("<I", head, 4)[0])

    def obey(self, client: Client, packet: bytes) -> None:
        """Takes the types that a client wants, or its request for frames."""
        at = HEAD
        while at + 8 <= len(packet):
            kind, size = struct.unpack_from("<2I", packet, at)
            data = packet[at + 8 : at + 8 + size]
            if kind == TYPES["enums"]:
                client.wanted = frozenset(struct.unpack_from(f"<{len(data) // 4 - 1}I", data, 4))
                client.told = {}
            elif kind == TYPES["request"]:
                self._request(client, bool(data[0]))
            at += 8 + size

    def _request(self, client: Client, streaming: bool) -> None:
        if not streaming and client.shown < SHOWN:
            client.shown += 1
            self.send_blocks(client, self.blocks(next(iter(self.played.frames()))))
            return
        with self._lock:
            client.streaming = streaming
            client.asked += not streaming


def block(kind: int, data: bytes) -> bytes:
    """An object behind its type and length."""
    return struct.pack("<2I", kind, len(data)) + data


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text.encode())) + text.encode()


def _list(items: Sequence[bytes]) -> bytes:
    return struct.pack("<I", len(items)) + b"".join(items)


def _corners(corners_m: Array | None, origin_m: Array) -> Array:
    """(4, 3) corners; those of a plate of 0.5 m about its origin where it has none."""
    if corners_m is not None:
        return corners_m
    sides = 0.25 * np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0]])
    return origin_m + sides
