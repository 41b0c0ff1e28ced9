"""Tasks on the processes of one computer; a process that is killed costs only the task that it died of.

When a worker dies, nobody knows which of the tasks that were under way it had. Those are done again one by one, each in
a process of its own: the one that dies again is reported so, the others are done.
"""

from __future__ import annotations

import os
import threading
import time
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Protocol

from joblib.externals.loky import ProcessPoolExecutor
from joblib.externals.loky.process_executor import BrokenProcessPool

from mbkf.study.batch.outcome import Outcome, Status, Task

AHEAD = 2
"""So many tasks per worker are handed over before one is awaited: enough to keep it busy, and no more than loky passes
on at once, whose manager would stumble over tasks that still wait with it when an interruption ends it."""

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}

WATCH_S = 1.0
"""So often a worker looks whether its parent still lives."""

LEAVES = "A worker stopped while some jobs were given to the executor"

KILLED = "the worker was killed while it did this (out of memory?)"


class Executor(Protocol):
    """Does tasks somewhere."""

    def run(self, tasks: Iterable[Task]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come, each with its task's place in the order given."""

    def close(self) -> None:
        """Lets go of the workers; tasks under way are given up."""


class LocalWorkers:
    """Processes of this computer, one thread each."""

    def __init__(self, workers: int) -> None:
        """Args: how many processes."""
        # loky replaces a worker whose memory has grown, as it may.
        warnings.filterwarnings("ignore", LEAVES, UserWarning)
        self._workers = workers
        self._pool = self._started(workers)

    def run(self, tasks: Iterable[Task]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come, each with its task's place in the order given."""
        waiting, under_way = enumerate(tasks), dict[Future[Outcome], tuple[int, Task]]()
        while True:
            refused = self._hand_over(waiting, under_way)
            if not under_way and not refused:
                return
            done = wait(under_way, return_when=FIRST_COMPLETED).done if under_way else set()
            broken = bool(refused) or any(_broke(future) for future in done)
            for future in [one for one in under_way if one.done() and not _broke(one)]:
                number, _ = under_way.pop(future)
                yield number, future.result()
            if broken:
                suspects = [*under_way.values(), *refused]
                under_way.clear()
                yield from self._alone(suspects)

    def close(self) -> None:
        """Ends the processes; tasks under way are given up."""
        self._pool.shutdown(wait=True, kill_workers=True)

    def _hand_over(
        self, waiting: Iterator[tuple[int, Task]], under_way: dict[Future[Outcome], tuple[int, Task]]
    ) -> list[tuple[int, Task]]:
        """Hands tasks over until enough are under way; returns the one that dead workers could not take."""
        while len(under_way) < AHEAD * self._workers:
            found = next(waiting, None)
            if found is None:
                break
            try:
                under_way[self._pool.submit(found[1])] = found
            except BrokenProcessPool:
                return [found]
        return []

    def _alone(self, suspects: Iterable[tuple[int, Task]]) -> Iterator[tuple[int, Outcome]]:
        """Tasks one by one, after a worker died of one of them; then there are all workers again."""
        self._restart(1)
        for number, task in sorted(suspects, key=lambda one: one[0]):
            try:
                found = self._pool.submit(task).result()
            except BrokenProcessPool:
                found = Outcome(Status.FAILED, KILLED)
                self._restart(1)
            yield number, found
        self._restart(self._workers)

    def _restart(self, workers: int) -> None:
        self.close()
        self._pool = self._started(workers)

    def _started(self, workers: int) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(
            max_workers=workers,
            timeout=None,
            env=ONE_THREAD,
            initializer=end_without,
            initargs=(os.getpid(),),
        )


def end_without(parent: int) -> None:
    """Ends this process soon after its parent has gone, which may have been killed without a word to it.

    Args:
        parent: Number of the parent's process.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH_S)
        os._exit(1)

    if os.getppid() == parent:  # elsewhere a process keeps the number of a parent that is gone
        threading.Thread(target=watch, name="mbkf-parent", daemon=True).start()


def _broke(future: Future[Outcome]) -> bool:
    """True where a worker died before this was done."""
    return future.done() and isinstance(future.exception(), BrokenProcessPool)
