"""Ten thousand trials from a list, each a pause instead of a reconstruction: what handing them out costs.

``main`` runs in a process of its own, which hands out: it prints its time per trial beyond the pauses, ms, and the most
memory that it had, MB.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, sleep

from benchmarks.checks import Check, Context
from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput
from mbkf.study.batch.outcome import Outcome, Status, Task, peak_memory_mb
from mbkf.study.batch.progress import Watch, ignored
from mbkf.study.batch.run import follow, plan_of
from mbkf.study.batch.tasks import ReconstructTrial
from mbkf.study.batch.workers import LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

TRIALS, QUICK_TRIALS = 10_000, 500
PAUSE_S, WORKERS = 0.010, 2
OVERHEAD_MS, MEMORY_MB = 5.0, 500.0
PERSONS = 200
KEYS = 150
"""Numbers in a trial's summary: as many as a walk's has."""

PROGRAM = """import sys; from pathlib import Path; from benchmarks.batch.many import main
main(Path(sys.argv[1]), int(sys.argv[2]))"""
"""A process of its own; workers know the tasks by this module's name, not by that of the program."""


@dataclass(frozen=True)
class Pause:
    """Instead of a reconstruction: a pause, and a summary."""

    folder: Path

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """Done."""
        del progress
        sleep(PAUSE_S)
        self.folder.mkdir(parents=True, exist_ok=True)
        summary = {f"number_{k}": k / 7.0 for k in range(KEYS)} | {
            "warnings": ["a remark of usual length"] * 5
        }
        (self.folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        return Outcome(Status.DONE)


@dataclass(frozen=True)
class Scaled:
    """Instead of scaling."""

    subject: Path

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """Done."""
        del progress
        return Outcome(Status.DONE, subject=self.subject)


class Pausing:
    """Workers that pause instead of reconstructing."""

    def __init__(self, out: Path) -> None:
        self._inner, self._out = LocalWorkers(WORKERS), out

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes, each with its task's place."""
        return self._inner.run(map(self._pausing, tasks), watch)

    def close(self) -> None:
        """Ends the workers."""
        self._inner.close()

    def _pausing(self, task: Task) -> Task:
        if isinstance(task, ReconstructTrial):
            return Pause(self._out / task.trial.place)
        return Scaled(self._out)


def many_rows(context: Context) -> list[Check]:
    """Time beyond the pauses, and memory."""
    count = QUICK_TRIALS if context.quick else TRIALS
    words = [sys.executable, "-c", PROGRAM, str(context.out / "many"), str(count)]
    found = subprocess.run(words, capture_output=True, text=True, check=False)
    if found.returncode:
        raise InvalidInput(f"the batch of {count} trials failed: {found.stderr.strip()[-300:]}")
    overhead_ms, memory_mb = map(float, found.stdout.split()[-2:])
    return [
        Check(
            f"{count} trials of {1e3 * PAUSE_S:g} ms: time of each beyond that",
            overhead_ms,
            OVERHEAD_MS,
            "<=",
            "ms",
        ),
        Check(f"{count} trials: memory of the process that hands them out", memory_mb, MEMORY_MB, "<=", "MB"),
    ]


def main(folder: Path, count: int) -> None:
    """Writes the list, hands it out and prints what that cost."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"P{k % PERSONS},walk{k}.c3d,70" for k in range(count)]
    source = folder / "list.csv"
    source.write_text("\n".join(["subject,trial,mass_kg", *lines]) + "\n", encoding="utf-8")
    workers = Pausing(folder / "out")
    try:
        next(iter(workers.run([])), None)
        begin = perf_counter()
        table = follow(plan_of(source), folder / "out", ReconstructSettings(), workers)
        seconds = perf_counter() - begin
    finally:
        workers.close()
    assert table["status"].to_pylist() == ["done"] * count
    print(1e3 * (seconds / count - PAUSE_S / WORKERS), peak_memory_mb())
