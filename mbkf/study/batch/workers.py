"""Tasks on the processes of one computer; a process that dies or stands still costs at most the task that it had.

Such a task is done once more after all others, alone, in a new process: two that need much memory may fit one after the
other. Where it ends its worker again, it is reported so. When a run is given up, its processes are killed at once;
results appear as one, so at most an unfinished folder stays, which :mod:`mbkf.io.leftovers` sweeps.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Protocol

from mbkf.study.batch.outcome import Outcome, Status, Task
from mbkf.study.batch.progress import Progress, Watch
from mbkf.study.batch.worker_process import Gone, WorkerProcess

TICK_S = 0.25
"""Longest time between two looks at the workers."""

STILL_S = 20.0
"""A worker without a sign of life for so long is replaced; it gives one each second."""

START_S = 60.0
"""The same for a worker that has just been started, and loads its libraries."""

MOST_MB = 1000.0
"""A worker whose memory has grown beyond this is replaced after its task, so that the system gets it back."""

STOOD_STILL = "the worker gave no sign of life for {:.0f} s while it did this (was it stopped?)"


class Executor(Protocol):
    """Does tasks somewhere."""

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come, each with its task's place in the order given.

        Args:
            tasks: They; asked for as they are needed.
            watch: Called with the progress of those under way; an error that it raises ends the run.
        """

    def close(self) -> None:
        """Lets go of the workers; tasks under way are given up."""


@dataclass
class _Job:
    """A task under way, and how long its worker has been silent, s."""

    number: int
    task: Task
    progress: Progress = field(default_factory=Progress)
    silent_s: float = 0.0


@dataclass(frozen=True)
class _Lost:
    """A task whose worker has gone, and the reason."""

    task: Task
    reason: str


class LocalWorkers:
    """Processes of this computer, one thread each; started as tasks come."""

    def __init__(self, workers: int) -> None:
        """Args: how many processes."""
        self._workers = workers
        self._inbox = SimpleQueue[tuple[WorkerProcess, object]]()
        self._idle: list[WorkerProcess] = []
        self._living: set[WorkerProcess] = set()

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come, each with its task's place in the order given."""
        waiting, again = enumerate(tasks), dict[int, Task]()
        busy, alone = dict[WorkerProcess, _Job](), set[int]()
        try:
            while self._hand_out(waiting, again, alone, busy):
                for number, outcome in self._heard(busy):
                    if isinstance(outcome, Outcome):
                        yield number, outcome
                    elif number in alone:
                        yield number, Outcome(Status.FAILED, outcome.reason)
                    else:
                        again[number] = outcome.task
                if watch is not None:
                    watch({job.number: job.progress for job in busy.values()})
        finally:
            for worker in tuple(busy):
                self._given_up(worker, busy)

    def close(self) -> None:
        """Ends the processes; tasks under way are given up."""
        self._idle.clear()
        for worker in tuple(self._living):
            self._ended(worker)

    def _hand_out(
        self,
        waiting: Iterator[tuple[int, Task]],
        again: dict[int, Task],
        alone: set[int],
        busy: dict[WorkerProcess, _Job],
    ) -> bool:
        """Hands tasks to all free workers, or at the end one of those to be done again; false when all are done."""
        while len(busy) < self._workers:
            found = next(waiting, None)
            if found is None:
                if busy or not again:
                    break
                number = min(again)
                alone.add(number)
                found = number, again.pop(number)
                self.close()
            worker = self._idle.pop() if self._idle else self._started()
            busy[worker] = _Job(*found)
            worker.give(found[1])
        return bool(busy)

    def _heard(self, busy: dict[WorkerProcess, _Job]) -> Iterator[tuple[int, Outcome | _Lost]]:
        """Takes what the workers have sent since; outcomes, and tasks whose worker has gone."""
        begin = time.monotonic()
        messages = list(self._messages())
        # counted in looks, not by the clock, on which this process may have been stopped as well
        passed = min(time.monotonic() - begin, 2.0 * TICK_S)
        for job in busy.values():
            job.silent_s += passed
        for worker, message in messages:
            if worker not in busy:  # it has been given up
                continue
            job = busy[worker]
            job.silent_s, worker.heard = 0.0, True
            if isinstance(message, Progress):
                job.progress = message
            elif isinstance(message, Gone):
                yield job.number, _Lost(job.task, self._given_up(worker, busy))
            elif isinstance(message, Outcome):
                del busy[worker]
                self._freed(worker, message)
                yield job.number, message
        for worker, job in tuple(busy.items()):
            if job.silent_s > (STILL_S if worker.heard else START_S):
                self._given_up(worker, busy)
                yield job.number, _Lost(job.task, STOOD_STILL.format(job.silent_s))

    def _messages(self) -> Iterator[tuple[WorkerProcess, object]]:
        """Waits for a message, not longer than a tick, and takes all that have come."""
        try:
            yield self._inbox.get(timeout=TICK_S)
            while True:
                yield self._inbox.get_nowait()
        except Empty:
            return

    def _started(self) -> WorkerProcess:
        worker = WorkerProcess(self._inbox)
        self._living.add(worker)
        return worker

    def _freed(self, worker: WorkerProcess, outcome: Outcome) -> None:
        if (outcome.peak_memory_mb or 0.0) > MOST_MB:
            self._ended(worker)
        else:
            self._idle.append(worker)

    def _given_up(self, worker: WorkerProcess, busy: dict[WorkerProcess, _Job]) -> str:
        del busy[worker]
        return self._ended(worker)

    def _ended(self, worker: WorkerProcess) -> str:
        self._living.discard(worker)
        return worker.end()
