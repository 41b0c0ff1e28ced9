"""Tasks of a batch: captures to be sorted, a person to be scaled, and a trial to be reconstructed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.io.files_read import own_files_read
from mbkf.numerics.threads import single_threaded
from mbkf.study.batch.outcome import Outcome, Status, failed, peak_memory_mb
from mbkf.study.batch.person import doubts_of, subject_of
from mbkf.study.batch.plan import Person, Trial
from mbkf.study.batch.progress import ignored
from mbkf.study.batch.sorting import sorted_captures
from mbkf.study.batch.trial import trial_done, trial_doubts
from mbkf.trial.preparation.settings import ReconstructSettings


@dataclass(frozen=True)
class SortCaptures:
    """Sorts captures into persons.

    Attributes:
        person: The person of their folder.
    """

    person: Person

    @property
    def name(self) -> str:
        """The person, as the folder of the results is called."""
        return self.person.place.as_posix()

    def __call__(self, progress: StageCallback = ignored) -> Outcome:
        """The outcome, with the persons of the captures."""
        return _outcome(
            lambda: Outcome(Status.DONE, captures=sorted_captures(self.person, progress=progress))
        )


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
        """The outcome, with the person's file and the doubts about the person."""

        def work() -> Outcome:
            subject = subject_of(self.person, self.out, progress)
            return Outcome(Status.DONE, subject=subject, doubts="; ".join(doubts_of(self.person, subject)))

        return _outcome(work)


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
            doubts = trial_doubts(self.trial, self.out)
            return Outcome(Status.DONE if done else Status.UNCHANGED, doubts=doubts)

        return _outcome(work)


BatchTask = SortCaptures | ScalePerson | ReconstructTrial
"""A task of a batch."""


def _outcome(work: Callable[[], Outcome]) -> Outcome:
    """Result of the work or its error, with time and memory."""
    begin = time.perf_counter()
    try:
        with single_threaded(), own_files_read():
            found = work()
    except Exception as error:  # one bad file costs only itself
        found = failed(error)
    seconds = time.perf_counter() - begin
    return replace(found, seconds=seconds, peak_memory_mb=peak_memory_mb())
