"""Runs of sessions, one after the other in a thread, with the state of each trial and the time that is left.

The work is done by processes of its own: a run that is cancelled ends at once, a process that crashes costs its task,
and memory goes back to the system with the run. Whatever goes wrong in a run ends that run, with its reason; the queue
goes on. The states stand in a file beside the results, so that a new page, or a server after a crash, continues where
the last one stopped: trials that are done from the same files are not done again. Where that file cannot be written,
or a file of another program has its name, the states are those of this server alone.
"""

from __future__ import annotations

import contextlib
import json
import math
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict
from os import cpu_count

from mbkf.app.run_states import (
    CANCELLED,
    FAILED,
    FINISHED,
    NOT_READY,
    RUNNING,
    WAITING,
    RunState,
    read_states,
    state_of,
)
from mbkf.app.several_persons import SeveralPersons, of_one_person
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.atomic import write_text
from mbkf.study.batch.outcome import Outcome, Status, Task, failed
from mbkf.study.batch.plan import Plan
from mbkf.study.batch.progress import Progress, Watch
from mbkf.study.batch.run import outcomes_of, sorted_plan, sweep_plan
from mbkf.study.batch.tasks import ReconstructTrial, ScalePerson
from mbkf.study.batch.workers import Executor, LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

RUNS_FILE = "runs.json"
"""File in the folder of the results with the state of each session's run."""

LOOK_S = 1.0
"""Time between two looks at the states while nothing changes."""

CLOSE_S = 10.0
"""Longest wait for the thread at the end; its processes are killed at once."""


class Runs:
    """Runs one session at a time; begins with those that an earlier server left unfinished.

    Args:
        workspace: The sessions.
        workers: Processes; by default one for each processor.
    """

    def __init__(self, workspace: Workspace, workers: int | None = None) -> None:
        self._workspace, self._workers = workspace, workers or cpu_count() or 1
        self._states = read_states(workspace.out / RUNS_FILE)
        self._changed = threading.Condition()
        self._closing = False
        for state in self._states.values():
            if state.state == RUNNING:
                state.state = WAITING
        self._thread = self._started()

    def start(self, session: str) -> None:
        """Queues a session behind those that wait, unless it waits or runs already."""
        self._replace({session: RunState()})

    def start_all(self) -> None:
        """Queues all sessions in their order; those that are not ready are left out, with the reason in their state."""
        self._replace(
            {
                name: _left_out(found) if isinstance(found, InvalidInput) else RunState()
                for name, found in self._workspace.plans().items()
            }
        )

    def cancel(self, *sessions: str) -> None:
        """Ends the runs of sessions; trials under way are given up, finished ones stay."""
        with self._changed:
            for state in (self._states[name] for name in sessions if name in self._states):
                if state.state in {WAITING, RUNNING}:
                    state.state, state.under_way = CANCELLED, {}
            self._save()

    def state(self, session: str) -> RunState | None:
        """The state of a session's run; None for one that never ran."""
        with self._changed:
            self._revive()
            return self._states.get(session)

    def is_busy(self, session: str) -> bool:
        """True while a session waits or runs."""
        state = self.state(session)
        return state is not None and state.state in {WAITING, RUNNING}

    def plain_state(self, session: str, trial: str = "") -> dict[str, object] | None:
        """The state of a session, or that of one of its trials, as plain data; None without."""
        state = self.state(session)
        if state is None or (trial and trial not in state.trials):
            return None
        return {"trials": {trial: state.trials[trial]}} if trial else asdict(state) | {"under_way": {}}

    def take(self, session: str, trial: str = "") -> None:
        """Forgets the state of a session, or that of one of its trials."""
        with self._changed:
            if not trial:
                self._states.pop(session, None)
            elif session in self._states:
                self._states[session].trials.pop(trial, None)
            self._save()

    def give(self, session: str, trial: str, plain: Mapping[str, object]) -> None:
        """Puts a state back.

        Args:
            session: The session.
            trial: The trial; empty for the whole session.
            plain: As :meth:`plain_state` gave it.
        """
        found = state_of(plain)
        with self._changed:
            if trial and session in self._states:
                self._states[session].trials |= found.trials
            elif not trial:
                self._states[session] = found
            self._save()

    def wait(self, reached: Callable[[], bool], timeout_s: float | None = None) -> bool:
        """Waits for a condition on the states, looked at after every change; false where it is not met in time.

        It is looked at now and then besides: a thread that an error ended sends no notice of it.

        Args:
            reached: The condition.
            timeout_s: Longest wait; None: for ever.
        """
        ends = math.inf if timeout_s is None else time.monotonic() + timeout_s
        with self._changed:
            while not self._changed.wait_for(reached, min(LOOK_S, max(ends - time.monotonic(), 0.0))):
                if time.monotonic() >= ends:
                    return False
                self._revive()
        return True

    def close(self) -> None:
        """Ends the run under way and the thread; the next server continues."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(CLOSE_S)

    def _replace(self, states: Mapping[str, RunState]) -> None:
        """New states, with their known trials, of sessions that neither wait nor run, behind all others."""
        with self._changed:
            self._revive()
            for name, state in states.items():
                known = self._states.get(name)
                if known is None or known.state not in {WAITING, RUNNING}:
                    state.trials = {} if known is None else known.trials
                    self._states.pop(name, None)
                    self._states[name] = state
            self._save()

    def _started(self) -> threading.Thread:
        thread = threading.Thread(target=self._run, name="mbkf-runs", daemon=True)
        thread.start()
        return thread

    def _revive(self) -> None:
        """Starts the thread again if an error ended it that nothing could handle; the caller holds the lock."""
        if not self._closing and not self._thread.is_alive():
            self._fail("the run's thread ended for an unknown reason")
            self._thread = self._started()

    def _run(self) -> None:
        """The queue: whatever a run raises ends it as failed, and the next one starts."""
        while True:
            try:
                if (taken := self._taken()) is None:
                    return
                self._run_one(*taken)
            except _Stopped:
                continue
            except SeveralPersons as error:
                self._fail(_reason(error), error.files)
            except BaseException as error:  # the thread must live: no memory, full disk, a bug
                self._fail(_reason(error))

    def _taken(self) -> tuple[str, RunState] | None:
        """Waits for a session and marks it as running; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._closing or self._next() is not None)
            session = self._next()
            if self._closing or session is None:
                return None
            state = self._states[session]
            state.state, state.done, state.reason = RUNNING, 0, ""
            self._save()
            return session, state

    def _next(self) -> str | None:
        return next((name for name, state in self._states.items() if state.state == WAITING), None)

    def _run_one(self, session: str, state: RunState) -> None:
        plan = self._workspace.plan(session)
        state.total = len(plan.trials)
        with contextlib.ExitStack() as ending:
            ending.callback(sweep_plan, plan, self._workspace.out)
            workers = LocalWorkers(min(self._workers, state.total))
            ending.callback(workers.close)
            watched = _Watched(workers, _Notes(self, state))
            plan = of_one_person(sorted_plan(plan, watched))
            found = outcomes_of(plan, self._workspace.out, ReconstructSettings(), watched)
        self._finish(state, plan, found)

    def _finish(self, state: RunState, plan: Plan, found: Iterable[Outcome]) -> None:
        with self._changed:
            for trial, outcome in zip(plan.trials, found, strict=True):
                state.trials[trial.path.stem] = (outcome.status.value, outcome.reason)
            state.done = sum(status != Status.FAILED for status, _ in state.trials.values())
            if state.state == RUNNING:
                state.state, state.under_way = FINISHED, {}
            self._save()

    def _fail(self, reason: str, persons: Mapping[str, list[str]] | None = None) -> None:
        """Ends the run under way as failed."""
        with self._changed:
            for state in self._states.values():
                if state.state == RUNNING:
                    state.state, state.reason, state.under_way = FAILED, reason, {}
                    state.persons = dict(persons or {})
            self._save()

    def _save(self) -> None:
        """Makes a change known: to all that wait for it, and to the next server; the caller holds the lock."""
        self._changed.notify_all()
        with contextlib.suppress(Exception):  # a full disk, which also ends the run if it writes there
            plain = {name: asdict(state) | {"under_way": {}} for name, state in self._states.items()}
            write_text(self._workspace.out / RUNS_FILE, json.dumps(plain, indent=1))


