"""Tasks for workers in tests: quick ones, failing ones, endless ones, and ones that end or stop their worker."""

import gc
import itertools
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

from mbkf.study.batch.outcome import Outcome, Status


@dataclass(frozen=True)
class Answer:
    """Answers with a number, and notes that it did."""

    number: int
    notes: Path

    def __call__(self, progress=None):
        (self.notes / f"{self.number}-{os.getpid()}").touch()
        return Outcome(Status.DONE, str(self.number))


@dataclass(frozen=True)
class Die:
    """Ends its worker by a signal; by default as the system does when memory runs out."""

    signal: int = signal.SIGKILL

    def __call__(self, progress=None):
        os.kill(os.getpid(), self.signal)


@dataclass(frozen=True)
class Stop:
    """Stops its worker, the first time or every time."""

    notes: Path
    always: bool = False

    def __call__(self, progress=None):
        note = self.notes / "stopped"
        if self.always or not note.exists():
            note.touch()
            os.kill(os.getpid(), signal.SIGSTOP)
        return Outcome(Status.DONE, "went on")


@dataclass(frozen=True)
class Endless:
    """Never ends; notes its process, prints, and reports progress."""

    notes: Path

    def __call__(self, progress=None):
        print("printed by a library")
        (self.notes / f"endless-{os.getpid()}").touch()
        for done in itertools.count():
            progress("Waiting", done, 0)
            time.sleep(0.01)


@dataclass(frozen=True)
class Large:
    """States that its worker has needed much memory."""

    def __call__(self, progress=None):
        return Outcome(Status.DONE, str(os.getpid()), peak_memory_mb=1e6)


@dataclass(frozen=True)
class Fail:
    """Raises an error that no task should."""

    def __call__(self, progress=None):
        raise RuntimeError("nobody foresaw this")


@dataclass(frozen=True)
class Threshold:
    """States after how many new objects its worker looks for circles."""

    def __call__(self, progress=None):
        return Outcome(Status.DONE, str(gc.get_threshold()[0]))
