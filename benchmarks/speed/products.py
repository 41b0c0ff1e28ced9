"""P, the unit of times: a dense 168 × 168 double product by numpy on one thread, measured between the frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import TypeVar

import numpy as np

from mbkf.conventions import Array

Result = TypeVar("Result")

SIZE = 168
WARM_UP_FRAMES = 10

_FACTOR = np.random.default_rng(0).normal(size=(SIZE, SIZE))


def product_seconds() -> float:
    """Time of one product; it also leaves the caches as another program's work would."""
    begin = perf_counter()
    np.matmul(_FACTOR, _FACTOR)
    return perf_counter() - begin


class Stopwatch:
    """Times of the parts of frames, each frame's with its own product before it."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, dict[str, float]]] = []

    def frame(self) -> None:
        """A frame begins."""
        self._rows.append((product_seconds(), {}))

    def part(self, name: str, work: Callable[..., Result], *arguments: object) -> Result:
        """Does a part of the frame's work and adds its time.

        Args:
            name: Name of the part.
            work: What is done.
            arguments: What it is given.
        """
        begin = perf_counter()
        result = work(*arguments)
        parts = self._rows[-1][1]
        parts[name] = parts.get(name, 0.0) + perf_counter() - begin
        return result

    def times(self) -> Times:
        """All frames but the first ones."""
        kept = self._rows[WARM_UP_FRAMES:]
        names = kept[0][1] if kept else {}
        return Times(
            np.array([product for product, _ in kept]),
            {name: np.array([parts.get(name, 0.0) for _, parts in kept]) for name in names},
        )


class Times:
    """Seconds per frame.

    Attributes:
        product: (T,) P.
        parts: (T,) of each part by name.
    """

    def __init__(self, product: Array, parts: Mapping[str, Array]) -> None:
        self.product, self.parts = product, parts

    def in_products(self, *names: str, percentile: float = 50.0) -> float:
        """Percentile over frames of the named parts' sum, as a multiple of the median P."""
        frame = np.sum([self.parts[name] for name in names], axis=0)
        return float(np.percentile(frame, percentile) / np.median(self.product))


def joined(times: Sequence[Times]) -> Times:
    """Several rounds as one."""
    return Times(
        np.concatenate([one.product for one in times]),
        {name: np.concatenate([one.parts[name] for one in times]) for name in times[0].parts},
    )
