"""Runs of sessions, one after the other in a thread, with the state of each trial and the time that is left.

The states stand in a file beside the results, so that a new page, or a server after a crash, continues where the last
one stopped: trials that are done from the same files are not done again.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, field
from functools import partial
from os import cpu_count
from pathlib import Path

from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError
from mbkf.io.atomic import write_text
from mbkf.io.files_read import read_state
from mbkf.study.batch.outcome import Outcome, ReconstructTrial, Status, Task
from mbkf.study.batch.plan import Plan
from mbkf.study.batch.run import outcomes_of
from mbkf.study.batch.workers import Executor, LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

RUNS_FILE = "runs.json"
"""File in the folder of the results with the state of each session's run."""

WAITING, RUNNING, FINISHED, CANCELLED, FAILED = "waiting", "running", "finished", "cancelled", "failed"


@dataclass
class RunState:
    """The state of a session's run.

    Attributes:
        state: "waiting", "running", "finished", "cancelled" or "failed".
        stage: "scaled" or "trials".
        done, total: Counts of trials.
        seconds: Time since the run began.
        reason: Cause of a failure of the whole run; empty without.
        trials: Status of each trial by name ("done", "unchanged" or "failed"), and its reason.
    """

    state: str = WAITING
    stage: str = ""
    done: int = 0
    total: int = 0
    seconds: float = 0.0
    reason: str = ""
    trials: dict[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def remaining_s(self) -> float | None:
        """Estimated time until the end, s; None before the first trial is done."""
        if self.state != RUNNING or not self.done:
            return None
        return self.seconds / self.done * (self.total - self.done)


class Runs:
    """Runs one session at a time; begins with those that an earlier server left unfinished.

    Args:
        workspace: The sessions.
        workers: Processes; by default one for each processor.
    """

    def __init__(self, workspace: Workspace, workers: int | None = None) -> None:
        self._workspace, self._workers = workspace, workers or cpu_count() or 1
        self._states = _read(workspace.out / RUNS_FILE)
        self._changed = threading.Condition()
        self._cancelled: set[str] = set()
        self._closing = False
        for state in self._states.values():
            if state.state == RUNNING:
                state.state = WAITING
        self._thread = threading.Thread(target=self._run, name="mbkf-runs", daemon=True)
        self._thread.start()

    def start(self, session: str) -> None:
        """Queues a session, unless it waits or runs already."""
        with self._changed:
            known = self._states.get(session)
            if known is None or known.state not in {WAITING, RUNNING}:
                self._states[session] = RunState(trials={} if known is None else known.trials)
            self._cancelled.discard(session)
            self._write()
            self._changed.notify_all()

    def cancel(self, session: str) -> None:
        """Ends the run of a session after the trials in progress."""
        with self._changed:
            state = self._states.get(session)
            if state is not None and state.state in {WAITING, RUNNING}:
                self._cancelled.add(session)
                if state.state == WAITING:
                    state.state = CANCELLED
                self._write()

    def state(self, session: str) -> RunState | None:
        """The state of a session's run; None for one that never ran."""
        with self._changed:
            return self._states.get(session)

    def close(self) -> None:
        """Ends the thread after the trials in progress; the next server continues."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(timeout=60.0)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closing or self._next() is not None)
                session = self._next()
                if self._closing or session is None:
                    return
                state = self._states[session]
                state.state, state.done, state.reason = RUNNING, 0, ""
                self._write()
            self._run_one(session, state)

    def _next(self) -> str | None:
        return next((name for name, state in self._states.items() if state.state == WAITING), None)

    def _run_one(self, session: str, state: RunState) -> None:
        begin = time.monotonic()
        try:
            plan = self._workspace.plan(session)
            state.total = len(plan.trials)
            workers = LocalWorkers(min(self._workers, state.total))
            watched = _Watched(workers, partial(self._note, session, begin))
            try:
                found = outcomes_of(plan, self._workspace.out, ReconstructSettings(), watched)
            finally:
                workers.close()
            self._finish(session, FINISHED, plan, found)
        except _Stopped:
            ended = CANCELLED if session in self._cancelled else RUNNING  # closed: the next server continues
            self._finish(session, ended)
        except (MbkfError, OSError) as error:
            state.reason = " ".join(str(error).split())
            self._finish(session, FAILED)

    def _note(self, session: str, begin: float, task: Task, found: Outcome) -> None:
        """Writes the outcome of a task into the states.

        Raises:
            _Stopped: The run was cancelled, or the page's server ends.
        """
        with self._changed:
            state = self._states[session]
            state.seconds = time.monotonic() - begin
            if isinstance(task, ReconstructTrial):
                state.stage, state.done = "trials", state.done + 1
                state.trials[task.trial.path.stem] = (found.status.value, found.reason)
            else:
                state.stage = "scaled"
            self._write()
            if self._closing or session in self._cancelled:
                raise _Stopped

    def _finish(
        self, session: str, ended: str, plan: Plan | None = None, found: Iterable[Outcome] = ()
    ) -> None:
        with self._changed:
            state = self._states[session]
            state.state = ended
            for trial, outcome in zip(() if plan is None else plan.trials, found, strict=True):
                state.trials[trial.path.stem] = (outcome.status.value, outcome.reason)
            state.done = sum(status != Status.FAILED for status, _ in state.trials.values())
            self._write()

    def _write(self) -> None:
        """Writes all states; the caller holds the lock."""
        plain = {name: asdict(state) for name, state in self._states.items()}
        write_text(self._workspace.out / RUNS_FILE, json.dumps(plain, indent=1))


class _Stopped(Exception):
    """The run ends before its last trial."""


class _Watched:
    """An executor that reports each task's outcome as it comes."""

    def __init__(self, executor: Executor, report: Callable[[Task, Outcome], None]) -> None:
        self._executor, self._report = executor, report

    def run(self, tasks: Iterable[Task]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        given: list[Task] = []

        def noted() -> Iterator[Task]:
            for task in tasks:
                given.append(task)
                yield task

        for number, outcome in self._executor.run(noted()):
            self._report(given[number], outcome)
            yield number, outcome

    def close(self) -> None:
        """Ends the workers."""
        self._executor.close()


def _read(file: Path) -> dict[str, RunState]:
    """The states in a file; empty if it is missing or damaged."""
    try:
        plain = json.loads(read_state(file))
        found = {str(name): RunState(**one) for name, one in plain.items()}
        for state in found.values():
            state.trials = {str(k): (str(a), str(b)) for k, (a, b) in state.trials.items()}
        return found
    except (OSError, ValueError, TypeError, AttributeError):
        return {}
