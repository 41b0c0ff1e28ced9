"""Runs methods on the trials of many seeds, on all workers, and remembers what it has measured."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

from benchmarks.double_pendulum.trials import Method, Recipe, Scores, score
from benchmarks.dynamic.methods import WORKERS, Mapper, in_parallel
from mbkf.cli.progress import stages
from mbkf.conventions import StageCallback
from mbkf.numerics.threads import single_threaded

SEEDS_AT_ONCE = 5
"""Trials that a worker takes at a time, if there are enough for all workers."""

FEW_SEEDS = 25
"""For tables that no band depends on."""

Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Pair:
    """A method and the trials it is measured on; equal pairs are measured once."""

    recipe: Recipe
    method: Method


@dataclass(frozen=True)
class _Task:
    pair: Pair
    seeds: tuple[int, ...]


def _measured(task: _Task) -> Scores:
    recipe, method = task.pair.recipe, task.pair.method
    with single_threaded():
        trials = (recipe.trial(seed) for seed in task.seeds)
        return Scores.joined([score(trial, method.run(trial), recipe.lost_bar) for trial in trials])


class Laboratory:
    """Measures.

    Attributes:
        seeds: Trials per pair; the seeds are 0, 1, 2, …
        quick: Whether only a few seeds are run.
    """

    def __init__(self, mapper: Mapper, seeds: int, quick: bool, report: StageCallback) -> None:
        """A laboratory without measurements yet.

        Args:
            mapper: Runs a function on many items, in turn or on several processes.
            seeds: Number of random seeds.
            quick: Whether fewer seeds are used.
            report: Called with the stage, items done and items in all.
        """
        self.seeds, self.quick = seeds, quick
        self._mapper, self._report = mapper, report
        self._known: dict[tuple[Pair, int], Scores] = {}
        self._at_once = min(SEEDS_AT_ONCE, -(-seeds // WORKERS))

    def measure(self, stage: str, pairs: Sequence[Pair], seeds: int | None = None) -> list[Scores]:
        """Scores of each pair, one entry per seed.

        Args:
            stage: Name shown while it runs.
            pairs: Recipes of trials, each with a method.
            seeds: Number of seeds; None for all.
        """
        count = min(seeds or self.seeds, self.seeds)
        new = [pair for pair in dict.fromkeys(pairs) if (pair, count) not in self._known]
        for done, pair in enumerate(new):
            self._report(stage, done, len(new))
            tasks = [_Task(pair, some) for some in _in_batches(range(count), self._at_once)]
            self._known[pair, count] = Scores.joined(self._mapper(_measured, tasks))
        self._report(stage, len(new), len(new))
        return [self._known[pair, count] for pair in pairs]

    def measure_groups(
        self, stage: str, groups: Sequence[Sequence[Pair]], seeds: int | None = None
    ) -> list[list[Scores]]:
        """Scores of many groups of pairs, measured as one stage.

        Args:
            stage: Name shown while it runs.
            groups: Groups of pairs.
            seeds: Number of seeds; None for all.
        """
        found = iter(self.measure(stage, [pair for group in groups for pair in group], seeds))
        return [[next(found) for _ in group] for group in groups]

    def spread(self, stage: str, function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
        """Results of a function on many items, shared among the workers.

        Args:
            stage: Name shown while it runs.
            function: The function; has to be importable by a worker.
            items: Its arguments.
        """
        self._report(stage, 0, 1)
        found = self._mapper(function, items)
        self._report(stage, 1, 1)
        return found


def _in_batches(seeds: Iterable[int], size: int) -> list[tuple[int, ...]]:
    listed = tuple(seeds)
    return [listed[k : k + size] for k in range(0, len(listed), size)]


@contextmanager
def laboratory(seeds: int, quick: bool) -> Iterator[Laboratory]:
    """A laboratory with a worker per core, which shows its progress on stderr."""
    with in_parallel() as mapper, _told() as report:
        yield Laboratory(mapper, seeds, quick, report)


@contextmanager
def _told() -> Iterator[StageCallback]:
    """Bars on a terminal, one line per finished stage elsewhere."""
    if sys.stderr.isatty():
        with stages() as report:
            yield report
        return
    begin = perf_counter()

    def line(stage: str, done: int, total: int) -> None:
        if done == total:
            print(f"  {stage}: done after {perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)

    yield line
