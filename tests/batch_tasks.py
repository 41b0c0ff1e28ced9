"""Tasks for workers in tests: quick ones, failing ones, and one that kills its worker."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path

from mbkf.study.batch.outcome import Outcome, Status


@dataclass(frozen=True)
class Answer:
    """Answers with a number, and notes that it did."""

    number: int
    notes: Path

    def __call__(self):
        (self.notes / f"{self.number}-{os.getpid()}").touch()
        return Outcome(Status.DONE, str(self.number))


@dataclass(frozen=True)
class Die:
    """Kills its worker, as the system does when memory runs out."""

    def __call__(self):
        os.kill(os.getpid(), signal.SIGKILL)


@dataclass(frozen=True)
class Fail:
    """Raises an error that no task should."""

    def __call__(self):
        raise RuntimeError("nobody foresaw this")
