"""Time of a step, this tree against another one: both follow the same squat in turn, in processes of their own.

A machine's speed changes from minute to minute, so blocks of steps alternate between the trees and are compared pair by
pair; the first of a pair is now this tree, now the other.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.house.step_files import ROOT
from benchmarks.house.step_worker import FILTERS
from mbkf.errors import InvalidInput
from mbkf.trial.synth import synthesise, write_folder

WORKER = Path(__file__).with_name("step_worker.py")
STEPS, PAIRS, QUICK_PAIRS = 150, 16, 4
SECONDS = 2.0
RATIO = 1.03

Timed = Callable[[str], float]
"""Median time in s of a step of a filter, over one block of steps."""


def rows(old: Path, folder: Path, pairs: int = PAIRS) -> list[Check]:
    """Both filters' steps, this tree over the old one.

    Args:
        old: Folder of the other tree, which holds ``mbkf/``.
        folder: Where the synthetic capture is written.
        pairs: Blocks per tree and filter.

    Raises:
        InvalidInput: The other tree holds no mbkf, or cannot follow the capture.
    """
    person, recorded = synthesise("squat", seconds=SECONDS)
    write_folder(person, recorded, folder)
    with _worker(old, folder) as was, _worker(ROOT, folder) as now:
        times = alternating(was, now, FILTERS, pairs)
    checks: list[Check] = []
    for name, (before, after) in times.items():
        checks += [
            Check(f"{name} step, this tree over the old one", median_ratio(before, after), RATIO, "<="),
            information(f"of these the old tree's {name} step, median", 1e6 * float(np.median(before)), "µs"),
        ]
    return checks


def alternating(
    was: Timed, now: Timed, names: Sequence[str], pairs: int
) -> dict[str, tuple[list[float], list[float]]]:
    """Times of both trees by filter, taken in turn; one uncounted block of each warms up.

    Args:
        was: Times a block in the old tree.
        now: Times a block in this tree.
        names: Filters.
        pairs: Blocks per tree and filter.
    """
    found: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in names}
    for name in names:
        was(name), now(name)
    for pair in range(pairs):
        for name in names:
            order = ((0, was), (1, now)) if pair % 2 else ((1, now), (0, was))
            for which, timed in order:
                found[name][which].append(timed(name))
    return found


def median_ratio(before: Sequence[float], after: Sequence[float]) -> float:
    """Median over pairs of the second time over the first."""
    return float(np.median(np.divide(after, before)))


@contextmanager
def _worker(tree: Path, folder: Path) -> Iterator[Timed]:
    """A process that uses this tree's mbkf and times blocks of steps."""
    if not (tree / "mbkf" / "__init__.py").is_file():
        raise InvalidInput(f"{tree}: holds no mbkf; give the folder of a checked-out tree with --old")
    with subprocess.Popen(
        [sys.executable, "-P", str(WORKER), str(folder)],
        env=_environment(tree),
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        commands, answers = process.stdin, process.stdout
        assert commands is not None and answers is not None
        used = answers.readline().strip()
        if used != str((tree / "mbkf").resolve()):
            raise InvalidInput(f"{tree}: its filters do not follow the capture (mbkf used: '{used}')")

        def timed(name: str) -> float:
            commands.write(f"{name} {STEPS}\n")
            commands.flush()
            answer = answers.readline()
            if not answer:
                raise InvalidInput(f"{tree}: its {name} filter ended in the middle of the squat")
            return float(answer)

        yield timed


def _environment(tree: Path) -> Mapping[str, str]:
    return {**os.environ, "PYTHONPATH": str(tree.resolve()), "OMP_NUM_THREADS": "1"}
