"""Wires that come back, or describe themselves, in another order: the same laboratory, other channels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.robustness.stream_schedule import Sent
from benchmarks.robustness.stream_wire import HERE, LslWire, NatNetWire, _Player
from mbkf.conventions import Array
from mbkf.io.records import PlateReadings
from mbkf.stream.lsl.format import plates_info
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.player import _description
from mbkf.stream.played import Played
from mbkf.stream.source import PlateSamples

MOVED_M = 0.5
"""Plates that come back elsewhere lie so far away."""

FLAGGED = 5
"""Frames in which a server states that its models changed."""


def reversed_plates(plates: tuple[PlateReadings, ...]) -> tuple[PlateReadings, ...]:
    """Plates in reverse order; as those that are named by their number, the first has the first one's name."""
    names = [plate.name for plate in plates]
    return tuple(replace(plate, name=name) for plate, name in zip(plates[::-1], names, strict=True))


class ReorderedLslWire(LslWire):
    """An LSL sender whose channels come back in another order."""

    _markers_reversed = _plates_reversed = False

    def open_reversed_plates(self) -> None:
        """Opens both streams, the plates in reverse order."""
        self._open_markers(self._played)
        self.open_plates_reversed()

    def open_plates_reversed(self) -> None:
        """Opens the stream of the plates in reverse order."""
        self._open_plates(reversed_plates(self._played.stream.plates))
        self._plates_reversed = True

    def open_plates_moved(self) -> None:
        """Opens a stream of plates of the same names that lie elsewhere."""
        by = np.array([MOVED_M, 0.0, 0.0])
        self._open_plates(
            tuple(
                replace(
                    plate,
                    origin_m=plate.origin_m + by,
                    corners_m=None if plate.corners_m is None else plate.corners_m + by,
                )
                for plate in self._played.stream.plates
            )
        )

    def open_reversed_markers(self) -> None:
        """Opens both streams, the markers in reverse order."""
        stream = self._played.stream
        turned = replace(stream, marker_names=stream.marker_names[::-1])
        self._open_markers(Played(turned, self._played.markers_m[:, ::-1], self._played.wrench))
        self.open_plates()
        self._markers_reversed = True

    def send(self, one: Sent) -> bool:
        """Sends the plates' samples and then the markers."""
        return super().send(replace(one, markers_m=one.markers_m[::-1]) if self._markers_reversed else one)

    def _open_plates(self, plates: tuple[PlateReadings, ...]) -> None:
        self._plate_count = len(plates)
        stream = replace(self._played.stream, plates=plates)
        self._plates = self._outlet(plates_info(self._lsl, stream, self._name))

    def _push_plates(self, samples: PlateSamples, counts: Array, load: float | None, stamp_s: float) -> None:
        if self._plates_reversed:
            samples = PlateSamples(samples.index, samples.wrench[:, ::-1])
        super()._push_plates(samples, counts, load, stamp_s)


class ReorderedNatNetWire(NatNetWire):
    """A NatNet server that describes its stream in another order while it streams."""

    _markers_reversed, _flags_left = False, 0

    def describe_reversed_markers(self) -> None:
        """From now on markers are described and sent in reverse order."""
        self._describe(self._played.stream.marker_names[::-1], self._played.stream.plates)
        self._markers_reversed = True

    def describe_reversed_plates(self) -> None:
        """From now on plates are described and sent in reverse order."""
        player = self._describe(self._played.stream.marker_names, reversed_plates(self._played.stream.plates))
        player._plates = player._plates[:, ::-1]

    def open_reversed_markers(self) -> None:
        """Serves again, markers in reverse order."""
        self._player = _Player(self._played, HERE, self._port)
        self.describe_reversed_markers()

    def send(self, one: Sent) -> bool:
        """Sends a frame; the first ones after a change state that models changed."""
        if self._player is None:
            return False
        turned = replace(one, markers_m=one.markers_m[::-1]) if self._markers_reversed else one
        packet = bytearray(self._player.packed(turned))
        if self._flags_left:
            packet[-6], self._flags_left = 2, self._flags_left - 1
        return self._player.to_all(bytes(packet))

    def _describe(self, names: tuple[str, ...], plates: tuple[PlateReadings, ...]) -> _Player:
        assert self._player is not None
        described = [_description(k, plate) for k, plate in enumerate(plates)]
        self._player._described = packets.descriptions(self._played.stream.trial, names, described)
        self._flags_left = FLAGGED
        return self._player
