"""Faults of streams, each a function that alters what is sent; the same from the same seed.

Most are of both protocols. Those of packets are of NatNet alone; those of time stamps, and of plates that count by
themselves, of LSL.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.robustness.stream_schedule import Schedule, Sent
from mbkf.stream.natnet import packets

Fault = Callable[[Schedule], None]

LSL, NATNET = "lsl", "natnet"


class Kind(NamedTuple):
    """A fault and the protocols that it is of."""

    fault: Fault
    protocols: tuple[str, ...] = (LSL, NATNET)


def _number(change: Callable[[float], float], lasting: bool = False) -> Fault:
    return lambda s: s.change(lambda one: replace(one, number=change(one.number)), lasting)


def _constant(number: float, lasting: bool = False) -> Fault:
    return lambda s: s.change(lambda one: replace(one, number=number), lasting)


def _back_to_zero(s: Schedule) -> None:
    s.change(lambda one: replace(one, number=one.number - s.begin), lasting=True)


def _at_random(s: Schedule) -> None:
    s.change(lambda one: replace(one, number=float(s.rng.integers(-(2**31), 2**31))))


def _stands_still(s: Schedule) -> None:
    s.change(lambda one: replace(one, number=float(s.begin)))


def _one_number(number: float) -> Fault:
    return lambda s: s.change_one(lambda one: replace(one, number=number))


def _stamp(change: Callable[[Sent], float], lasting: bool = False) -> Fault:
    def fault(s: Schedule) -> None:
        s.counted = False
        s.change(lambda one: replace(one, stamp_s=change(one)), lasting)

    return fault


def _markers(value: float, share: float = 1.0) -> Fault:
    def fault(s: Schedule) -> None:
        hit = s.rng.uniform(size=len(s.frames[0].markers_m)) < share
        s.change(lambda one: replace(one, markers_m=np.where(hit[:, None], value, one.markers_m)))

    return fault


def _load(value: float) -> Fault:
    return lambda s: s.change(lambda one: replace(one, load=value))


def _lost(s: Schedule) -> None:
    kept = s.rng.uniform(size=len(s.frames)) > 0.3
    s.frames = [one for one in s.frames if kept[one.frame] or not s.begin <= one.frame < s.end]


def _repeated(s: Schedule) -> None:
    s.frames[s.begin : s.end] = [
        one for one in s.frames[s.begin : s.end] for _ in range(int(s.rng.integers(2, 4)))
    ]


def _swapped(s: Schedule) -> None:
    for n in range(s.begin, s.end, 3):
        a, b = s.frames[n], s.frames[n + 1]
        s.frames[n], s.frames[n + 1] = replace(b, at_s=a.at_s), replace(a, at_s=b.at_s)


def _pause(s: Schedule) -> None:
    """Nothing for half a second; the count goes on."""
    del s.frames[s.begin : s.begin + 50]


def _late(s: Schedule) -> None:
    """What is due for a third of a second comes at once at its end."""
    at_s = s.frames[s.end].at_s
    s.change(lambda one: replace(one, at_s=at_s))


def _bursts(s: Schedule) -> None:
    """Frames come in tens."""
    s.change(lambda one: replace(one, at_s=s.dt_s * (10 * (one.frame // 10) + 9)), lasting=True)


def _faster(factor: float) -> Fault:
    def fault(s: Schedule) -> None:
        s.frames = [replace(one, at_s=one.at_s / factor) for one in s.frames]

    return fault


def _faster_uncounted(s: Schedule) -> None:
    s.counted = False
    s.frames = [replace(one, at_s=one.at_s / 3.0, stamp_s=one.stamp_s / 3.0) for one in s.frames]


def _gone_and_back(s: Schedule) -> None:
    _outage(s, "close", "open", 0.6)


def _back_with_others(s: Schedule) -> None:
    _outage(s, "close", "open_other", 0.6)


def _counts_anew(s: Schedule) -> None:
    """The stream vanishes, returns, and counts from zero."""
    _outage(s, "close", "open", 0.6)
    first = s.frames[s.begin].frame
    s.change(lambda one: replace(one, number=one.number - first, plates_ahead=-10.0 * first), lasting=True)


def _outage(s: Schedule, gone: str, back: str, seconds: float) -> None:
    s.whole = False
    s.act(s.begin, gone)
    s.delay(seconds)
    s.act(s.begin, back)


def _closed_mid_frame(s: Schedule) -> None:
    """The plates of a frame come, its markers do not, and the stream ends."""
    s.whole = False
    s.act(s.end, "half")
    s.act(s.end, "close")
    del s.frames[s.end :]


def _plates_die(s: Schedule) -> None:
    s.act(s.begin, "close_plates")
    s.change(lambda one: replace(one, plates=False), lasting=True)


def _plates_gone_and_back(s: Schedule) -> None:
    s.act(s.begin, "close_plates")
    s.act(s.end, "open_plates")
    s.change(lambda one: replace(one, plates=False))


def _plates_other(s: Schedule) -> None:
    s.act(s.begin, "close_plates")
    s.act(s.end, "open_other_plates")
    s.change(lambda one: replace(one, plates=False))


def _plates_late(s: Schedule) -> None:
    """They are kept back for a third of a second and come at once."""
    s.change(lambda one: replace(one, plates=False))
    s.frames[s.end] = replace(s.frames[s.end], plates_from=s.begin)


def _plates_ahead(value: float, lasting: bool) -> Fault:
    return lambda s: s.change(lambda one: replace(one, plates_ahead=value), lasting)


def _wild(make: Callable[[np.random.Generator], bytes], stranger: bool = False) -> Fault:
    def fault(s: Schedule) -> None:
        for n in range(s.begin, s.end):
            s.packet(n, make(s.rng), stranger)

    return fault


def _truncated(rng: np.random.Generator) -> bytes:
    whole = _foreign_frame(rng)
    return whole[: int(rng.integers(1, len(whole)))]


def _foreign_frame(rng: np.random.Generator) -> bytes:
    nothing = np.zeros((0, 3))
    number = int(rng.integers(0, 2**32))
    return packets.frame(number, 1.0, "x", rng.normal(size=(7, 3)), nothing, np.zeros((1, 10, 6)))


def _claiming(rng: np.random.Generator) -> bytes:
    """A frame whose counts are those of a million things."""
    return packets.message(packets.FRAME, struct.pack("<2I", 5, 10**6) + rng.bytes(400))


def _described_anew(rng: np.random.Generator) -> bytes:
    return packets.descriptions("other", [f"M{k}" for k in range(int(rng.integers(1, 60)))], [])


KINDS: dict[str, Kind] = {
    "count ahead by 1000": Kind(_number(lambda n: n + 1000.0, lasting=True)),
    "count of one frame 2^60": Kind(_one_number(2.0**60)),
    "count 2^60 from there on": Kind(_constant(2.0**60, lasting=True)),
    "count set back to zero": Kind(_back_to_zero),
    "count set back by 20": Kind(_number(lambda n: n - 20.0, lasting=True)),
    "count NaN": Kind(_constant(np.nan), (LSL,)),
    "count infinite": Kind(_constant(-np.inf, lasting=True), (LSL,)),
    "count negative": Kind(_number(lambda n: n - 5000.0)),
    "count at random": Kind(_at_random),
    "count stands still": Kind(_stands_still),
    "stamps back by a second": Kind(_stamp(lambda one: one.stamp_s - 1.0, lasting=True), (LSL,)),
    "stamps NaN": Kind(_stamp(lambda _: np.nan), (LSL,)),
    "stamps an hour ahead": Kind(_stamp(lambda one: one.stamp_s + 3600.0, lasting=True), (LSL,)),
    "stamps at random by 50 ms": Kind(
        _stamp(lambda one: one.stamp_s + 0.05 * np.sin(1e4 * one.stamp_s)), (LSL,)
    ),
    "frames twice or thrice": Kind(_repeated),
    "frames out of order": Kind(_swapped),
    "a third of the frames lost": Kind(_lost),
    "a pause of half a second": Kind(_pause),
    "a third of a second at once": Kind(_late),
    "frames in tens": Kind(_bursts),
    "three times as fast": Kind(_faster(3.0)),
    "three times as fast, by stamps": Kind(_faster_uncounted, (LSL,)),
    "half as fast": Kind(_faster(0.5)),
    "all markers missing": Kind(_markers(np.nan)),
    "all markers at nought": Kind(_markers(0.0)),
    "markers infinite": Kind(_markers(np.inf, 0.5)),
    "markers at 1e30": Kind(_markers(1e30, 0.5)),
    "plates missing": Kind(lambda s: s.change(lambda one: replace(one, plates=False))),
    "plates late": Kind(_plates_late, (LSL,)),
    "plates NaN": Kind(_load(np.nan)),
    "plates at 1e30": Kind(_load(1e30)),
    "plates' count ahead": Kind(_plates_ahead(1e6, lasting=True), (LSL,)),
    "plates' count 2^60": Kind(_plates_ahead(2.0**60, lasting=False), (LSL,)),
    "plates' count NaN": Kind(_plates_ahead(np.nan, lasting=False), (LSL,)),
    "plates' stream dies": Kind(_plates_die, (LSL,)),
    "plates' stream dies and returns": Kind(_plates_gone_and_back, (LSL,)),
    "plates return with other channels": Kind(_plates_other, (LSL,)),
    "stream gone and back": Kind(_gone_and_back),
    "stream counts anew": Kind(_counts_anew),
    "stream returns with other markers": Kind(_back_with_others),
    "stream ends in a frame": Kind(_closed_mid_frame),
    "packets truncated": Kind(_wild(_truncated), (NATNET,)),
    "packets of garbage": Kind(_wild(lambda rng: rng.bytes(int(rng.integers(2, 2000)))), (NATNET,)),
    "packets of one byte": Kind(_wild(lambda rng: rng.bytes(1)), (NATNET,)),
    "packets of 65 kB": Kind(
        _wild(lambda rng: struct.pack("<H", packets.FRAME) + rng.bytes(65_000)), (NATNET,)
    ),
    "packets that claim a million sets": Kind(_wild(_claiming), (NATNET,)),
    "frames of a stranger": Kind(_wild(_foreign_frame, stranger=True), (NATNET,)),
    "descriptions change": Kind(_wild(_described_anew), (NATNET,)),
}
"""All faults by name: 41 of LSL and 34 of NatNet."""
