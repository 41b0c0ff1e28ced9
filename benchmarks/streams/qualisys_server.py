"""A server of QTM's real-time protocol that plays a capture, written from the protocol's public description alone.

Source: QTM Real-time Server Protocol Documentation (Qualisys), sections on packets, commands, parameters and data.
Points in mm, forces on the plate in its own axes (z down), numbered with their own frequency.
"""

from __future__ import annotations

import socket
import struct
from contextlib import suppress
from dataclasses import dataclass
from xml.sax.saxutils import escape

import numpy as np

from benchmarks.streams.tcp_server import HEAD, Connected, TcpServer
from mbkf.conventions import Array
from mbkf.io.plate_corners import plate_axes
from mbkf.stream.played import Played, PlayedFrame

KNOWN_VERSIONS = tuple(f"1.{minor}" for minor in range(26))
CAMERAS_CHANGED = 11
COMPONENTS = {
    "3d": 1, "3dnolabels": 2, "analog": 3, "force": 4, "6d": 5, "6deuler": 6, "3dres": 9, "3dnolabelsres": 10,
}  # fmt: skip
RESIDUAL_MM = 0.4
BODY = "torso"
"""A rigid body for clients of bodies: it stands in the middle of the markers and does not turn."""


@dataclass(eq=False)
class Client(Connected):
    """A client.

    Attributes:
        components: Types that it wants streamed; none before it asked.
        udp: Where it wants them; None for its connection.
    """

    components: tuple[int, ...] = ()
    udp: tuple[str, int] | None = None


