"""When the feet strike the floor and leave it: from their loads where these are known, else from how they move.

From loads: a foot stands while its vertical force exceeds a threshold. From motion (Zeni, Richards & Higginson, Gait
Posture 27, 2008, 710-714; on floors and treadmills alike): it strikes when its heel is furthest in front of the pelvis
and leaves when its toes are furthest behind. Events that a person set stand instead of both.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.io.session import SIDES, EventKind, FootEvent
from mbkf.model.human import HumanModel
from mbkf.sensors.contact.soles import sole_points

LOADED_N = 20.0
"""Vertical force from which a foot stands."""

SHORTEST_S = 0.08
"""Shorter contacts and shorter gaps between contacts are noise."""

LEAST_SWING_M = 0.15
"""A foot that moves less than this forwards and backwards under the pelvis does not walk."""

SAME_S = 0.15
"""An event of the load and one of the motion nearer to each other than this are the same event."""

HEEL, TOES = 0, 2
"""Points of a sole."""


@dataclass(frozen=True)
class FootEvents:
    """Events of one foot in s, in order: ``strikes_s`` (n,) and ``offs_s`` (m,)."""

    strikes_s: Array
    offs_s: Array


@dataclass(frozen=True)
class FeetInMotion:
    """Where the feet are, for events and for step lengths.

    Attributes:
        times_s: (T,) times.
        soles_m: (T, 2, 3, 3) world positions of heel, ball and toe end of right and left sole; NaN untracked.
        forward: (T, 2) horizontal unit vector in which the pelvis faces.
        pelvis_m: (T, 2) horizontal position of the pelvis.
    """

    times_s: Array
    soles_m: Array
    forward: Array
    pelvis_m: Array


def feet_in_motion(r: Reconstruction) -> FeetInMotion:
    """Feet and pelvis of a reconstruction."""
    model = HumanModel.of(r.subject)
    q = np.where(r.tracked[:, None], r.q, np.nan)
    root = model.root.q
    x, y, z, w = q[:, root.start + 3 : root.start + 7].T
    facing = np.column_stack([1.0 - 2.0 * (y**2 + z**2), 2.0 * (x * y + z * w)])
    forward = facing / np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    return FeetInMotion(r.times_s, sole_points(model, q), forward, q[:, root.start : root.start + 2])


def foot_events(r: Reconstruction, feet: FeetInMotion | None = None) -> tuple[FootEvents, FootEvents]:
    """Events of the right and the left foot of a reconstruction.

    A filter that estimates reactions knows the load of either foot in every frame. Where reactions are only those of
    plates, a foot beside the plates is unloaded in name only, so motion adds the events that loads do not show.
    """
    feet = feet or feet_in_motion(r)
    found = []
    for foot in range(2):
        vertical = np.where(r.tracked, r.foot_wrench[:, foot, 2], np.nan)
        by_load = events_of_load(r.times_s, vertical)
        if r.foot_contact is None:
            by_motion = events_of_motion(feet, foot)
            by_load = FootEvents(
                _with_missing(by_load.strikes_s, by_motion.strikes_s),
                _with_missing(by_load.offs_s, by_motion.offs_s),
            )
        found.append(by_load)
    return found[0], found[1]


def events_by_hand(events: Iterable[FootEvent], times_s: Array) -> tuple[FootEvents, FootEvents]:
    """Events of the right and the left foot that a person set: in order, each once, those outside the trial left out.

    Args:
        events: Of both feet, in any order.
        times_s: (T,) times of the frames, s.
    """
    within = [event for event in events if times_s[0] <= event.time_s <= times_s[-1]]

    def times(side: str, kind: EventKind) -> Array:
        return np.unique([event.time_s for event in within if (event.side, event.kind) == (side, kind)])

    right, left = (FootEvents(times(side, EventKind.STRIKE), times(side, EventKind.OFF)) for side in SIDES)
    return right, left


def plain_found(events: tuple[FootEvents, FootEvents]) -> tuple[FootEvent, ...]:
    """The same events in one list in order of time, as events set by a person are stored.

    Args:
        events: Of the right and the left foot.
    """
    found = [
        FootEvent(side, kind, float(time_s))
        for side, foot in zip(SIDES, events, strict=True)
        for kind, times in ((EventKind.STRIKE, foot.strikes_s), (EventKind.OFF, foot.offs_s))
        for time_s in times
    ]
    return tuple(sorted(found, key=lambda event: event.time_s))


def events_of_load(times_s: Array, vertical_n: Array, threshold_n: float = LOADED_N) -> FootEvents:
    """Events of a foot from its vertical force (T,), at the crossings of the threshold between frames.

    A contact that begins or ends where the force is NaN, or at the ends of the trial, has no such event.

    Args:
        times_s: (T,) times of the frames, s.
        vertical_n: (T,) vertical force on the foot, N; NaN where not known.
        threshold_n: A foot stands while the force exceeds this, N.
    """
    known = ~np.isnan(vertical_n)
    stands = np.nan_to_num(vertical_n) > threshold_n
    if len(times_s) > 1:
        stands = _without_blinks(stands, round(SHORTEST_S / float(np.median(np.diff(times_s)))))
    before = np.flatnonzero(known[:-1] & known[1:] & (stands[:-1] != stands[1:]))
    low, high = vertical_n[before], vertical_n[before + 1]
    share = np.clip((threshold_n - low) / np.where(high == low, 1.0, high - low), 0.0, 1.0)
    at = times_s[before] + share * (times_s[before + 1] - times_s[before])
    rises = stands[before + 1]
    return FootEvents(at[rises], at[~rises])


def events_of_motion(feet: FeetInMotion, foot: int) -> FootEvents:
    """Events of a foot (0 right, 1 left) from its motion against the pelvis."""
    ahead = [
        ((feet.soles_m[:, foot, point, :2] - feet.pelvis_m) * feet.forward).sum(axis=1)
        for point in (HEEL, TOES)
    ]
    strikes = _peaks(feet.times_s, ahead[0])
    offs = _peaks(feet.times_s, -ahead[1])
    return FootEvents(strikes, offs)


def _peaks(times_s: Array, signal: Array) -> Array:
    """Times of prominent maxima, refined by a parabola through three frames."""
    from scipy.signal import find_peaks

    known = ~np.isnan(signal)
    if known.sum() < 3:
        return np.empty(0)
    filled = np.interp(times_s, times_s[known], signal[known])
    prominence = max(LEAST_SWING_M, 0.3 * float(np.ptp(filled)))
    peaks, _ = find_peaks(filled, prominence=prominence)
    peaks = peaks[known[peaks]]
    left, middle, right = filled[peaks - 1], filled[peaks], filled[peaks + 1]
    bend = left - 2.0 * middle + right
    shift = np.where(bend < 0, 0.5 * (left - right) / np.where(bend == 0, 1.0, bend), 0.0)
    return np.asarray(times_s[peaks] + shift * float(np.median(np.diff(times_s))))


def _with_missing(by_load: Array, by_motion: Array) -> Array:
    """Times of one list and those of another that are near none of the first."""
    away = [t for t in by_motion if not (np.abs(by_load - t) < SAME_S).any()]
    return np.sort(np.concatenate([by_load, np.array(away, dtype=float)]))


def _without_blinks(flags: BoolArray, shortest: int) -> BoolArray:
    """Flags without runs shorter than a number of frames inside the trial; gaps are closed first."""
    flags = flags.copy()
    for value in (False, True):
        edges = np.flatnonzero(np.diff(np.concatenate([[not value], flags, [not value]]) == value))
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            if last - first < shortest and first > 0 and last < len(flags):
                flags[first:last] = not value
    return flags
