"""Frames as JSON lines over UDP, from any program that can send them."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import replace

import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import InvalidPacket, MbkfError
from mbkf.stream.datagrams import Datagram, Datagrams
from mbkf.stream.known import KnownStream
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription
from mbkf.stream.udp.messages import (
    MOST_MARKERS,
    Message,
    UdpDescription,
    described_again,
    described_fully,
    read_description,
    read_messages,
)

NAMED_FRAMES = 10
"""Markers of a stream that does not list them are those of its first frames."""

DESCRIBED_S = 2.5
"""A stream describes itself within this time from its first frame on: senders may do so once a second."""

HELD_SAMPLES = 20_000
"""Samples of the plates that wait for their frame, at most."""

NO_POINTS = read_only(np.zeros((0, 3)))


class UdpSource:
    """A :class:`mbkf.stream.source.FrameSource`.

    Attributes:
        port: The port that it listens at.
        receiving: True from the first read on; what was sent before was let go of.
    """

    patient = False

    def __init__(self, port: int, local: str) -> None:
        """Listens at a port.

        Args:
            port: The port; 0 for any free one.
            local: Address of this computer.

        Raises:
            InvalidInput: The port cannot be listened at.
        """
        self._datagrams = Datagrams("UDP", local, port)
        self.port = self._datagrams.port
        self._fields: dict[str, object] = {}
        self._names: dict[str, None] = {}
        self._first_s: float | None = None
        self._frames = 0
        self._described: UdpDescription | None = None
        self._known: KnownStream | None = None
        self.receiving = False
        self._ready: deque[SourceFrame] = deque()
        self._waiting: list[PlateSamples] = []
        self._news: list[tuple[str, str]] = []

    @property
    def sender(self) -> str | None:
        """Address of the sender; None before its first readable message."""
        return None if self._datagrams.sender is None else self._datagrams.sender[0]

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The stream, once it has described itself and its markers are known; frames flow from the first read on.

        Raises:
            MbkfError: Its description cannot be used.
        """
        until = time.perf_counter() + timeout_s
        while (one := self._datagrams.take(max(0.0, until - time.perf_counter()))) is not None:
            for message in self._messages(one):
                described_again(self._fields, message.described)
                if message.number is not None:
                    self._first_s = self._first_s or one.arrival_s
                    self._frames += 1
                    self._names |= dict.fromkeys(message.markers)
            found = self._complete(one.arrival_s)
            if found is not None:
                self._described, self._known = found, KnownStream(found.stream)
                return found.stream
            if time.perf_counter() > until:
                break
        return None

    def _complete(self, now_s: float) -> UdpDescription | None:
        waited = self._first_s is not None and now_s - self._first_s > DESCRIBED_S
        if not ("names" in self._fields or self._frames >= NAMED_FRAMES or waited):
            return None
        found = described_fully(self._fields, waited)
        if found is None or "names" in self._fields:
            return found
        names = tuple(list(self._names)[:MOST_MARKERS])
        return replace(found, stream=replace(found.stream, marker_names=names))

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame with the samples of the plates since the one before."""
        assert self._known is not None, "connect first"
        if not self.receiving:
            self._datagrams.drop_waiting()
            self.receiving = True
        until = time.perf_counter() + timeout_s
        while not self._ready:
            one = self._datagrams.take(max(0.0, until - time.perf_counter()))
            if one is None:
                return None
            for message in self._messages(one):
                try:
                    self._take(message, one.arrival_s, self._known)
                except (InvalidPacket, ValueError, TypeError, OverflowError, ArithmeticError) as error:
                    self._datagrams.refuse(error)
            if not self._ready and time.perf_counter() > until:
                return None
        return self._ready.popleft()

    def news(self) -> list[tuple[str, str]]:
        """Events of the stream since the last call."""
        news, self._news = [*self._news, *self._datagrams.news()], []
        return news

    def close(self) -> None:
        """Listens no more."""
        self._datagrams.close()

    def _messages(self, one: Datagram) -> list[Message]:
        try:
            found = read_messages(one.data)
        except (InvalidPacket, MemoryError) as error:
            self._datagrams.refuse(error)
            return []
        if any(message.described or message.number is not None for message in found):
            self._datagrams.heard(one)
        return found

    def _take(self, message: Message, arrival_s: float, known: KnownStream) -> None:
        if message.described and described_again(self._fields, message.described):
            self._describe(known)
        if known.refused or self._described is None:
            return
        if message.forces is not None:
            self._put_samples(message, self._described, known)
        if message.number is None:
            return
        turn = self._described.to_world
        markers = known.by_name(message.markers) @ turn if known.stream.marker_names else NO_POINTS
        points = NO_POINTS if message.points is None else message.points @ turn
        plates = self._samples(len(known.stream.plates))
        self._ready.append(SourceFrame(message.number, arrival_s, markers, points, plates))

    def _describe(self, known: KnownStream) -> None:
        """A stream that describes itself anew, in another unit, order, or as another one."""
        try:
            found = read_description(self._fields)
        except MbkfError as error:
            known.refused = True
            self._news.append(("refused", f"the stream is described anew and left out: {error}"))
            return
        names = found.stream.marker_names or known.stream.marker_names
        self._described = replace(found, stream=replace(found.stream, marker_names=names))
        self._news += known.describe(self._described.stream)

    def _put_samples(self, message: Message, described: UdpDescription, known: KnownStream) -> None:
        forces = message.forces
        count = len(described.stream.plates)
        if forces is None or not count or not len(forces):
            return
        if forces.shape[1] != count:
            raise InvalidPacket(f"UDP: forces of {forces.shape[1]} plates where {count} are described")
        first = message.sample
        if first is None:
            ratio = described.stream.plate_rate_hz / described.stream.rate_hz
            first = round((message.number or 0) * ratio)
        index = np.arange(first, first + len(forces), dtype=np.int64)
        self._waiting.append(known.plate_samples(PlateSamples(index, described.wrenches(forces))))
        while len(self._waiting) > 1 and sum(len(one.index) for one in self._waiting) > HELD_SAMPLES:
            self._waiting.pop(0)

    def _samples(self, plates: int) -> PlateSamples:
        waiting, self._waiting = self._waiting, []
        if not waiting:
            return PlateSamples.none(plates)
        if len(waiting) == 1:
            return waiting[0]
        return PlateSamples(
            np.concatenate([one.index for one in waiting]), np.concatenate([one.wrench for one in waiting])
        )
