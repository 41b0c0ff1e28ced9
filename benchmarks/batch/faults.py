"""Faults in a batch of 64 trials: a truncated C3D, one without markers, a killed worker, a write that fails, a stop.

The worker kills itself, and the write fails at a limit on the size of files that the system holds the worker to.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.batch.study import fresh, study
from benchmarks.checks import Check, Context
from mbkf.conventions import StageCallback
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.study.batch.outcome import Outcome, Task
from mbkf.study.batch.progress import Watch, ignored
from mbkf.study.batch.run import follow, plan_of
from mbkf.study.batch.tasks import ReconstructTrial
from mbkf.study.batch.workers import LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

PERSONS, TRIALS, QUICK = 4, 16, (2, 4)
STOPPED_AT = 0.4
"""Share of the trials after which the batch is interrupted."""

MOST_BYTES = 200_000
"""Largest file that the worker of one trial may write: a part of its motion.h5."""

SETTINGS = ReconstructSettings(filter="kinematic", smooth=False)
"""A quick filter: what is looked at are files."""

KILLED, FULL, CUT, BARE = "walk01", "walk02", "walk03", "walk04"
"""Trials of the first person, and what befalls them."""


@dataclass(frozen=True)
class Killed:
    """A task whose worker is killed."""

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """Never comes back."""
        del progress
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError("a killed process goes on")


@dataclass(frozen=True)
class Full:
    """A task whose files cannot be written to their end."""

    task: Task

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """The task's outcome."""
        import resource

        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_BYTES, before[1]))
        try:
            return self.task(progress)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)


class Befallen:
    """Workers that two of the first person's trials go wrong on."""

    def __init__(self, workers: int) -> None:
        self._inner = LocalWorkers(workers)

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes, each with its task's place."""
        return self._inner.run(map(_befallen, tasks), watch)

    def close(self) -> None:
        """Ends the workers."""
        self._inner.close()


def _befallen(task: Task) -> Task:
    if isinstance(task, ReconstructTrial) and task.trial.person.name == "P1":
        if task.trial.name == KILLED:
            return Killed()
        if task.trial.name == FULL:
            return Full(task)
    return task


def fault_rows(context: Context) -> list[Check]:
    """Results, reasons, what was done twice, and half-written folders."""
    persons, trials = QUICK if context.quick else (PERSONS, TRIALS)
    source, out = study(context.out / "faulty", persons, trials), fresh(context.out / "faulty-results")
    _damage(source / "P1")
    plan, count = plan_of(source), persons * trials
    stop = max(round(STOPPED_AT * count), 6)  # four of them fail

    def interrupt(stage: str, done: int, total: int) -> None:
        del total
        if (stage, done) == ("Trials", stop):
            raise KeyboardInterrupt

    workers = Befallen(2)
    try:
        follow(plan, out, SETTINGS, workers, interrupt)
    except KeyboardInterrupt:
        pass
    finally:
        workers.close()
    before = {path.parent: path.stat().st_mtime_ns for path in out.glob("*/*/summary.json")}
    workers = Befallen(2)
    try:
        rows = follow(plan, out, SETTINGS, workers).to_pylist()
    finally:
        workers.close()
    after = {path.parent: path.stat().st_mtime_ns for path in out.glob("*/*/summary.json")}
    failed = [row for row in rows if row["status"] == "failed"]
    partial = [path for path in out.rglob(".*")]
    whole = [
        folder for folder in after if (folder / "motion.h5").is_file() and (folder / "batch.json").is_file()
    ]
    return [
        Check(f"faults: results of {count}", len(whole), count - 4, ">="),
        Check("faults: trials with a reason", sum(bool(row["reason"]) for row in failed), 4, ">="),
        Check("faults: trials that failed", len(failed), 4, "<="),
        Check("faults: done twice", sum(after[folder] != time for folder, time in before.items()), 0, "<="),
        Check("faults: done before the interruption", len(before), 1, ">="),
        Check("faults: half-written folders", len(partial) + len(after) - len(whole), 0, "<="),
    ]


def _damage(person: Path) -> None:
    """A trial cut short, and one whose markers are never seen."""
    cut = person / f"{CUT}.c3d"
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 3])
    bare = read_capture(person / f"{BARE}.c3d")
    unseen = replace(bare.markers, positions_m=np.full(bare.markers.positions_m.shape, np.nan))
    written = person / "unseen.c3d"
    write_c3d(replace(bare, markers=unseen), written)
    written.replace(person / f"{BARE}.c3d")  # the library never writes over a file that it has read
