"""Errors injected into runs of the laboratory's page: the queue lives on, other sessions are done, a reason is shown.

A place is the entrance of a function of mbkf in the thread of the runs, or one of its steps with files; the error is
raised at one place of a session's run, then another session is run. In half of the cases tasks are done in that thread
itself, so that places lie in scaling, filters and writing; in the other half by processes, so that they lie in the
handing over.
"""

from __future__ import annotations

import errno
import os
import random
import shutil
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from types import FrameType
from unittest.mock import patch

import mbkf
from benchmarks.batch.study import study
from benchmarks.checks import Check, Context
from mbkf.app import runs as module
from mbkf.app.run_states import FAILED, FINISHED
from mbkf.app.runs import Runs
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError
from mbkf.io.results_folder import read_reconstruction
from mbkf.study.batch.outcome import Outcome, Status, Task
from mbkf.study.batch.progress import Progress, Watch
from mbkf.study.batch.workers import LocalWorkers
from mbkf.trial.preparation.settings import ReconstructSettings

PLACES, QUICK_PLACES = 200, 6
OFTEN = 2
"""So many entrances of each function are places; a filter's step is entered for every frame."""

PATIENCE_S = 300.0
HIT, OTHER = "P1", "P2"
"""The session whose run meets the error, and the one that is run after it."""

PACKAGE = str(Path(mbkf.__file__).parent)
STEPS = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.truncate", "open"}
QUEUE = "mbkf-runs"
"""Name of the thread of the runs."""

WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT

Raised = Callable[[], BaseException]
ERRORS: tuple[Raised, ...] = (
    lambda: OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
    MemoryError,
    lambda: RuntimeError("injected"),
    lambda: KeyError("injected"),
)
WORDS = (os.strerror(errno.ENOSPC), "MemoryError", "injected")


class Places:
    """Counts places in the thread of the runs, and raises an error at one of them.

    Args:
        at: Number of that place, from 1; 0: none.
        error: Makes the error.
    """

    def __init__(self, at: int = 0, error: Raised = ERRORS[0]) -> None:
        self.at, self.error, self.count = at, error, 0
        self._seen: Counter[object] = Counter()

    def entered(self, frame: FrameType, _event: str, _argument: object) -> None:
        """A tracer's call, at the entrance of a function.

        Args:
            frame: The function's.
        """
        code = frame.f_code
        if code.co_filename.startswith(PACKAGE) and self._seen[code] < OFTEN:
            self._seen[code] += 1
            self._passed()

    def file_step(self, event: str, arguments: tuple[object, ...]) -> None:
        """An audit hook's call."""
        if event not in STEPS or threading.current_thread().name != QUEUE:
            return
        if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & WRITES):
            return
        self._passed()

    def _passed(self) -> None:
        self.count += 1
        if self.count == self.at:
            raise self.error()


_places: Places | None = None


def _audit(event: str, arguments: tuple[object, ...]) -> None:
    if _places is not None:
        _places.file_step(event, arguments)


@contextmanager
def watched(places: Places) -> Iterator[None]:
    """Threads that start inside meet the places."""
    global _places  # noqa: PLW0603 — an audit hook cannot be taken away
    if _places is None and _audit not in _hooked:
        sys.addaudithook(_audit)
        _hooked.append(_audit)
    _places = places
    threading.settrace(partial(_traced, places))
    try:
        yield
    finally:
        threading.settrace(None)
        _places = None


_hooked: list[object] = []


def _traced(places: Places, _frame: FrameType, _event: str, _argument: object) -> None:
    """The first call of a thread: that of the runs goes on to report its calls, any other does not."""
    sys.settrace(places.entered if threading.current_thread().name == QUEUE else None)


class InThread:
    """Does tasks where they are asked for, as an executor."""

    def __init__(self, workers: int) -> None:
        del workers

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes, each with its task's place."""
        for number, task in enumerate(tasks):
            yield number, task(partial(_note, watch, number))

    def close(self) -> None:
        """Nothing is held."""


def _note(watch: Watch | None, number: int, stage: str, done: int, total: int) -> None:
    if watch is not None:
        watch({number: Progress(stage, done, total)})


