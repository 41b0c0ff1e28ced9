"""Thirty ways in which a stream goes wrong, each as what a camera does instead of sending the next frames.

A fault takes the frames of two thirds of a second and says, step by step, what is sent: a frame under a number, a
pause, bytes that are no frame, or the stream's end and return. Before and after it frames are sent as they should be.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.stream.natnet import packets
from mbkf.stream.played import PlayedFrame
from mbkf.stream.source import PlateSamples

FAR = 2**60


@dataclass(frozen=True)
class Send:
    """A frame under a number."""

    frame: PlayedFrame
    number: float


@dataclass(frozen=True)
class Pause:
    """Nothing is sent for so long, s."""

    seconds: float


@dataclass(frozen=True)
class Nonsense:
    """Bytes that are no frame, from the camera or a stranger."""

    packet: bytes
    foreign: bool = False


@dataclass(frozen=True)
class Restart:
    """The stream ends, and returns after a while: as it was, with other names, or not at all."""

    seconds: float
    returns: bool = True
    renamed: bool = False


Step = Send | Pause | Nonsense | Restart
Frames = Sequence[PlayedFrame]
Fault = Callable[[Frames, np.random.Generator], Iterator[Step]]

FAULTS: dict[str, Fault] = {}


def _fault(name: str) -> Callable[[Fault], Fault]:
    def known(fault: Fault) -> Fault:
        FAULTS[name] = fault
        return fault

    return known


def _numbered(count: Callable[[int, np.random.Generator], float]) -> Fault:
    """Frames whose numbers are others."""

    def fault(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
        for frame in frames:
            yield Send(frame, count(frame.number, rng))

    return fault


def _changed(change: Callable[[PlayedFrame, np.random.Generator], PlayedFrame]) -> Fault:
    """Frames whose markers or plates are others."""

    def fault(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
        for frame in frames:
            yield Send(change(frame, rng), frame.number)

    return fault


def _markers(value: float, share: float = 1.0) -> Fault:
    def change(frame: PlayedFrame, rng: np.random.Generator) -> PlayedFrame:
        some = rng.uniform(size=len(frame.markers_m)) <= share
        return replace(frame, markers_m=np.where(some[:, None], value, frame.markers_m))

    return _changed(change)


def _plates(change: Callable[[PlateSamples], PlateSamples]) -> Fault:
    return _changed(lambda frame, _: replace(frame, plates=change(frame.plates)))


def _wrench(value: float) -> Fault:
    return _plates(lambda plates: replace(plates, wrench=np.full_like(plates.wrench, value)))


FAULTS |= {
    "nothing": _numbered(lambda n, _: n),
    "count ahead": _numbered(lambda n, _: n + 5000),
    "count anew": _numbered(lambda n, _: n % 60),
    "count far": _numbered(lambda n, rng: FAR + n if rng.uniform() < 0.3 else n),
    "count always far": _numbered(lambda n, _: FAR + n),
    "count negative": _numbered(lambda n, _: -n),
    "count no number": _numbered(lambda n, rng: float("nan") if rng.uniform() < 0.3 else n),
    "count infinite": _numbered(lambda *_: float("inf")),
    "count stands": _numbered(lambda *_: 7),
    "count at random": _numbered(lambda _, rng: int(rng.integers(0, 10**9))),
    "no markers": _markers(np.nan),
    "infinite markers": _markers(np.inf, 0.5),
    "markers far away": _markers(1e30, 0.5),
    "markers at the origin": _markers(0.0),
    "markers at random": _changed(
        lambda frame, rng: replace(frame, markers_m=rng.normal(0.0, 10.0, frame.markers_m.shape))
    ),
    "no plates": _plates(lambda plates: PlateSamples.none(plates.wrench.shape[1])),
    "plates no number": _wrench(np.nan),
    "plates infinite": _wrench(np.inf),
    "plates huge": _wrench(1e9),
    "plates' count anew": _plates(lambda plates: replace(plates, index=plates.index % 600)),
    "plates' count far": _plates(lambda plates: replace(plates, index=plates.index + FAR)),
}


@_fault("frames twice")
def _twice(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    for frame in frames:
        yield Send(frame, frame.number)
        yield Send(frame, frame.number)


@_fault("frames out of order")
def _unordered(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
    for k in rng.permutation(len(frames) // 5):
        yield from (Send(frames[i], frames[i].number) for i in rng.permutation(range(5 * k, 5 * k + 5)))


@_fault("frames lost")
def _lost(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
    for frame in frames:
        yield Send(frame, frame.number) if rng.uniform() > 0.4 else Pause(0.01)


@_fault("pauses and bursts")
def _bursts(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    yield Pause(0.5)
    yield from (Send(frame, frame.number) for frame in frames)


@_fault("thrice as fast")
def _fast(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    for k, frame in enumerate(frames):
        for more in range(3):
            yield Send(frame, frames[0].number + 3 * k + more)


@_fault("a third as fast")
def _slow(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    for frame in frames[: len(frames) // 3]:
        yield Pause(0.02)
        yield Send(frame, frame.number)


@_fault("gone and back")
def _gone(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    yield Restart(0.3)
    yield from (Send(frame, frame.number) for frame in frames)


@_fault("back with other markers")
def _renamed(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    yield Restart(0.2, renamed=True)
    yield from (Send(frame, frame.number) for frame in frames)


@_fault("gone for good")
def _ended(frames: Frames, _rng: np.random.Generator) -> Iterator[Step]:
    yield from (Send(frame, frame.number) for frame in frames[:5])
    yield Restart(0.0, returns=False)


@_fault("packets of nonsense")
def _nonsense(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
    kinds = (packets.FRAME, packets.SERVER_INFO, packets.DESCRIPTIONS, packets.RESPONSE, 4711)
    for frame in frames:
        body = rng.bytes(int(rng.choice([0, 1, 3, 40, 1400, 60_000])))
        head = struct.pack("<HH", int(rng.choice(kinds)), int(rng.integers(0, 65536)))
        yield Nonsense((head + body) if rng.uniform() < 0.8 else body, foreign=bool(rng.integers(2)))
        yield Send(frame, frame.number)


@_fault("descriptions again and again")
def _described(frames: Frames, rng: np.random.Generator) -> Iterator[Step]:
    other = packets.descriptions("other", ["A", "B"], [])
    for frame in frames:
        yield Nonsense(other if rng.uniform() < 0.5 else packets.server_info("other", 1))
        yield Send(frame, frame.number)