class QtmServer(TcpServer[Client]):
    """A :class:`mbkf.stream.replay.Player`.

    Attributes:
        port: Base port.
        names: Labels of the markers, which a test may exchange.
        commands: What clients asked for.
        password: What takes control.
    """

    def __init__(
        self,
        played: Played,
        address: str = "127.0.0.1",
        port: int = 0,
        most_version: str = "1.25",
        discover_port: int | None = None,
    ) -> None:
        """Listens at the port after the base port.

        Args:
            played: The capture.
            address: Address of this computer.
            port: Base port; 0 for any.
            most_version: The newest version of the protocol that it knows.
            discover_port: Port at which it answers clients that look for it, 0 for any; None for none.
        """
        super().__init__("qtm", address, port + 1 if port else 0, Client)
        self.played = played
        self.names = list(played.stream.marker_names)
        self.password = ""
        self.commands: list[str] = []
        self.measuring = False
        self._known = KNOWN_VERSIONS[: KNOWN_VERSIONS.index(most_version) + 1]
        self._corners = [p.corners_m for p in played.stream.plates if p.corners_m is not None]
        self.port = self.tcp_port - 1
        self._datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._finder = self._discoverable(address, discover_port)
        self.start()

    def listening(self) -> bool:
        """True once a client asked for frames."""
        return any(one.components for one in self.clients())

    def send(self, frame: PlayedFrame, age_s: float) -> None:
        """Sends a frame to all who asked for frames."""
        del age_s
        for one in self.clients():
            if one.components:
                self.send_data(one, self.data(frame, one.components))

    def data(self, frame: PlayedFrame, components: tuple[int, ...], number: int | None = None) -> bytes:
        """The payload of a data packet.

        Args:
            frame: The frame.
            components: Types of its components.
            number: The count that it carries; None for the frame's own.
        """
        counted = frame.number if number is None else number
        parts = [self._component(kind, frame) for kind in components]
        head = struct.pack(
            "<QII", int(1e6 * frame.number / self.played.stream.rate_hz), counted & 0xFFFFFFFF, len(parts)
        )
        sized = [
            struct.pack("<II", 8 + len(part), kind) + part
            for kind, part in zip(components, parts, strict=True)
        ]
        return head + b"".join(sized)

    def send_data(self, client: Client, payload: bytes) -> None:
        """Sends a data packet to a client."""
        self._send(client, 3, payload)

    def to_all(self, kind: int, payload: bytes) -> bool:
        """Sends a packet to every client; true where there is one."""
        for one in self.clients():
            self._send(one, kind, payload)
        return bool(self.clients())

    @property
    def discover_port(self) -> int | None:
        """The port at which it answers clients that look for it."""
        return None if self._finder is None else int(self._finder.getsockname()[1])

    def streaming(self) -> list[Client]:
        """Clients that asked for frames."""
        return [one for one in self.clients() if one.components]

    def close(self) -> None:
        """Ends all connections."""
        self._closed.set()
        if self._finder is not None:
            with suppress(OSError):
                self._finder.shutdown(socket.SHUT_RDWR)
            self._finder.close()
        super().close()
        self._datagrams.close()

    def parameters(self, wanted: list[str]) -> str:
        """XML of the parameters asked for."""
        blocks = {"general": self._general, "3d": self._three_d, "force": self._force, "6d": self._six_d}
        everything = "all" in wanted
        text = "".join(block() for name, block in blocks.items() if everything or name in wanted)
        return f"<QTM_Parameters_Ver_1.25>{text}</QTM_Parameters_Ver_1.25>"

    def _discoverable(self, address: str, port: int | None) -> socket.socket | None:
        """The socket at which it is looked for; None without one."""
        if port is None:
            return None
        finder = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        finder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        finder.bind((address, port))
        finder.settimeout(0.1)
        self._run(self._be_found, finder)
        return finder

    def _be_found(self, finder: socket.socket) -> None:
        """Answers a discover packet: ten bytes, the last two the port for the answer, in network byte order."""
        answer = b"simulator, QTM 2.17 (build 4000), 8 cameras\0"
        while not self._closed.is_set():
            try:
                data, (sender, *_) = finder.recvfrom(1024)
            except TimeoutError:
                continue
            except OSError:
                return
            if len(data) == 10 and struct.unpack_from("<II", data) == (10, 7):
                head = struct.pack("<II", 10 + len(answer), 1)
                to = (sender, struct.unpack_from(">H", data, 8)[0])
                finder.sendto(head + answer + struct.pack(">H", self.port), to)

    def greet(self, client: Client) -> None:
        """States that it is QTM."""
        self._answer(client, "QTM RT Interface connected")

    def size(self, head: bytes) -> int:
        """Bytes of the packet that begins with this head."""
        return int(struct.unpack_from("<I", head)[0])

    def obey(self, client: Client, packet: bytes) -> None:
        """Does a command."""
        if struct.unpack_from("<I", packet, 4)[0] == 1:
            self._obey(client, packet[HEAD:].rstrip(b"\0").decode("ascii", "replace"))

    def _obey(self, client: Client, text: str) -> None:
        self.commands.append(text)
        word, *rest = text.split() or [""]
        word, lower = word.lower(), [one.lower() for one in rest]
        if word == "version":
            known = rest and rest[0] in self._known
            self._answer(
                client, f"Version set to {rest[0]}" if known else "Version NOT supported", error=not known
            )
        elif word == "qtmversion":
            self._answer(client, "QTM Version is 2.17 (build 4000)")
        elif word == "byteorder":
            self._answer(client, "Byte order is little endian")
        elif word == "getparameters":
            self._send(client, 2, self.parameters(lower).encode() + b"\0", over_tcp=True)
        elif word == "streamframes":
            self._stream(client, lower)
        elif word == "getcurrentframe":
            kinds = tuple(COMPONENTS[one] for one in lower if one in COMPONENTS)
            self._send(client, 3, self.data(next(iter(self.played.frames())), kinds), over_tcp=True)
        elif word == "getstate":
            self._send(client, 6, bytes([1]), over_tcp=True)
        elif word == "takecontrol":
            right = (rest[0] if rest else "") == self.password
            self._answer(
                client, "You are now master" if right else "Wrong or missing password", error=not right
            )
        elif word in {"start", "stop", "releasecontrol"}:
            self.measuring = word == "start" if word != "releasecontrol" else self.measuring
            said = {"start": "Starting measurement", "stop": "Stopping measurement"}
            self._answer(client, said.get(word, "You are now a regular client"))
        else:
            self._answer(client, "Parse error", error=True)

    def _stream(self, client: Client, words: list[str]) -> None:
        if words[:1] == ["stop"]:
            client.components = ()
            return
        udp = [one for one in words if one.startswith("udp:")]
        if udp:
            *host, port = udp[0].removeprefix("udp:").split(":")
            client.udp = (host[0] if host else client.connection.getpeername()[0], int(port))
        client.components = tuple(COMPONENTS[one] for one in words if one in COMPONENTS)

    def _answer(self, client: Client, text: str, error: bool = False) -> None:
        self._send(client, 0 if error else 1, text.encode() + b"\0", over_tcp=True)

    def _send(self, client: Client, kind: int, payload: bytes, over_tcp: bool = False) -> None:
        data = struct.pack("<II", 8 + len(payload), kind) + payload
        with suppress(OSError), client.lock:
            if client.udp is not None and not over_tcp:
                self._datagrams.sendto(data, client.udp)
            else:
                client.connection.sendall(data)

    def _component(self, kind: int, frame: PlayedFrame) -> bytes:
        labelled = frame.markers_m[: len(self.names)] if self.names else frame.markers_m[:0]
        bare = frame.markers_m[:0] if self.names else frame.markers_m[~np.isnan(frame.markers_m).any(axis=1)]
        if kind in (1, 9):
            return _points(labelled, kind == 9, ids=False)
        if kind in (2, 10):
            return _points(bare, kind == 10, ids=True)
        if kind == 4:
            return self._forces(frame)
        if kind in (5, 6):
            return self._body(frame, kind)
        return struct.pack("<I", 0)

    def _forces(self, frame: PlayedFrame) -> bytes:
        samples, parts = frame.plates, []
        for k, (plate, corners) in enumerate(zip(self.played.stream.plates, self._corners, strict=True)):
            first = int(samples.index[0]) if len(samples.index) else 0
            values = on_plate(samples.wrench[:, k], plate.origin_m, corners)
            parts.append(
                struct.pack("<III", k + 1, len(values), first & 0xFFFFFFFF) + values.astype("<f4").tobytes()
            )
        return struct.pack("<I", len(parts)) + b"".join(parts)

    def _body(self, frame: PlayedFrame, kind: int) -> bytes:
        """The body; its rotation is a matrix (5) or three angles (6)."""
        seen = frame.markers_m[~np.isnan(frame.markers_m).any(axis=1)]
        place = 1e3 * seen.mean(axis=0) if len(seen) else np.full(3, np.nan)
        turned = np.eye(3).ravel() if kind == 5 else np.zeros(3)
        return struct.pack("<Ihh", 1, 0, 0) + np.concatenate([place, turned]).astype("<f4").tobytes()

    def _general(self) -> str:
        rate = f"<Frequency>{self.played.stream.rate_hz:g}</Frequency>"
        return f"<General>{rate}<Capture_Time>60</Capture_Time></General>"

    def _three_d(self) -> str:
        labels = "".join(
            f"<Label><Name>{escape(one)}</Name><RGBColor>255</RGBColor></Label>" for one in self.names
        )
        return f"<The_3D><AxisUpwards>+Z</AxisUpwards><Labels>{len(self.names)}</Labels>{labels}</The_3D>"

    def _six_d(self) -> str:
        body = f"<Body><Name>{BODY}</Name><RGBColor>255</RGBColor></Body>"
        names = "<Euler><First>Roll</First><Second>Pitch</Second><Third>Yaw</Third></Euler>"
        return f"<The_6D><Bodies>1</Bodies>{body}{names}</The_6D>"

    def _force(self) -> str:
        plates = ""
        for k, (plate, corners) in enumerate(zip(self.played.stream.plates, self._corners, strict=True)):
            place = "".join(
                f"<Corner{c + 1}><X>{x:.6f}</X><Y>{y:.6f}</Y><Z>{z:.6f}</Z></Corner{c + 1}>"
                for c, (x, y, z) in enumerate(1e3 * corners)
            )
            plates += (
                f"<Plate><Plate_ID>{k + 1}</Plate_ID><Analog_Device_ID>1</Analog_Device_ID>"
                f"<Frequency>{plate.rate_hz:g}</Frequency><Type>AMTI</Type><Name>{escape(plate.name)}</Name>"
                f"<Length>600</Length><Width>400</Width><Location>{place}</Location>"
                "<Origin><X>0</X><Y>0</Y><Z>-40</Z></Origin></Plate>"
            )
        return f"<Force><Unit_Length>mm</Unit_Length><Unit_Force>N</Unit_Force>{plates}</Force>"


