"""Frames from Nexus, Tracker, Shogun or Evoke over Vicon's DataStream: connection, its renewal, objects that change."""

from __future__ import annotations

import time

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidPacket, MbkfError
from mbkf.io.axes import rotation_to_world
from mbkf.stream.known import KnownStream
from mbkf.stream.packet_connection import ANSWER_S
from mbkf.stream.reconnecting import ReconnectingSource
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription
from mbkf.stream.vicon import objects
from mbkf.stream.vicon.client import Packet, ViconClient
from mbkf.stream.vicon.description import ViconDescription, describe
from mbkf.stream.vicon.plates import PlateForceReader

FRAMES_FIRST = 2
"""A stream is described by the objects of so many frames: plates show their samples then."""

NO_POINTS = read_only(np.zeros((0, 3)))


class ViconSource(ReconnectingSource[ViconClient, Packet]):
    """A :class:`mbkf.stream.source.FrameSource`."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        up: str | None = None,
        person: str | None = None,
        pull: bool = False,
        answer_s: float = ANSWER_S,
    ) -> None:
        """A source that is not connected yet.

        Args:
            host: Computer of Vicon's program.
            port: Its port.
            up: Axis that points up; None for the one that is stated.
            person: Subject to follow; None for all of them.
            pull: Whether each frame is asked for.
            answer_s: Longest wait for the answer to a connection.

        Raises:
            UnknownName: The axis does not exist.
        """
        super().__init__("Vicon")
        rotation_to_world(up or "z")
        self._place, self._answer_s, self._pull = (host, port), answer_s, pull
        self._up, self._person = up, person
        self._objects: dict[int, list[bytes]] = {}
        self._forces: dict[int, int] = {}
        self._described: ViconDescription | None = None
        self._plates: PlateForceReader | None = None
        self._before: SourceFrame | None = None
        self._frames = 0

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The stream, once two single frames have described it.

        Raises:
            InvalidInput: Another server answers, or the stream cannot be used.
            UnknownName: There is no such subject.
        """
        until = time.perf_counter() + timeout_s
        while True:
            found = self._take(max(0.0, until - time.perf_counter()))
            if found is not None:
                self._keep(found)
                described = self._describable()
                if described is not None:
                    self._begin(described)
                    self._frame(found)  # the person may stand on a plate, which decides its convention
                    self._before = None
                    return described.stream
            if time.perf_counter() >= until:
                return None

    def _describable(self) -> ViconDescription | None:
        if self._frames < FRAMES_FIRST:
            return None
        try:
            return describe(self._objects, self._forces, self._up, self._person)
        except (InvalidPacket, ArithmeticError, ValueError) as error:
            self._report("packets", f"objects that cannot be read are left out ({error})")
            return None

    def _begin(self, described: ViconDescription) -> None:
        self._described, self._known = described, KnownStream(described.stream)
        self._plates = PlateForceReader(described.plates)
        self._news += [("plates", sentence) for sentence in described.left_out]

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame with the samples of the plates in it."""
        assert self._known is not None, "connect first"
        until = time.perf_counter() + timeout_s
        if not self.receiving:
            self.receiving = True
            self._heard_s = time.perf_counter()
            if self._client is not None:
                self._resume(self._client)
        while True:
            left = until - time.perf_counter()
            found = self._take(max(0.0, left))
            frame = None if found is None else self._frame(found)
            if frame is not None:
                return frame
            if left <= 0.0:
                return None

    def _open(self) -> ViconClient:
        return ViconClient(*self._place, self._answer_s)

    def _resume(self, client: ViconClient) -> None:
        """Asks for all frames; where each one is asked for, that happens when it is waited for."""
        if self._pull or not self.receiving:
            return
        try:
            client.stream()
        except OSError as error:
            self._lose(str(error))

    def _next(self, client: ViconClient, timeout_s: float) -> Packet | None:
        if (self._pull or not self.receiving) and not client.asked:
            client.ask()
        return super()._next(client, timeout_s)

    def _keep(self, one: Packet) -> bool:
        """Keeps the objects that describe the stream; true where one of them is new."""
        found = {kind: one.blocks[kind] for kind in objects.STATIC if kind in one.blocks}
        changed = {kind: data for kind, data in found.items() if self._objects.get(kind) != data}
        self._objects |= changed
        self._frames += objects.FRAME_INFO in one.blocks
        if self._described is not None and not changed:
            return False
        try:
            for data in one.blocks.get(objects.FORCE, ()):
                samples = objects.read_samples(data)
                count = self._forces.get(samples.device, 0)
                self._forces[samples.device] = max(count, len(samples.values))
        except InvalidPacket:
            pass  # reported with its frame
        return bool(changed)

    def _frame(self, one: Packet) -> SourceFrame | None:
        """The frame of a packet; None where it holds none, or none that can be read."""
        assert self._known is not None
        if not one.blocks:
            self._report("packets", "packets that cannot be read are left out")
        if self._keep(one):
            self._describe_again()
        if self._known.refused or objects.FRAME_INFO not in one.blocks:
            return None
        try:
            self._before = self._read(one, objects.Fields(one.blocks[objects.FRAME_INFO][0]).integer())
        except (InvalidPacket, ValueError, ArithmeticError) as error:
            self._report("packets", f"objects that cannot be read are left out ({error})")
            return None
        return self._before

    def _read(self, one: Packet, number: int) -> SourceFrame:
        assert self._described is not None and self._known is not None and self._plates is not None
        known, blocks = self._known, one.blocks
        markers = np.full((len(self._described.stream.marker_names), 3), np.nan)
        for data in blocks.get(objects.LABELED, ()):
            ids, places = objects.read_markers(data)
            rows, columns = self._described.columns(ids.tobytes())
            markers[columns] = self._world(places)[rows]
        shown = known.in_order(markers) if known.stream.marker_names else NO_POINTS
        points = [self._world(objects.read_points(data)) for data in blocks.get(objects.UNLABELED, ())]
        before = self._before
        if before is not None and objects.LABELED not in blocks and objects.LABELED in self._unchanged(one):
            shown = before.markers_m
        stood = NO_POINTS if before is None else before.unlabelled_m
        if len(stood) and not points and objects.UNLABELED in self._unchanged(one):
            points = [stood]
        forces, moments, centres = (
            [objects.read_samples(data) for data in blocks.get(kind, ())]
            for kind in (objects.FORCE, objects.MOMENT, objects.CENTRE_OF_PRESSURE)
        )
        undecided = self._plates.convention is None
        samples = known.plate_samples(self._plates.samples(forces, moments, centres))
        if undecided and self._plates.convention is not None:
            self._news.append(("plates axes", self._plates.convention.sentence))
        bare = np.vstack(points) if len(points) > 1 else points[0] if points else NO_POINTS
        plates = samples if known.stream.plates else PlateSamples.none(0)
        return SourceFrame(number, one.arrival_s, shown, bare, plates)

    @staticmethod
    def _unchanged(one: Packet) -> set[int]:
        """Types that a packet leaves out since they have not changed."""
        stated = one.blocks.get(objects.CONTENTS, ())
        return {kind for data in stated for kind in objects.read_unchanged(data)}

    def _world(self, places_mm: Array) -> Array:
        assert self._described is not None
        return np.asarray(places_mm @ self._described.to_world)

    def _describe_again(self) -> None:
        """Takes objects that describe the stream anew."""
        assert self._known is not None and self._plates is not None
        try:
            found = describe(self._objects, self._forces, self._up, self._person)
        except (MbkfError, ArithmeticError, ValueError) as error:
            self._report("refused", f"Vicon's new description cannot be used ({error})")
            return
        if found is None:
            return
        convention = self._plates.convention
        self._described, self._plates = found, PlateForceReader(found.plates)
        self._plates.convention = convention
        self._news += self._known.describe(found.stream)
