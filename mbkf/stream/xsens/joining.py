"""Samples of one person and type, joined from the datagrams that MVN splits them into."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.stream.xsens.packets import MvnDatagram, read_items

MOST_WAITING = 4
"""Samples that wait for their other parts, at most; the oldest is given up."""


@dataclass(frozen=True)
class MvnSample:
    """A whole sample.

    Attributes:
        number: MVN's count.
        time_ms: MVN's clock.
        arrival_s: Arrival of its last part.
        ids: (n,) segments.
        values: (n, w) numbers of :func:`mbkf.stream.xsens.packets.read_items`.
    """

    number: int
    time_ms: int
    arrival_s: float
    ids: NDArray[np.int64]
    values: Array


@dataclass
class _Waiting:
    parts: dict[int, tuple[NDArray[np.int64], Array]] = field(default_factory=dict)
    count: int | None = None


class SampleJoiner:
    """Joins datagrams.

    Attributes:
        given_up: Samples of which a part never came.
    """

    def __init__(self) -> None:
        self.given_up = 0
        self._waiting: dict[int, _Waiting] = {}

    def put(self, one: MvnDatagram, arrival_s: float) -> MvnSample | None:
        """Takes a datagram; returns the sample that it completes.

        Raises:
            InvalidPacket: Its items do not fill it.
        """
        ids, values = read_items(one)
        waiting = self._waiting.setdefault(one.sample, _Waiting())
        if waiting.parts and values.shape[1] != next(iter(waiting.parts.values()))[1].shape[1]:
            waiting.parts.clear()  # of another layout
        waiting.parts[one.part] = ids, values
        if one.last:
            waiting.count = one.part + 1
        if waiting.count is None or any(part not in waiting.parts for part in range(waiting.count)):
            if len(self._waiting) > MOST_WAITING:
                self._waiting.pop(next(iter(self._waiting)))
                self.given_up += 1
            return None
        del self._waiting[one.sample]
        parts = [waiting.parts[part] for part in range(waiting.count)]
        return MvnSample(
            one.sample,
            one.time_ms,
            arrival_s,
            np.concatenate([ids for ids, _ in parts]),
            np.concatenate([values for _, values in parts]),
        )