@dataclass(frozen=True)
class Mode:
    """Where tasks are done.

    Attributes:
        executor: The executor's class.
        prepared: Results of an earlier run are there, so that tasks only look at them.
    """

    executor: type
    prepared: bool


MODES = (Mode(InThread, False), Mode(LocalWorkers, True))


def rows(context: Context) -> list[Check]:
    """Cases that went well of all cases."""
    count = QUICK_PLACES if context.quick else PLACES
    chosen = random.Random(context.seed)
    held, faults = 0, []
    for mode, share in zip(MODES, (count - count // 2, count // 2), strict=True):
        lab = _lab(context.out / mode.executor.__name__, mode)
        places = Places()
        _case(lab, mode, places)
        for number in _spread(places.count, share, chosen):
            error = ERRORS[number % len(ERRORS)]
            fault = _case(lab, mode, Places(number, error))
            held += not fault
            if fault:
                faults.append(f"{mode.executor.__name__} place {number} of {places.count}: {fault}")
    (context.out / "faults.txt").write_text("\n".join(faults), encoding="utf-8")
    name = f"errors at {count} places of a run: queue alive, others done, reason shown"
    return [Check(name, held, count, ">=")]


def _spread(places: int, count: int, chosen: random.Random) -> list[int]:
    """Numbers of places: one at random in each of as many equal stretches, from 1."""
    edges = [1 + k * places // count for k in range(count + 1)]
    return [chosen.randrange(a, max(b, a + 1)) for a, b in pairwise(edges)]


def _lab(folder: Path, mode: Mode) -> Path:
    """A folder with two sessions; in results-before the results of an earlier run, where the mode has some."""
    lab = study(folder, 2, 1)
    if mode.prepared:
        fault = _case(lab, Mode(InThread, False), Places())
        assert not fault, fault
        (lab / "results").rename(lab.with_name(f"{lab.name}-before"))
    return lab


def _case(lab: Path, mode: Mode, places: Places) -> str:
    """Runs both sessions; the fault that is found, empty without."""
    before = lab.with_name(f"{lab.name}-before")
    shutil.rmtree(lab / "results", ignore_errors=True)
    if mode.prepared:
        shutil.copytree(before, lab / "results")
    quick = ReconstructSettings(filter="kinematic", smooth=False)
    with (
        patch.object(module, "LocalWorkers", mode.executor),
        patch.object(module, "ReconstructSettings", lambda: quick),
    ):
        workspace = Workspace(lab)
        with watched(places):
            runs = Runs(workspace, 1)
            try:
                runs.start(HIT)
                ended = _ended(runs, HIT)
            finally:
                places.at = 0
        if not ended:
            return f"the run is still {runs.state(HIT)}"
        runs.start(OTHER)
        alive = _ended(runs, OTHER)
        runs.close()
    if not alive:
        return "the queue stands still"
    return _of_other(runs, lab) or _of_hit(runs, lab)


def _ended(runs: Runs, session: str) -> bool:
    def reached() -> bool:
        state = runs.state(session)
        return state is not None and state.state in {FINISHED, FAILED}

    return runs.wait(reached, PATIENCE_S)


def _of_other(runs: Runs, lab: Path) -> str:
    state = runs.state(OTHER)
    assert state is not None
    done = [status for status, _ in state.trials.values()] in (["done"], ["unchanged"])
    if state.state != FINISHED or not done:
        return f"the other session: {state}"
    return _unreadable(lab, OTHER)


def _of_hit(runs: Runs, lab: Path) -> str:
    """The fault of the session that met the error: neither whole nor with a reason."""
    state = runs.state(HIT)
    assert state is not None
    reasons = [state.reason, *(reason for _, reason in state.trials.values())]
    if any(word in reason for reason in reasons for word in WORDS):
        return ""
    if state.state != FINISHED or any(status == Status.FAILED for status, _ in state.trials.values()):
        return f"no reason: {state}"
    return _unreadable(lab, HIT)  # an error that something handled


def _unreadable(lab: Path, session: str) -> str:
    left = [path.name for path in (lab / "results" / session).rglob(".*")]
    if left:
        return f"left: {left}"
    try:
        read_reconstruction(lab / "results" / session / "walk01")
    except (MbkfError, OSError) as error:
        return f"results of {session}: {error}"
    return ""
