"""Frames from OptiTrack's Motive over NatNet: the connection, and its renewal when the server falls silent."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import replace

import numpy as np

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.io.axes import rotation_to_world, up_axis
from mbkf.stream.natnet.client import LEAST_HELD, NatNetClient
from mbkf.stream.natnet.descriptions import Descriptions
from mbkf.stream.natnet.frames import Frame, read_frame
from mbkf.stream.natnet.layout import StreamLayout
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription

CONNECT_S = 2.0
"""Time in which a server that answered has to describe its stream and to send frames."""

RATE_FRAMES = 10
"""The frame rate is computed from the time stamps of so many frames."""

RECONNECT_AFTER_S = 2.0
"""After so long without a frame the connection is made anew."""

HELD_S = 2.0
"""Received frames are held for so long until they are read."""

ASK_AGAIN_S = 0.25
"""Interval of questions for the description while frames do not fit it."""

UNSURE_S = 0.5
"""After the server states that its models changed, markers and plates are not read until its new description is here,
or for so long at most."""

RESTART_S, RESTART_FRAMES = 0.25, 5
"""After so long, and so many intervals, without a frame a server whose count did not stand still may be another one,
which describes itself anew; where it did, this computer was busy."""

Arrived = tuple[float, Frame]
"""Time of arrival on the clock of ``time.perf_counter``, and the frame."""


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
        """
        self._options = (server, local, port, multicast)
        self._rotation = rotation_to_world(up_axis(up))
        self._client: NatNetClient | None = None
        self._early: deque[Arrived] = deque()
        self._layout: StreamLayout | None = None
        self._heard_s = 0.0
        self._silent = self._changed = False
        self._described: Descriptions | None = None
        self._asked_s = self._unsure_until_s = 0.0
        self._number = 0
        self._news: list[tuple[str, str]] = []

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """Requests the stream's description and waits for the first frames, which give the rate; none is lost.

        Raises:
            InvalidInput: An address is wrong, the time stamps give no rate, or plates send raw voltages.
        """
        if self._client is None:
            self._client = NatNetClient(*self._options)
        client = self._client
        if not client.answered.wait(timeout_s):
            return None
        until = time.perf_counter() + CONNECT_S
        if not client.described.wait(CONNECT_S):
            return None
        while len(self._early) < RATE_FRAMES:
            arrived = self._take(client, until - time.perf_counter())
            if arrived is None:
                return None
            self._early.append(arrived)
        assert client.descriptions is not None
        self._described = client.descriptions
        frames = [frame for _, frame in self._early]
        self._layout = StreamLayout(self._described, frames, self._rotation)
        client.most_held = _most_held(self._layout)
        self._heard_s = time.perf_counter()
        return self._layout.stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame; after a silence the connection is made anew."""
        assert self._layout is not None, "connect first"
        arrived = self._early.popleft() if self._early else self._take(self._client, timeout_s)
        if arrived is None:
            if time.perf_counter() - self._heard_s > RECONNECT_AFTER_S:
                self._again()
            return None
        arrival_s, frame = arrived
        silent_s = max(RESTART_S, RESTART_FRAMES / self._layout.stream.rate_hz)
        silent = arrival_s - self._heard_s > silent_s and frame.number != self._number + 1
        changed, self._number = frame.changed or silent, frame.number
        self._heard_s, self._silent = arrival_s, False
        self._follow_description(changed, arrival_s)
        found = self._layout.frame(frame, arrival_s)
        unsure = arrival_s < self._unsure_until_s
        if unsure or self._layout.outdated:
            self._ask_again(arrival_s)
        if unsure:
            unread = PlateSamples.none(len(self._layout.stream.plates))
            found = replace(found, markers_m=np.full_like(found.markers_m, np.nan), plates=unread)
        return found

    def _follow_description(self, changed: bool, arrival_s: float) -> None:
        """Asks for a description that has changed, and reads frames by the newest one."""
        assert self._layout is not None
        if changed and not self._changed:
            self._unsure_until_s = arrival_s + UNSURE_S
            self._ask_again(arrival_s)
        self._changed = changed
        newest = None if self._client is None else self._client.descriptions
        if newest is not None and newest is not self._described:
            self._described, self._unsure_until_s = newest, 0.0
            self._news += self._layout.describe(newest)

    def _ask_again(self, now_s: float) -> None:
        if self._client is not None and now_s - self._asked_s > ASK_AGAIN_S:
            self._asked_s = now_s
            self._client.describe_again()

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news = [] if self._client is None else self._client.news()
        if self._news:
            news, self._news = [*self._news, *news], []
        return news

    def close(self) -> None:
        """Ends the connection."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def _take(self, client: NatNetClient | None, timeout_s: float) -> Arrived | None:
        """The next frame that can be read."""
        if client is None:
            time.sleep(timeout_s)  # this computer's address is gone for the moment
            return None
        if not client.answered.is_set() and not client.answered.wait(timeout_s):
            return None
        assert client.version is not None
        until = time.perf_counter() + timeout_s
        while True:
            held = client.take(max(0.0, until - time.perf_counter()))
            if held is None:
                return None
            try:
                return held[0], read_frame(held[1], client.version)
            except (InvalidPacket, ArithmeticError, ValueError, MemoryError) as error:
                client.refuse(InvalidPacket(str(error)))
                if time.perf_counter() > until:
                    return None

    def _again(self) -> None:
        assert self._layout is not None
        if not self._silent:
            self._news.append(("connection", "the connection to the camera computer is made anew"))
        self._silent = True
        if self._client is not None:
            self._news += self._client.news()
        self.close()
        self._heard_s = time.perf_counter()
        try:
            self._client = NatNetClient(*self._options)
        except InvalidInput as error:
            self._news.append(("connection", str(error)))
            return
        self._client.most_held = _most_held(self._layout)


def _most_held(layout: StreamLayout) -> int:
    return max(LEAST_HELD, math.ceil(HELD_S * layout.stream.rate_hz))