def on_plate(wrench: Array, origin_m: Array, corners_m: Array) -> Array:
    """(S, 9) force on the plate N, moment N m about its centre and point of application mm, in the plate's axes.

    Args:
        wrench: (S, 6) force of the plate on the body and moment about the plate's origin, world axes.
        origin_m: (3,) that origin.
        corners_m: (4, 3) corners.
    """
    axes, centre = plate_axes(corners_m), corners_m.mean(axis=0)
    force = -wrench[:, :3]
    moment = -wrench[:, 3:] + np.cross(origin_m - centre, force)
    force, moment = force @ axes, moment @ axes
    with np.errstate(divide="ignore", invalid="ignore"):
        point = np.stack([-moment[:, 1] / force[:, 2], moment[:, 0] / force[:, 2], 0.0 * force[:, 2]], axis=1)
    return np.hstack([force, moment, np.where(np.abs(force[:, 2:]) > 10.0, 1e3 * point, 0.0)])


def _points(points_m: Array, residuals: bool, ids: bool) -> bytes:
    """A component of points in mm; missing ones have all bits set."""
    rows = np.full((len(points_m), 3 + ids + residuals), RESIDUAL_MM, dtype="<f4")
    rows[:, :3] = 1e3 * points_m
    if ids:
        rows[:, 3] = np.arange(1, len(rows) + 1, dtype="<i4").view("<f4")
    rows.view("<u4")[np.isnan(points_m).any(axis=1), :3] = 0xFFFFFFFF
    return struct.pack("<Ihh", len(rows), 0, 0) + rows.tobytes()