class _Stopped(Exception):
    """The run ends before its last trial."""


class _Notes:
    """Notes outcomes and progress of a run in its state.

    Args:
        runs: All runs.
        state: That of this one.
    """

    def __init__(self, runs: Runs, state: RunState) -> None:
        self._runs, self._state, self._begin_s = runs, state, time.monotonic()

    def outcome(self, task: Task, found: Outcome) -> None:
        """Notes an outcome.

        Raises:
            _Stopped: The run was cancelled, or the page's server ends.
        """
        state = self._state
        with self._runs._changed:
            state.seconds = time.monotonic() - self._begin_s
            if isinstance(task, ReconstructTrial):
                state.stage, state.done = "trials", state.done + 1
                state.trials[task.trial.path.stem] = (found.status.value, found.reason)
                state.under_way.pop(task.trial.path.stem, None)
            elif isinstance(task, ScalePerson):
                state.stage, state.scaled_s = "scaled", state.seconds
            self._runs._save()
        self.check()

    def progress(self, under_way: Mapping[str, Progress]) -> None:
        """Notes progress, of each trial by its name.

        Raises:
            _Stopped: The run was cancelled, or the page's server ends.
        """
        self.check()
        with self._runs._changed:
            self._state.under_way = dict(under_way)
            self._state.seconds = time.monotonic() - self._begin_s
            self._runs._changed.notify_all()

    def check(self) -> None:
        """Raises _Stopped where the run is to end."""
        if self._state.state != RUNNING or self._runs._closing:
            raise _Stopped


class _Watched:
    """An executor whose tasks' outcomes and progress are noted as they come."""

    def __init__(self, executor: Executor, notes: _Notes) -> None:
        self._executor, self._notes = executor, notes

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        del watch
        given: list[Task] = []

        def noted() -> Iterator[Task]:
            for task in tasks:
                given.append(task)
                yield task

        def inside(under_way: Mapping[int, Progress]) -> None:
            self._notes.progress({_name(given[number]): one for number, one in under_way.items()})

        for number, outcome in self._executor.run(noted(), inside):
            self._notes.outcome(given[number], outcome)
            yield number, outcome

    def close(self) -> None:
        """Ends the workers."""
        self._executor.close()


def _name(task: Task) -> str:
    return task.trial.path.stem if isinstance(task, ReconstructTrial) else ""


def _reason(error: BaseException) -> str:
    """The reason of a failed run."""
    try:
        return failed(error).reason
    except Exception:  # no memory for a sentence
        return type(error).__name__


def _left_out(reason: InvalidInput) -> RunState:
    """The state of a session that is not ready."""
    persons = reason.files if isinstance(reason, SeveralPersons) else {}
    return RunState(NOT_READY, reason=_reason(reason), persons=persons)
