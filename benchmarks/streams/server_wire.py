"""A simulated server that a source connects to, as a wire: it ends, serves again, serves fewer markers."""

from __future__ import annotations

from typing import Generic, TypeVar

from benchmarks.robustness.stream_schedule import Sent
from benchmarks.robustness.stream_wire import with_other_markers
from benchmarks.streams.qualisys_server import QtmServer
from benchmarks.streams.vicon_server import ViconServer
from mbkf.stream.played import Played

ServerT = TypeVar("ServerT", QtmServer, ViconServer)


class ServerWire(Generic[ServerT]):
    """The wire's connection. Methods beyond those of a wire are acts of a schedule."""

    def __init__(self, played: Played, kind: type[ServerT]) -> None:
        """Begins to serve.

        Args:
            played: The capture.
            kind: The server's class.
        """
        self._played = self._served = played
        self._kind: type[ServerT] = kind
        self._server: ServerT | None = kind(played)
        self._port: int = self._server.port

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

    def rename(self) -> None:
        """The server states other names of markers."""
        if self._server is not None:
            self._server.names = [f"other_{name}" for name in self._server.names]

    def rename_back(self) -> None:
        """The server states the known names again."""
        if self._server is not None:
            self._server.names = list(self._played.stream.marker_names)

    def forget_size(self) -> None:
        """Sends bytes that are not a packet, after which a connection cannot be read any more."""
        if self._server is not None:
            self._server.raw_to_all(b"\xff" * 64)

    def _serve(self, played: Played) -> None:
        self._served, self._server = played, self._kind(played, port=self._port)


def frame_number(one: Sent) -> int:
    """A frame's number as an integer that 64 bits hold; 2³¹ for one that they do not."""
    return int(one.number) if abs(one.number) < 2.0**62 else 2**31
