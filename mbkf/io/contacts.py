"""Stretches in which a part of the body bears load: from when to when, how much, and how its force is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from mbkf.conventions import Array, BoolArray

FEET = ("right_foot", "left_foot")
"""The feet's names among the parts that bear load, in the order of every paired array."""

INSTANT_S = 0.05
"""Shorter contacts, gaps between contacts and changes of their source join their neighbours."""


class Source(IntEnum):
    """Origin of the force on a part of the body.

    Attributes:
        NONE: No load.
        MEASURED: Read by a plate of its own.
        SHARED: One plate under both feet reads their sum; the share follows from their places.
        ESTIMATED: Without a plate; follows from the motion of the whole body.
    """

    NONE = 0
    MEASURED = 1
    SHARED = 2
    ESTIMATED = 3


@dataclass(frozen=True)
class ContactInterval:
    """A stretch of time in which a part of the body bore load.

    Attributes:
        part: The part, e.g. "right_foot", "pelvis", "left_hand".
        from_s, to_s: Times of its first and its last frame.
        peak_n: Largest size of its force, N.
        sd_n: Mean standard deviation of the force along itself, N; NaN where not known.
        how: How its force is known: "measured", "shared" or "estimated" (:class:`Source`).
    """

    part: str
    from_s: float
    to_s: float
    peak_n: float
    sd_n: float
    how: str

    @property
    def measured(self) -> bool:
        """True for a part with a plate of its own."""
        return self.how == Source.MEASURED.name.lower()


@dataclass(frozen=True)
class Loads:
    """The loads on the parts of a body.

    Attributes:
        names: (P,) the parts, the feet first.
        source: (T, P) :class:`Source` of each load.
        wrench: (T, P, 6) force N and moment N m about the world's origin.
        wrench_sd: (T, P, 6) standard deviations, NaN where not known.
        point_m: (T, P, 3) point of application, NaN without a load.
    """

    names: tuple[str, ...]
    source: Array
    wrench: Array
    wrench_sd: Array
    point_m: Array

    def intervals(
        self, times_s: Array, rate_hz: float, inner: slice | None = None
    ) -> tuple[ContactInterval, ...]:
        """The stretches in which the parts bear load, in order of time; split where the source changes.

        Args:
            times_s: (T,) times of the frames.
            rate_hz: Frame rate.
            inner: Frames to which stretches are cut; None: all.
        """
        within = inner or slice(0, len(times_s))
        found = [one for k in range(len(self.names)) for one in self._of_part(k, times_s, rate_hz, within)]
        return tuple(sorted(found, key=lambda one: one.from_s))

    def _of_part(self, k: int, times_s: Array, rate_hz: float, within: slice) -> Iterator[ContactInterval]:
        force, sd = self.wrench[:, k, :3], self.wrench_sd[:, k, :3]
        size = np.nan_to_num(np.linalg.norm(force, axis=1))
        direction = force / np.where(size > 0.0, size, np.nan)[:, None]
        along = np.sqrt(((direction * sd) ** 2).sum(axis=1))
        for kind, whole in _stretches(self.source[:, k], INSTANT_S * rate_hz):
            frames = slice(max(whole.start, within.start), min(whole.stop, within.stop))
            if kind != Source.NONE and frames.stop > frames.start:
                known = along[frames][np.isfinite(along[frames])]
                yield ContactInterval(
                    self.names[k],
                    float(times_s[frames.start]),
                    float(times_s[frames.stop - 1]),
                    float(size[frames].max()),
                    float(known.mean()) if len(known) else float("nan"),
                    Source(kind).name.lower(),
                )


def foot_sources(contact: Array | None, foot_wrench: Array) -> Array:
    """(T, 2) :class:`Source` of the forces on the feet, by their support.

    Args:
        contact: (T, 2) -1 something without a reading, 0 air, 1 a plate of its own, 2 one that both share; None where
            the reactions are those that plates measured.
        foot_wrench: (T, 2, 6) the feet's wrenches.
    """
    if contact is None:
        return np.where(bearing(foot_wrench), Source.MEASURED, Source.NONE)
    return np.where(contact < 0, Source.ESTIMATED, contact)


def bearing(wrench: Array) -> BoolArray:
    """(T, B) true for parts that bear load: their wrench (T, B, 6) is known and not zero."""
    return np.asarray(np.nan_to_num(wrench).any(axis=2))


def _stretches(kinds: Array, least: float) -> Iterator[tuple[int, slice]]:
    """Runs of equal kinds (T,), in order; those of fewer frames than ``least`` join a neighbour (:func:`_joined`)."""
    starts = np.flatnonzero(np.diff(kinds, prepend=-1)) if len(kinds) else np.zeros(0, dtype=int)
    lengths = np.diff(starts, append=len(kinds))
    runs = [(int(kinds[start]), int(length)) for start, length in zip(starts, lengths, strict=True)]
    for short in range(
        1, int(np.ceil(least))
    ):  # the shortest first, so that flicker does not consume long contacts
        runs = _joined(runs, short)
    first = 0
    for kind, length in runs:
        yield kind, slice(first, first + length)
        first += length


def _joined(runs: Sequence[tuple[int, int]], short: int) -> list[tuple[int, int]]:
    """Runs (kind, length) of which short ones have joined the longer neighbour; a contact prefers a contact."""
    found: list[tuple[int, int]] = []
    for k, (own, frames) in enumerate(runs):
        kind = own
        if frames <= short and len(runs) > 1:
            beside = [*found[-1:], *runs[k + 1 : k + 2]]
            touches = own != Source.NONE
            kind, _ = max(beside, key=lambda run: (touches and run[0] != Source.NONE, run[1]))
        before = found.pop()[1] if found and found[-1][0] == kind else 0
        found.append((kind, before + frames))
    return found
