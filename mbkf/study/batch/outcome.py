"""Outcome of a task, whatever it was, and the form of a task, which can be sent to another process.

Little is imported here, so that a worker is soon ready.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from mbkf.errors import InvalidInput, MbkfError
from mbkf.study.batch.progress import ignored

if TYPE_CHECKING:
    from mbkf.conventions import StageCallback
    from mbkf.study.batch.plan import Sorted


class AnotherPerson(InvalidInput):
    """A trial does not show the person that it was planned for."""


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
        doubts: Doubts about the scaled person, or about the trial's, in one line; empty without any.
        captures: Captures sorted into persons; None: another task.
        another_person: True for a trial that does not show its person.
    """

    status: Status
    reason: str = ""
    seconds: float = 0.0
    peak_memory_mb: float | None = None
    subject: Path | None = None
    doubts: str = ""
    captures: Sorted | None = None
    another_person: bool = False


class Task(Protocol):
    """Work for a worker; it can be sent to another process."""

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """Does it; errors become a reason.

        Args:
            progress: Called with the stage, items done and items in all.
        """


def failed(error: BaseException) -> Outcome:
    """An outcome for an error, in one line."""
    text = " ".join(str(error).split()) or type(error).__name__
    if isinstance(error, OSError) and error.strerror is not None:
        text = f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    elif not isinstance(error, MbkfError):
        text = f"unforeseen {type(error).__name__}: {text} (a bug in mbkf; please report it)"
    return Outcome(Status.FAILED, text, another_person=isinstance(error, AnotherPerson))


def peak_memory_mb() -> float | None:
    """Most memory that this process has had, MB; None where the system does not state it."""
    if os.name != "posix":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024.0**2 if sys.platform == "darwin" else 1024.0)
