"""How the dynamic benchmark runs a filter: one method, one capture, the same treatment for all of them.

Every method gets the capture as `mbkf reconstruct` would: plates without their offset, and marker positions
corrected on the shown frames. The correction depends on nothing a filter does, so it is made once per capture
and shared; `Method.run` then keeps those positions.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from benchmarks.checks import Check
from mbkf.errors import InvalidInput, MbkfError
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.wrench import centre_of_pressure, find_tare, remove_tare
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.correction import correct_markers
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

WORKERS = 2

SCALES = (0.02, 0.04, 0.08, 0.12, 0.18, 0.3, 0.6, 1.2, 2.4)
"""Factors on the table of typical accelerations among which FCDI finds its best."""

_UP = np.array([0.0, 0.0, 1.0])

Item = TypeVar("Item")
Result = TypeVar("Result")


class Mapper(Protocol):
    """Something that calls a function for every item and returns the results in the items' order."""

    def __call__(self, function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
        """The results in the items' order."""


def in_turn(function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """The plain mapper: one item after the other, in this process."""
    return [function(item) for item in items]


@contextmanager
def in_parallel(workers: int = WORKERS) -> Iterator[Mapper]:
    """A mapper over worker processes; functions and items must be picklable, results do not depend on it."""
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        yield lambda function, items: list(pool.map(_Sendable(function), items))


@dataclass(frozen=True)
class _Sendable:
    """A function whose errors can be sent between processes; those with evidence of their own cannot."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> Any:
        try:
            return self.function(item)
        except MbkfError as error:
            raise InvalidInput(str(error)) from None


@dataclass(frozen=True)
class Method:
    """A filter with its settings.

    Attributes:
        filter: Name of the filter.
        smooth: Whether later frames are used, too.
        scale: Factor on the kinematic filter's accelerations.
        extra: Further fields of :class:`ReconstructSettings`, for tuning.
    """

    filter: str
    smooth: bool = False
    scale: float = 1.0
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """Name in tables."""
        return f"{self.filter}, smoothed" if self.smooth else self.filter

    def settings(self, **more: Any) -> ReconstructSettings:
        """Settings of a run that keeps the subject's marker positions."""
        known = {"filter": self.filter, "smooth": self.smooth, "correct_markers": False}
        words: dict[str, Any] = {**known, **self.extra, **more}
        if self.filter == "kinematic":
            words.setdefault("kinematic", KinematicSettings(acceleration_scale=self.scale))
        return ReconstructSettings(**words)

    def run(self, capture: Capture, subject: Subject, **more: Any) -> Reconstruction:
        """Reconstructs a capture.

        Args:
            capture: Markers and plates.
            subject: The person.
            more: Further fields of :class:`ReconstructSettings`.
        """
        return reconstruct(capture, subject, settings=self.settings(**more))


def dynamic_pair(name: str = "dynamic") -> tuple[Method, Method]:
    """The causal and the smoothed method of a filter."""
    return Method(name), Method(name, smooth=True)


def corrected(subject: Subject, capture: Capture) -> Subject:
    """The subject with the marker positions `mbkf reconstruct` would correct on this capture."""
    with single_threaded():
        return correct_markers(subject, subject_markers(capture.markers, subject))


def tared(capture: Capture) -> Capture:
    """A capture made in memory as it is read from a file: plates without the offset they show unloaded."""
    return replace(capture, plates=tuple(_tared(plate) for plate in capture.plates))


def _tared(plate: PlateReadings) -> PlateReadings:
    wrench = np.hstack([plate.force_n, plate.moment_nm])
    found = find_tare(wrench, plate.rate_hz)
    wrench = remove_tare(wrench, found)
    force, moment = wrench[:, :3], wrench[:, 3:]
    pressure = centre_of_pressure(force, moment, plate.origin_m, _UP, plate.threshold_n)
    return replace(plate, force_n=force, moment_nm=moment, centre_of_pressure_m=pressure, offset=found.offset)


def best(scores: Mapping[float, float]) -> float:
    """The scale with the smallest score; a score that is no number is the worst.

    Raises:
        InvalidInput: There are no scores.
    """
    if not scores:
        raise InvalidInput("nothing was tried, so nothing is best")
    return min(scores, key=lambda scale: scores[scale] if np.isfinite(scores[scale]) else np.inf)


def best_two(scores: Mapping[float, float]) -> tuple[float, ...]:
    """The two scales with the smallest scores, or the only one."""
    first = best(scores)
    others = {scale: score for scale, score in scores.items() if scale != first}
    return (first, best(others)) if others else (first,)


def best_on_all(
    score: Callable[[Sequence[Item], float], float],
    items: Sequence[Item],
    scales: Sequence[float],
    first: int,
) -> tuple[float, float]:
    """The best scale and its score: all scales are tried on the first items, the best two on all.

    Args:
        score: Gives the score of a scale on some items; smaller is better.
        items: What to judge on.
        scales: What to try.
        first: How many items the rough search uses.
    """
    rough = {scale: score(items[:first], scale) for scale in scales}
    final = {scale: score(items, scale) for scale in best_two(rough)}
    return best(final), final[best(final)]


def pooled(values: Iterable[float]) -> float:
    """RMS over trials of RMS values, all trials with the same weight; NaN when one is no number."""
    squares = np.square(list(values))
    return float(np.sqrt(squares.mean())) if squares.size else float("nan")


def rows_or_failure(label: str, make: Callable[[], list[Check]]) -> list[Check]:
    """The rows of one method, or one failed row with the reason why it does not run."""
    try:
        return make()
    except MbkfError as error:
        return [Check(f"{label} does not run: {error}", float("nan"), 0.0, "<=")]
