"""Mutants: one wrong line at a time in a copy of the tree; the quick tests beside the changed file have to fail.

The mutants were picked by hand over all rooms, among errors that people make: a sign, a factor, a unit, an axis, a
comparison, an end of a range. Their texts stand in ``mutants.toml``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import TypeVar

from benchmarks.checks import Check, Context, information
from benchmarks.mutants.copy import Copy
from benchmarks.mutants.mutant import ROOT, Mutant, read_mutants, times_found
from mbkf.errors import InvalidInput

WORKERS = 2
EVERY = 8
"""A quick run takes one of so many mutants."""
KILLED_SHARE = 0.85

Given = TypeVar("Given")
Found = TypeVar("Found")


def run(context: Context) -> list[Check]:
    """All rows."""
    mutants = read_mutants()[:: EVERY if context.quick else 1]
    times = [times_found(mutant, ROOT) for mutant in mutants]
    there = [mutant for mutant, n in zip(mutants, times, strict=True) if n == 1]
    tests = sorted({test for mutant in there for test in mutant.tests})
    with _copies(context) as on_copies:
        failures = on_copies(Copy.failure, [tests[k::WORKERS] for k in range(WORKERS)])
        if any(failures):
            raise InvalidInput(
                f"tests fail without a mutant; mend them first: {'; '.join(filter(None, failures))}"
            )
        killed = on_copies(Copy.kills, there)
    return [*anchor_rows(mutants, times), *kill_rows(there, killed)]


@contextmanager
def _copies(
    context: Context,
) -> Iterator[Callable[[Callable[[Copy, Given], Found], Sequence[Given]], list[Found]]]:
    """A function that calls another one for each of several things, on the next copy of the tree that is free."""
    with TemporaryDirectory() as folder, ThreadPoolExecutor(WORKERS) as pool:
        free: SimpleQueue[Copy] = SimpleQueue()
        for k in range(WORKERS):
            free.put(Copy.of(ROOT, f"{folder}/{k}", context.data))

        def on_copies(do: Callable[[Copy, Given], Found], each: Sequence[Given]) -> list[Found]:
            def one(given: Given) -> Found:
                copy = free.get()
                try:
                    return do(copy, given)
                finally:
                    free.put(copy)

            return list(pool.map(one, each))

        yield on_copies


def anchor_rows(mutants: Sequence[Mutant], times: Sequence[int]) -> list[Check]:
    """Number of mutants whose text is not found exactly once, and a row for each of these.

    Args:
        mutants: The mutants.
        times: How often the text of each was found in its file.
    """
    lost = [(mutant, n) for mutant, n in zip(mutants, times, strict=True) if n != 1]
    return [
        *(information(f"times found, {mutant}", float(n)) for mutant, n in lost),
        Check("mutants whose text is not found exactly once in its file", len(lost), 0, "<="),
    ]


def kill_rows(mutants: Sequence[Mutant], killed: Sequence[bool]) -> list[Check]:
    """A row for each mutant that survived, and the share of those that the tests beside them killed.

    Args:
        mutants: The mutants.
        killed: True for each that a test has seen.
    """
    return [
        *(
            information(f"survived, {one}", 1.0)
            for one, seen in zip(mutants, killed, strict=True)
            if not seen
        ),
        information("mutants", float(len(mutants))),
        Check("mutants killed by the quick tests beside them, share", _mean(killed), KILLED_SHARE, ">="),
    ]


def _mean(flags: Sequence[bool]) -> float:
    return sum(flags) / len(flags) if flags else float("nan")
