"""Tasks of a batch and their outcomes: input and output of the workers."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Protocol

from mbkf.conventions import StageCallback
from mbkf.errors import MbkfError
from mbkf.io.files_read import own_files_read
from mbkf.numerics.threads import single_threaded
from mbkf.study.batch.person import subject_of
from mbkf.study.batch.plan import Person, Trial
from mbkf.study.batch.progress import ignored
from mbkf.study.batch.trial import trial_done
from mbkf.trial.preparation.settings import ReconstructSettings


class Status(StrEnum):
    """Outcome of a task."""

    DONE = "done"
    UNCHANGED = "unchanged"
    FAILED = "failed"


@dataclass(frozen=True)
class Outcome:
    """Outcome of a task.

    Attributes:
        status: Whether it was done now, before, or failed.
        reason: Why it failed, in one line.
        seconds: How long it took.
        peak_memory_mb: Most memory that its worker had until then; None where the system does not state it.
        subject: The scaled person's file; None: a trial, or a failed scaling.
    """

    status: Status
    reason: str = ""
    seconds: float = 0.0
    peak_memory_mb: float | None = None
    subject: Path | None = None


class Task(Protocol):
    """Work for a worker; it can be sent to another process."""

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """Does it; errors become a reason.

        Args:
            progress: Called with the stage, items done and items in all.
        """


@dataclass(frozen=True)
class ScalePerson:
    """Scales a person.

    Attributes:
        person: The person.
        out: The batch's folder.
    """

    person: Person
    out: Path

    @property
    def name(self) -> str:
        """The person, as the folder of the results is called."""
        return self.person.place.as_posix()

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """The outcome, with the person's file."""
        return _outcome(lambda: Outcome(Status.DONE, subject=subject_of(self.person, self.out, progress)))


@dataclass(frozen=True)
class ReconstructTrial:
    """Reconstructs a trial.

    Attributes:
        trial: The trial.
        subject: The person's file.
        out: The batch's folder.
        settings: The filter and its settings.
    """

    trial: Trial
    subject: Path
    out: Path
    settings: ReconstructSettings

    @property
    def name(self) -> str:
        """The trial, as the folder of its results is called."""
        return self.trial.place.as_posix()

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """The outcome."""

        def work() -> Outcome:
            done = trial_done(self.trial, self.subject, self.out, self.settings, progress)
            return Outcome(Status.DONE if done else Status.UNCHANGED)

        return _outcome(work)


def failed(error: BaseException) -> Outcome:
    """An outcome for an error, in one line."""
    text = " ".join(str(error).split()) or type(error).__name__
    if isinstance(error, OSError) and error.strerror is not None:
        text = f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    elif not isinstance(error, MbkfError):
        text = f"unforeseen {type(error).__name__}: {text} (a bug in mbkf; please report it)"
    return Outcome(Status.FAILED, text)


def _outcome(work: Callable[[], Outcome]) -> Outcome:
    """Result of the work or its error, with time and memory."""
    begin = time.perf_counter()
    try:
        with single_threaded(), own_files_read():
            found = work()
    except Exception as error:  # one bad file costs only itself
        found = failed(error)
    seconds = time.perf_counter() - begin
    return Outcome(found.status, found.reason, seconds, peak_memory_mb(), found.subject)


def peak_memory_mb() -> float | None:
    """Most memory that this process has had, MB; None where the system does not state it."""
    if os.name != "posix":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024.0**2 if sys.platform == "darwin" else 1024.0)
