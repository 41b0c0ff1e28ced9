"""What a player sends, and when: frames of a capture, packets of any kind, and what becomes of the connection."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.played import Played


@dataclass(frozen=True)
class Sent:
    """A frame to send.

    Attributes:
        at_s: When, from the first frame on.
        frame: Which of the capture; its plates are sent with it.
        number: The count that it carries.
        stamp_s: Its time stamp.
        markers_m: (M, 3) markers.
        plates: Whether the plates are sent.
        plates_from: The first frame whose plates are sent; later than ``frame`` after those were kept back.
        load: What the plates read everywhere; None for what they read.
        plates_ahead: What is added to the count of the plates' samples.
    """

    at_s: float
    frame: int
    number: float
    stamp_s: float
    markers_m: Array
    plates: bool = True
    plates_from: int = -1
    load: float | None = None
    plates_ahead: float = 0.0


@dataclass(frozen=True)
class Packet:
    """Bytes to send, by the player or by a stranger."""

    at_s: float
    data: bytes
    stranger: bool = False


@dataclass(frozen=True)
class Act:
    """What becomes of the connection: a method of the player's wire, by name."""

    at_s: float
    what: str


Item = Sent | Packet | Act


class Schedule:
    """All that is sent.

    Attributes:
        frames: The frames, in the order of the capture.
        others: Packets and acts.
        rng: Random numbers of the fault.
        counted: Whether frames carry a count; without, time stamps number them (LSL only).
        whole: Whether every frame that is sent must be received.
        begin, end: First frame of the fault and the one after its last.
    """

    def __init__(self, played: Played, seed: int) -> None:
        """Args: the capture, and what the fault is drawn from."""
        rate_hz = played.stream.rate_hz
        self.frames = [
            Sent(n / rate_hz, n, float(n), n / rate_hz, markers) for n, markers in enumerate(played.markers_m)
        ]
        self.others: list[Packet | Act] = []
        self.rng = np.random.default_rng(seed)
        self.counted = self.whole = True
        self.dt_s = 1.0 / rate_hz
        self.begin = int(self.rng.integers(60, 90))
        self.end = self.begin + int(self.rng.integers(25, 45))

    def change(self, alter: Callable[[Sent], Sent], lasting: bool = False) -> None:
        """Alters the frames of the fault, or all from its begin on."""
        end = len(self.frames) if lasting else self.end
        self.frames[self.begin : end] = [alter(one) for one in self.frames[self.begin : end]]

    def change_one(self, alter: Callable[[Sent], Sent]) -> None:
        """Alters the frame with which the fault begins."""
        self.frames[self.begin] = alter(self.frames[self.begin])

    def delay(self, seconds: float) -> None:
        """Everything from the fault's begin on comes later."""
        self.change(lambda one: replace(one, at_s=one.at_s + seconds), lasting=True)

    def act(self, frame: int, what: str) -> None:
        """Something becomes of the connection just before a frame."""
        self.others.append(Act(self.frames[frame].at_s - 0.2 * self.dt_s, what))

    def packet(self, frame: int, data: bytes, stranger: bool = False) -> None:
        """A packet just before a frame.

        Args:
            frame: The frame.
            data: The packet.
            stranger: Whether another address sends it.
        """
        self.others.append(Packet(self.frames[frame].at_s - 0.2 * self.dt_s, data, stranger))

    def items(self) -> list[Item]:
        """Everything in the order of sending."""
        return sorted([*self.frames, *self.others], key=lambda one: one.at_s)
