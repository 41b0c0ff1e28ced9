"""Kinds of senders that laboratories have: jittering, pausing, counting or not, restarting, describing themselves anew.

Each alters a schedule of frames (:mod:`benchmarks.robustness.stream_schedule`), the same from the same seed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.robustness.stream_kinds import LSL, NATNET
from benchmarks.robustness.stream_schedule import Schedule
from mbkf.conventions import Array
from mbkf.stream.played import Played

FOLLOWED = 100
"""Faults begin so many frames later than those of disturbed streams: when the filter follows the person."""

Change = Callable[[Schedule], None]
OUTAGE_S = 0.4
"""A sender is gone for so long while its count stands still: less than the time within which a count is believed."""


class Kind(NamedTuple):
    """A kind of sender.

    Attributes:
        protocol: "lsl" or "natnet".
        change: Alters the schedule.
        apart: Frames by which numbers may be off where stamps or clocks tell no more.
        by_time: The sender counts anew: numbers follow from the time of sending.
        event: Kind of an event that has to be reported; "" for none.
        plates: Samples of the plates have the numbers of those sent, so that each is compared.
    """

    protocol: str
    change: Change
    apart: int = 0
    by_time: bool = False
    event: str = ""
    plates: bool = False


def uncounted(*changes: Change) -> Change:
    """A sender without frame numbers."""

    def change(s: Schedule) -> None:
        s.counted = False
        for one in changes:
            one(s)

    return change


def sent_late(most_s: float) -> Change:
    """Every frame is sent late by up to so much, not before the one in front of it, and stamped when it is sent."""
    return lambda s: _send_at(s, _due(s) + s.rng.uniform(0.0, most_s, len(s.frames)))


def single_late(late_s: float, share: float) -> Change:
    """Single frames are sent late, and those behind them at once after."""
    return lambda s: _send_at(s, _due(s) + late_s * (s.rng.uniform(size=len(s.frames)) < share))


def _due(s: Schedule) -> Array:
    return np.array([one.at_s for one in s.frames])


def _send_at(s: Schedule, at_s: Array) -> None:
    in_order = np.maximum.accumulate(at_s) + 1e-5 * np.arange(len(at_s))
    s.frames = [
        replace(one, at_s=float(at), stamp_s=float(at)) for one, at in zip(s.frames, in_order, strict=True)
    ]


def in_tens(s: Schedule) -> None:
    """Ten frames are sent at once, stamped when they are sent."""
    tens = np.arange(len(s.frames), dtype=float) // 10.0
    _send_at(s, s.dt_s * (10.0 * tens + 9.0))


def pause_caught_up(s: Schedule) -> None:
    """The sender stands still for a third of a second and catches up."""
    at_s = _due(s)
    at_s[s.begin : s.begin + 33] = at_s[s.begin + 33]
    _send_at(s, at_s)


def _stamped(s: Schedule, stamp_s: Array) -> None:
    """Time stamps are altered, the sending is not."""
    s.frames = [replace(one, stamp_s=float(stamp)) for one, stamp in zip(s.frames, stamp_s, strict=True)]


def coarse_clock(s: Schedule) -> None:
    """Stamps of a clock that goes on every 15.6 ms, as that of Windows does."""
    _stamped(s, np.floor(_due(s) / 0.0156) * 0.0156)


def fast_clock(s: Schedule) -> None:
    """Stamps of a clock that is fast by 0.1 %."""
    _stamped(s, 1.001 * _due(s))


def clock_jumps(by_s: float) -> Change:
    """From the fault's begin on stamps are those of another clock."""
    return lambda s: _stamped(s, _due(s) + by_s * (np.arange(len(s.frames)) >= s.begin))


def stamps_missing(s: Schedule) -> None:
    """During the fault stamps are not numbers."""
    frames = np.arange(len(s.frames))
    _stamped(s, np.where((frames >= s.begin) & (frames < s.end), np.nan, _due(s)))


def left_out(count: int) -> Change:
    """So many frames in a row are never sent."""

    def change(s: Schedule) -> None:
        del s.frames[s.begin : s.begin + count]

    return change


def third_left_out(s: Schedule) -> None:
    """A third of the frames, at random."""
    kept = s.rng.uniform(size=len(s.frames)) > 0.33
    kept[0] = kept[-1] = True
    s.frames = [one for one, keep in zip(s.frames, kept, strict=True) if keep]


def twice(s: Schedule) -> None:
    """Every frame of the fault is sent twice."""
    s.frames[s.begin : s.end] = [one for one in s.frames[s.begin : s.end] for _ in range(2)]


def out_of_order(s: Schedule) -> None:
    """Every third frame comes after its successor."""
    for n in range(s.begin, s.end, 3):
        a, b = s.frames[n], s.frames[n + 1]
        s.frames[n], s.frames[n + 1] = replace(b, at_s=a.at_s), replace(a, at_s=b.at_s)


def back_as(act: str, plates_only: bool = False) -> Change:
    """The stream, or that of the plates alone, ends and comes back after a while by an act of the wire."""

    def change(s: Schedule) -> None:
        if plates_only:
            s.act(s.begin, "close_plates")
            s.act(s.end, act)
            s.change(lambda one: replace(one, plates=False))
            return
        s.whole = False
        s.act(s.begin, "close")
        s.delay(OUTAGE_S)
        s.act(s.begin, act)

    return change


def counts_anew(s: Schedule) -> None:
    """The stream comes back after a while and counts from zero."""
    back_as("open")(s)
    first = s.frames[s.begin].frame
    s.change(lambda one: replace(one, number=one.number - first, plates_ahead=-10.0 * first), lasting=True)


def described_as(act: str) -> Change:
    """The server describes its stream anew, by an act of the wire, while frames come."""

    def change(s: Schedule) -> None:
        s.act(s.begin, act)

    return change


KINDS: dict[str, Kind] = {
    "no count": Kind(LSL, uncounted()),
    "no count, sent up to 5 ms late": Kind(LSL, uncounted(sent_late(0.005))),
    "no count, sent up to 20 ms late": Kind(LSL, uncounted(sent_late(0.02))),
    "no count, sent up to 50 ms late": Kind(LSL, uncounted(sent_late(0.05))),
    "no count, clock of 15.6 ms": Kind(LSL, uncounted(coarse_clock)),
    "no count, frames in tens": Kind(LSL, uncounted(in_tens)),
    "no count, pause and catch up": Kind(LSL, uncounted(pause_caught_up)),
    "no count, single frames 0.1 s late": Kind(LSL, uncounted(single_late(0.1, 0.02))),
    "no count, one frame left out": Kind(LSL, uncounted(left_out(1))),
    "no count, half a second left out": Kind(LSL, uncounted(left_out(50)), event="lost"),
    "no count, a third left out": Kind(LSL, uncounted(third_left_out), event="lost"),
    "no count, half a second left out beside 20 ms of jitter": Kind(
        LSL, uncounted(left_out(50), sent_late(0.02)), apart=4, event="lost"
    ),
    "no count, stamps an hour ahead": Kind(LSL, uncounted(clock_jumps(3600.0)), event="clock"),
    "no count, stamps back by a second": Kind(LSL, uncounted(clock_jumps(-1.0)), event="clock"),
    "no count, stamps missing": Kind(LSL, uncounted(stamps_missing)),
    "no count, clock fast by 0.1 %": Kind(LSL, uncounted(fast_clock)),
    "no count, frames twice": Kind(LSL, uncounted(twice), event="late"),
    "count, sent up to 50 ms late": Kind(LSL, sent_late(0.05), plates=True),
    "gone and back": Kind(LSL, back_as("open"), event="markers back", plates=True),
    "back with reversed plates": Kind(LSL, back_as("open_reversed_plates"), event="plates back", plates=True),
    "back with reversed markers": Kind(
        LSL, back_as("open_reversed_markers"), event="markers back", plates=True
    ),
    "plates back in reverse": Kind(
        LSL, back_as("open_plates_reversed", plates_only=True), event="plates back", plates=True
    ),
    "plates back elsewhere": Kind(
        LSL, back_as("open_plates_moved", plates_only=True), event="plates refused", plates=True
    ),
    "back, counting anew": Kind(LSL, counts_anew, apart=8, by_time=True, event="clock"),
    "NatNet, sent up to 50 ms late": Kind(NATNET, sent_late(0.05), plates=True),
    "NatNet, out of order": Kind(NATNET, out_of_order, event="late"),
    "NatNet, a third left out": Kind(NATNET, third_left_out, event="lost"),
    "NatNet, markers described in reverse": Kind(
        NATNET, described_as("describe_reversed_markers"), plates=True
    ),
    "NatNet, plates described in reverse": Kind(
        NATNET, described_as("describe_reversed_plates"), plates=True
    ),
    "NatNet, back with reversed markers": Kind(NATNET, back_as("open_reversed_markers"), event="lost"),
}


def scheduled(name: str, played: Played, seed: int) -> Schedule:
    """What a sender of a kind sends, and when.

    Args:
        name: The kind.
        played: The capture.
        seed: Which of its kind.
    """
    schedule = Schedule(played, seed)
    schedule.begin += FOLLOWED
    schedule.end += FOLLOWED
    KINDS[name].change(schedule)
    return schedule
